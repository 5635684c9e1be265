"""What a contact along a line brings to an electrode below it, and to strips of it (films, section 11).

With q(k) the rows of an electrode times the transforms of the tractions, a strip of width w in the distance d collects
(1/pi) Re int q exp(ikd) 2 sin(kw/2) dk/k.
"""

from functools import lru_cache

import numpy as np

from solver.arrays import Array, ComplexArray
from solver.film.contact import FilmContact
from solver.film.electrodes import Collected, Electrode, Reading, joined, transfers
from solver.film.similar import Films
from solver.film.tractions import TractionTable
from solver.film.windows import Indices, Kind, window

_BLOCK = 200_000  # transforms of cases at wavenumbers held at once
_TABLES = 64  # kept: 0.1 MB each


@lru_cache(_TABLES)
def _tractions(kind: Kind, number: int) -> TractionTable:
    return TractionTable(window(kind, number))


def electrode_quantities(films: Films, reading: Reading) -> dict[str, Array]:
    """Those of ``solver.names.ELECTRODE_QUANTITIES`` that are asked for, SI; (case,) each.

    Raises
    ------
    StackError
        An electrode that is not there, a patch that reaches farther than is resolved.
    """
    reading, stack, parts = reading.over(films.thickness), films.kind.stack(), list[tuple[Indices, dict[str, Array]]]()
    for places, number, contact in films.parts:
        own, thickness = reading.part(places), films.thickness[places]

        def answer(
            some: Indices, number: int, octave: int, of: int = number, contact: FilmContact = contact,
            own: Reading = own, thickness: Array = thickness,
        ) -> dict[str, Array]:  # fmt: skip
            return _Read(films, of, contact, own.part(some), some, number, octave).quantities(thickness[some])

        parts.append((places, own.together(answer, stack, contact.half_width)))
    return joined(parts, films.load.size)


class _Read:
    """Cases of one window and electrode whose distances are of like size; lengths over the top layer's thickness."""

    def __init__(
        self, films: Films, of: int, contact: FilmContact, reading: Reading, some: Indices, number: int, octave: int
    ) -> None:
        stack, self.reading = films.kind.stack(), reading
        electrode = Electrode(stack, number)
        self.on_top = electrode.on_top
        self.load = contact.load[some]
        loads = np.concatenate([contact.load[:, None], contact.charges], -1)[some]
        self.whole = -np.einsum("j,cj->c", electrode.whole, loads * stack.scale[1:]) / stack.scale[2]
        if self.on_top:
            return
        self.k, self.weights, rows = transfers(stack, number, octave)
        self.units = stack.scale[2] / stack.scale[1]
        tractions = _tractions(films.kind, of).read(contact)
        self.carried: ComplexArray = np.empty((some.size, 2, self.k.size), np.complex128)
        step = max(_BLOCK // self.k.size, 1)
        for start in range(0, contact.load.size, step):
            here = np.flatnonzero((some >= start) & (some < start + step))
            if here.size:
                found = tractions.part(slice(start, start + step)).in_fourier_space(self.k)[some[here] - start, ..., 0]
                self.carried[here] = np.einsum("ckt,krt->crk", found, rows) / stack.scale[2]

    def quantities(self, thickness: Array) -> dict[str, Array]:
        """By name, SI; (case,) each."""
        out = {"electrode_charge_per_force": self.whole / self.load}
        if self.on_top:
            return out
        pressure = -np.sum(self.carried[:, 1].real * self.weights, -1) / np.pi
        out["electrode_pressure"] = pressure * self.units
        collected = Collected(self.reading, lambda at: self._strip(at, 0), lambda at: self._strip(at, 1) / thickness)
        return out | collected.quantities(self.load)

    def _strip(self, distance: Array, order: int) -> Array:
        """Charges of strips, or their derivatives by the distance; (case,)."""
        size = np.zeros_like(distance) if self.reading.size is None else self.reading.size
        wave = (1j * self.k) ** order * np.exp(1j * self.k * distance[:, None])
        share = 2 * np.sin(self.k * size[:, None] / 2) / (np.pi * self.k) * self.weights
        return np.asarray(np.sum((self.carried[:, 0] * wave).real * share, -1))
