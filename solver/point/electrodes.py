"""What a point contact brings to an electrode below it, and to discs and strips of it (films, section 11).

With q(k) = 2 pi a sum_n c_n . rows j_2n(ka), in the units of the stack, a disc of radius b in the distance d collects
b int q J0(kd) J1(kb) dk, a strip of width w across x (1/pi) int q cos(kd) 2 sin(kw/2) dk/k.
"""

from collections.abc import Callable

import numpy as np
from scipy.special import j0, j1

from solver.arrays import Array
from solver.film.electrodes import Collected, Electrode, Reading, joined, transfers
from solver.film.windows import Indices
from solver.point.bessel import even_orders
from solver.point.body import Film
from solver.point.galerkin import halfspace_terms
from solver.point.pressed import Contact
from solver.point.table import Window

_BLOCK = 1_000_000  # values of the Bessel functions held at once


def electrode_quantities(contact: Contact, film: Film, reading: Reading) -> dict[str, Array]:
    """Those of ``solver.names.ELECTRODE_QUANTITIES`` that are asked for, SI; (case,) each.

    Raises
    ------
    StackError
        An electrode that is not there, a patch that reaches farther than is resolved.
    """
    reading, stack, parts = (
        reading.over(film.thickness),
        film.kind.film.stack(),
        list[tuple[Indices, dict[str, Array]]](),
    )
    for places, window in film.windows(contact.radius):

        def answer(
            some: Indices, number: int, octave: int, places: Indices = places, window: Window = window
        ) -> dict[str, Array]:
            cases = places[some]
            return _Read(contact, film, window, reading.part(cases), cases, number, octave).quantities()

        extent = (contact.radius / film.thickness)[places]
        parts.append((places, reading.part(places).together(answer, stack, extent)))
    return joined(parts, contact.radius.size)


class _Read:
    """Cases of one window and electrode whose distances are of like size; lengths over the top layer's thickness."""

    def __init__(
        self, contact: Contact, film: Film, window: Window, reading: Reading, places: Indices, number: int, octave: int
    ) -> None:
        stack, self.reading = film.kind.film.stack(), reading
        self.scale, self.electrode = stack.scale, Electrode(stack, number)
        self.radius = contact.radius[places] / film.thickness[places]
        self.thickness, self.force = film.thickness[places], contact.pressed.force[places]
        self.size = contact.size[places] * film.thickness[places]
        self.loads = contact.loads[places]
        if self.electrode.on_top:
            return
        self.k, self.weights, self.rows = transfers(stack, number, octave)
        causes, shape = contact.state.causes[places], film.shape
        added = window.tractions(np.log(self.radius), causes)
        count = added.shape[-1]
        if shape.exponent % 2:  # of an even power few terms are not zero
            count = max(count, int(np.max(self.radius) * self.k[-1] / 2) + 12)
        self.terms = np.einsum("ind,cd->cin", halfspace_terms(film.kind.compliance, shape, count), causes)
        self.terms[..., : added.shape[-1]] += added

    def quantities(self) -> dict[str, Array]:
        """By name, SI; (case,) each."""
        whole = -np.einsum("j,cj->c", self.electrode.whole, self.loads * self.scale[1:]) / self.scale[2]
        out = {"electrode_charge_per_force": whole / self.force}
        if self.electrode.on_top:
            return out
        pressure = self._integrated(1, lambda some: self.k / (2 * np.pi) * np.ones((some.size, 1)))
        out["electrode_pressure"] = -pressure / self.thickness**2 * self.scale[2] / self.scale[1]
        collected = Collected(self.reading, self._patch, lambda at: self._slope(at) / self.thickness)
        return out | collected.quantities(self.force)

    def _patch(self, distance: Array) -> Array:
        return self._charge(distance, lambda kd: j0(kd), lambda kd: np.cos(kd))

    def _slope(self, distance: Array) -> Array:
        return self._charge(distance, lambda kd: -self.k * j1(kd), lambda kd: -self.k * np.sin(kd))

    def _charge(self, distance: Array, disc: Callable[[Array], Array], strip: Callable[[Array], Array]) -> Array:
        """Charges [C] of patches by what their distance makes of a wave."""
        size = np.zeros_like(distance) if self.reading.size is None else self.reading.size

        def wave(some: Indices) -> Array:
            kd, half = self.k * distance[some, None], size[some, None] / 2
            across = strip(kd) * 2 * np.sin(self.k * half) / (np.pi * self.k)
            return np.where(self.reading.strips[some, None], across, half * disc(kd) * j1(self.k * half))

        return self._integrated(0, wave)

    def _integrated(self, row: int, wave: Callable[[Indices], Array]) -> Array:
        """int (row of the transfers . tractions) wave dk over the charge's unit; (case,)."""
        count = self.terms.shape[-1]
        found, step = np.empty(self.radius.size), max(_BLOCK // (count * self.k.size), 1)
        for start in range(0, found.size, step):
            some = np.arange(start, min(start + step, found.size))
            orders = even_orders(self.radius[some, None] * self.k, count)
            tractions = 2 * np.pi * np.einsum("cin,nck->cik", self.terms[some], orders, optimize=True)
            carried = np.einsum("cik,ki->ck", tractions, self.rows[:, row, 1:])
            found[some] = np.sum(carried * wave(some) * self.weights, -1)
        return np.asarray(found * self.size * self.radius / self.scale[2])
