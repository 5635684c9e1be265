"""Charge of an electrode below a point contact, and of its patches (films, section 11).

In the units of the stack q(k) = 2 pi a sum_n c_n . rows j_2n(ka). Friction adds waves J1(kr) cos(angle), which are the
derivatives of -J0(kr)/k along x: their charge on a patch is the derivative of that of -J0(kr)/k by the distance.
"""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from scipy.special import j0, j1

from approximation.arrays import Indices
from solver.arrays import Array, joined
from solver.line.electrodecharge import Collected, together
from solver.point import hankel
from solver.point.body import Film
from solver.point.contact import PointContact
from solver.point.hankel import even_orders
from solver.point.sliding import Rubbed
from solver.point.system import halfspace_terms
from solver.point.table import PointWindow
from solver.point.tractions import Tractions
from solver.stack.electrodes import DISC, STRIP, Electrode, Reading, transfers

_VALUES_AT_ONCE = 1_000_000  # values of Bessel functions or waves held at once: bounded memory


def electrode_quantities(contact: PointContact, film: Film, reading: Reading) -> dict[str, Array]:
    """Requested quantities of ``solver.names.ELECTRODE_QUANTITIES``, SI; (case,) each."""
    reading, parts = reading.over(film.thickness), list[tuple[Indices, dict[str, Array]]]()
    for cases, table, _ in film.windows(contact.radius):
        part, extent = reading.part(cases), (contact.radius / film.thickness)[cases]
        parts.append((cases, together(part, partial(_OfPoint, contact, film, table, part, cases), extent)))
    return joined(parts, contact.radius.size)


class _OfPoint(Collected):
    """Cases of one window and electrode at similar distances; lengths over the top layer's thickness."""

    def __init__(
        self, contact: PointContact, film: Film, table: PointWindow, reading: Reading, window_cases: Indices,
        members: Indices, number: int, octave: int,
    ) -> None:  # fmt: skip
        stack, cases, force = film.kind.film, window_cases[members], contact.pressed.force
        loads, thickness = contact.loads[cases], film.thickness[cases]
        super().__init__(Electrode(stack, number), reading.part(members), force[cases], loads, thickness)
        self.radius, self.size = contact.radius[cases] / self.thickness, contact.size[cases] * self.thickness
        if self.electrode.on_top and reading.size is None:
            return
        friction = contact.pressed.friction
        slides = friction is not None and bool(np.any(friction.coefficient))
        self.k, self.weights, self.rows = transfers(stack, number, octave)
        self.sliding = Rubbed(contact).tractions.part(cases) if slides and reading.size is not None else None
        causes, shape = contact.state.causes[cases], film.shape
        added = table.tractions(np.log(self.radius), causes)
        count = added.shape[-1]
        if shape.exponent % 2:  # the half-space's series of an even power ends after a few terms
            count = max(count, int(np.max(self.radius) * self.k[-1] / 2) + 12)
        self.terms = np.einsum("ind,cd->cin", halfspace_terms(film.kind.compliance, shape, count), causes)
        self.terms[..., : added.shape[-1]] += added

    def _pressure(self) -> Array:
        pressure = self._integrated(1, lambda cases, k: k / (2 * np.pi) * np.ones((cases.size, 1)))
        return np.asarray(-pressure / self.thickness**2 * self.scale[2] / self.scale[1])

    def _patch(self, distance: Array) -> Array:
        charge = super()._patch(distance)
        return charge if self.sliding is None else charge + self._by_friction(self.sliding, distance)

    def _by_friction(self, sliding: Tractions, distance: Array) -> Array:
        """Charges [C] that friction adds to patches at distances, odd in the distance; (case,)."""
        charge = np.zeros_like(distance)
        nodes = hankel.nodes(parts=hankel.parts(np.max(self.radius) * self.k), kinked=True)
        for cases, waves in self._blocks(nodes.b.size):
            turned = sliding.vectors(nodes.b, cases)[1]
            if turned is None:
                continue
            k, rows = self.k[waves], self.rows[waves, 0]
            phase = self.radius[cases, None, None] * k[:, None] * nodes.b
            spectrum = np.einsum("ckb,cb,k->ck", np.cos(phase), turned[:, 0] * nodes.weights, rows[:, 0])
            down = np.einsum("ckb,cib->cki", np.sin(phase), turned[:, 1:] * nodes.weights, optimize=True)
            spectrum += np.einsum("cki,ki->ck", down, rows[:, 1:])
            patch = -self._wave(cases, k, distance, slope=True) / k
            charge[cases] += 2 * np.pi * self.radius[cases] ** 2 * np.sum(spectrum * patch * self.weights[waves], -1)
        return np.asarray(charge * self.thickness**2 / self.scale[2])

    def _blocks(self, count: int) -> Iterator[tuple[Indices, slice]]:
        """Yield cases and wavenumbers whose arrays of ``count`` values a pair fit into the memory."""
        pairs = max(_VALUES_AT_ONCE // count, 1)
        waves = min(pairs, self.k.size)
        step = max(pairs // waves, 1)
        for start in range(0, self.radius.size, step):
            for first in range(0, self.k.size, waves):
                yield np.arange(start, min(start + step, self.radius.size)), slice(first, first + waves)

    def _charge(self, distance: Array, *, slope: bool) -> Array:
        return self._integrated(0, lambda cases, k: self._wave(cases, k, distance, slope=slope))

    def _wave(self, cases: Indices, k: Array, distance: Array, *, slope: bool) -> Array:
        """Charge of waves on patches of ``cases``, or its derivative by the distance (case,); (case, k)."""
        charge, shapes = np.empty((cases.size, k.size)), self.reading.shape[cases]
        for shape, wave in ((STRIP, _strip_wave), (DISC, _disc_wave)):
            rows = np.flatnonzero(shapes == shape)
            charge[rows] = wave(k, distance[cases[rows], None], self._size[cases[rows], None], slope=slope)
        return charge

    def _integrated(self, row: int, wave: Callable[[Indices, Array], Array]) -> Array:
        """Return int (row of the transfers . tractions) wave dk over the charge's unit; (case,)."""
        integral, count = np.zeros(self.radius.size), self.terms.shape[-1]
        for cases, waves in self._blocks(count):
            k = self.k[waves]
            orders = even_orders(self.radius[cases, None] * k, count)
            transforms = np.einsum("cin,nck->cik", self.terms[cases], orders, optimize=True)
            spectrum = np.einsum("cik,ki->ck", transforms, self.rows[waves, row, 1:])
            integral[cases] += np.sum(spectrum * wave(cases, k) * self.weights[waves], -1)
        return np.asarray(2 * np.pi * integral * self.size * self.radius / self.scale[2])


def _disc_wave(k: Array, distance: Array, size: Array, *, slope: bool) -> Array:
    """Charge of waves on discs, or its derivative by their distance, (case, 1); (case, k)."""
    along = -k * j1(k * distance) if slope else j0(k * distance)
    return np.asarray(size / 2 * along * j1(k * size / 2))


def _strip_wave(k: Array, distance: Array, size: Array, *, slope: bool) -> Array:
    """Charge of waves on strips, or its derivative by their distance, (case, 1); (case, k)."""
    along = -k * np.sin(k * distance) if slope else np.cos(k * distance)
    return np.asarray(along * 2 * np.sin(k * size / 2) / (np.pi * k))
