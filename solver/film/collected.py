"""What a contact along a line brings to an electrode below it, and to strips of it (films, section 11).

With q(k) the rows of an electrode times the transforms of the tractions, a strip of width w in the distance d collects
(1/pi) Re int q exp(ikd) 2 sin(kw/2) dk/k. On top a part of q is v of the tractions at the same place, which the
antiderivatives F of these give: Im F of what presses, Re F of what is sheared.
"""

from functools import cached_property, lru_cache

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, ComplexArray, joined
from solver.film.contact import FilmContact
from solver.film.electrodes import Electrode, transfers
from solver.film.floating import Strips, strips
from solver.film.reading import Collected, Reading
from solver.film.similar import Films
from solver.film.tractions import TractionTable
from solver.film.windows import Kind, window

_BLOCK = 200_000  # transforms of cases at wavenumbers held at once
_TABLES = 64  # kept: 0.1 MB each


@lru_cache(_TABLES)
def _tractions(kind: Kind, number: int) -> TractionTable:
    return TractionTable(window(kind, number))


def electrode_quantities(films: Films, reading: Reading) -> dict[str, Array]:
    """Those of ``ELECTRODE_QUANTITIES`` and ``STRIP_QUANTITIES`` of ``solver.names`` that are asked for, SI; (case,).

    Parameters
    ----------
    films : Films, the cases
    reading : Reading, what is read of the electrode, over (case,)

    Raises
    ------
    StackError
        An electrode that is not there, a patch that reaches farther than is resolved; strips that float below a punch
        that conducts on a bare surface.
    """
    reading.refused(conducts=films.kind.conducts[0])
    reading, parts = reading.over(films.thickness), list[tuple[Indices, dict[str, Array]]]()
    for places, number, contact in films.parts:
        own, thickness = reading.part(places), films.thickness[places]

        def answer(
            some: Indices, number: int, octave: int, of: int = number, contact: FilmContact = contact,
            own: Reading = own, thickness: Array = thickness,
        ) -> dict[str, Array]:  # fmt: skip
            return _Read(films, of, contact, own.part(some), some, number, octave).quantities(thickness[some])

        parts.append((places, own.together(answer, contact.half_width)))
    return joined(parts, films.load.size)


class _Read:
    """Cases of one window and electrode whose distances are of like size; lengths over the top layer's thickness."""

    def __init__(
        self, films: Films, of: int, contact: FilmContact, reading: Reading, some: Indices, number: int, octave: int
    ) -> None:
        stack, self.reading = films.kind.stack(), reading
        self.electrode = electrode = Electrode(stack, number)
        self.load = contact.load[some]
        loads = np.concatenate([contact.load[:, None], contact.charges], -1)[some]
        self.whole = -np.einsum("j,cj->c", electrode.whole, loads * stack.scale[1:]) / stack.scale[2]
        if electrode.on_top and reading.size is None:
            return
        self.k, self.weights, rows = transfers(stack, number, octave)
        self.scale = stack.scale
        self.tractions = _tractions(films.kind, of).read(contact).part(some)
        self.carried: ComplexArray = np.empty((some.size, 2, self.k.size), np.complex128)
        step = max(_BLOCK // self.k.size, 1)
        for start in range(0, some.size, step):
            here = slice(start, start + step)
            found = self.tractions.part(here).in_fourier_space(self.k)[..., 0]
            self.carried[here] = np.einsum("ckt,krt->crk", found, rows) / stack.scale[2]

    def quantities(self, thickness: Array) -> dict[str, Array]:
        """By name, SI; (case,) each."""
        out = {"electrode_charge_per_force": self.whole / self.load}
        out["electrode_stroke_per_volt"] = np.full_like(self.load, self.electrode.stroke)
        if not self.electrode.on_top:
            pressure = -np.sum(self.carried[:, 1].real * self.weights, -1) / np.pi
            out["electrode_pressure"] = pressure * self.scale[2] / self.scale[1]
        collected = Collected(self.reading, lambda at: self._strip(at, 0), lambda at: self._strip(at, 1) / thickness)
        out |= collected.quantities(self.load)
        if self.reading.floating is not None:
            of_case, rows = self._rows
            out["patch_capacitance"] = np.array([row.capacitance for row in rows])[of_case]
            out["patch_voltage_per_load"] = -out["patch_charge_per_force"] / out["patch_capacitance"]
        return out

    def _strip(self, distance: Array, order: int) -> Array:
        """Charges of strips, or their derivatives by the distance; (case,)."""
        size = np.zeros_like(distance) if self.reading.size is None else self.reading.size
        wave = (1j * self.k) ** order * np.exp(1j * self.k * distance[:, None])
        if self.reading.floating is None:
            share = 2 * np.sin(self.k * size[:, None] / 2) / self.k
        else:
            of_case, rows = self._rows
            share = np.array([row.wave(self.k) for row in rows])[of_case]
        charge = np.asarray(np.sum((self.carried[:, 0] * wave).real * share * self.weights, -1)) / np.pi
        return charge + self._local(distance, size, order) if self.electrode.on_top else charge

    @cached_property
    def _rows(self) -> tuple[Indices, list[Strips]]:
        """Rows of strips that float, and which of them is that of each case."""
        return self.reading.gapped(lambda *row: strips(self.electrode.stack, self.electrode.number, *row))

    def _local(self, distance: Array, size: Array, order: int) -> Array:
        """What strips on top get of the tractions on them; (case,)."""
        half = self.tractions.half_lengths
        ends = (distance[:, None] + size[:, None] * [-0.5, 0.5]) / half[:, None]
        at = self.tractions.on_plane(ends.astype(np.complex128), integrated=order == 0)[..., 0]  # (4, case, end)
        parts = np.concatenate([at[:1].real, at[1:].imag])
        charge = np.einsum("t,tc->c", self.electrode.local, parts[..., 1] - parts[..., 0]) / self.scale[2]
        return np.asarray(charge if order else charge * half)
