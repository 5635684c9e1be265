"""Charge that a point contact brings to an electrode below it, and to patches of it (films, section 11).

With q(k) = 2 pi a sum_n c_n . rows j_2n(ka), in the units of the stack, a disc of radius b at the distance d collects
b int q J0(kd) J1(kb) dk, a strip of width w across x (1/pi) int q cos(kd) 2 sin(kw/2) dk/k. On top a part of q is v of
the tractions at the same place, integrated over the part of the contact that the patch covers: between the radii at
which the covered angle has a root, r = m - h cos t makes it smooth, and the edge of the contact too.

A ball that slides adds waves J1(kr) cos(angle). These are -1/k times the derivatives of J0(kr) along x: their charge on
a patch is -1/k times the derivative by the distance of the charge of J0.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.special import j0, j1

from approximation.arrays import Indices
from solver.arrays import Array, joined
from solver.line.electrodecharge import Collected, together
from solver.point import hankel
from solver.point.body import Film
from solver.point.contact import Contact
from solver.point.hankel import even_orders
from solver.point.sliding import Rubbed
from solver.point.surface import BelowPunch
from solver.point.system import halfspace_terms
from solver.point.table import Window
from solver.point.tractions import Tractions
from solver.stack.electrodereading import STRIP, Reading
from solver.stack.electrodes import Electrode, transfers
from solver.stack.layers import StackError

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)


@dataclass(frozen=True, eq=False)
class Covered:
    """Patches of one shape, their lengths over the radius of the contact; (case,) each."""

    shape: int  # Place in ``solver.names.CHOICES["patch"]``
    distance: Array  # Of the patch's middle from that of the contact
    size: Array  # Diameter of a disc, width of a strip

    def rule(self, *, slope: bool) -> tuple[Array, Array]:
        """Radii r within the contact, and weights of an integral over the covered part; (case, node) each.

        ``slope``: of its derivative by the distance.
        """
        ends = np.sort(np.clip(np.stack([*self._ends, 0 * self.size, 0 * self.size + 1], -1), 0.0, 1.0), -1)
        half, middle = (ends[:, 1:] - ends[:, :-1]) / 2, (ends[:, 1:] + ends[:, :-1]) / 2
        angle = np.pi / 2 * (1 + _NODES)
        r = np.asarray(middle[..., None] - half[..., None] * np.cos(angle)).reshape(len(half), -1)
        weights = (half[..., None] * np.sin(angle) * np.pi / 2 * _WEIGHTS).reshape(len(half), -1)
        r = np.clip(r, 1e-300, 1.0)
        with np.errstate(divide="ignore", invalid="ignore"):  # between ends that are one, whose weight is 0
            found = np.where(weights > 0, weights * r * self._angle(r, slope=slope), 0.0)
        return r, found

    @property
    def _ends(self) -> list[Array]:
        """Radii at which the angle has a root."""
        d, half = self.distance, self.size / 2
        return [np.abs(d - half), np.abs(d + half)]

    def _angle(self, r: Array, *, slope: bool) -> Array:
        """Of the circles that the patch covers, or its derivative by the distance."""
        d, half = self.distance[:, None], self.size[:, None] / 2
        if self.shape == STRIP:
            part = _beyond_slope if slope else _beyond
            return np.asarray(part(d - half, r) - part(d + half, r))
        disc = _disc_slope if slope else _disc
        return np.asarray(disc(d, half, r))


def _beyond(x: Array, r: Array) -> Array:
    """Angle of a circle about the origin that lies beyond x."""
    return np.asarray(2 * np.arccos(np.clip(x / r, -1.0, 1.0)))


def _beyond_slope(x: Array, r: Array) -> Array:
    """Derivative of :func:`_beyond` by x."""
    square = (r - x) * (r + x)
    return np.asarray(np.where(square > 0, -2 / np.sqrt(np.abs(square)), 0.0))


def _disc(d: Array, b: Array, r: Array) -> Array:
    """Angle of a circle about the origin that lies in the disc of radius b in the distance d."""
    d = np.abs(d)
    away = np.where(d > 0, d, 1.0)
    share = np.arccos(np.clip((r**2 + d**2 - b**2) / (2 * r * away), -1.0, 1.0))
    return np.asarray(2 * np.where(d > 0, share, np.where(r < b, np.pi, 0.0)))


def _disc_slope(d: Array, b: Array, r: Array) -> Array:
    away, side = np.where(d != 0, np.abs(d), 1.0), np.sign(d)
    root = ((r + away) ** 2 - b**2) * (b**2 - (r - away) ** 2)
    slope = -2 * (away**2 - r**2 + b**2) / (away * np.sqrt(np.abs(root)))
    return np.asarray(np.where((root > 0) & (d != 0), side * slope, 0.0))


_PHASE = 8.0  # of a wave over a panel of densities
_BLOCK = 1_000_000  # values of the Bessel functions held at once


def electrode_quantities(contact: Contact, film: Film, reading: Reading) -> dict[str, Array]:
    """Requested quantities of ``solver.names.ELECTRODE_QUANTITIES``, SI; (case,) each."""
    reading.refused(conducts=film.kind.conducts[0])
    reading, parts = reading.over(film.thickness), list[tuple[Indices, dict[str, Array]]]()
    for places, window, _ in film.windows(contact.radius):
        own, extent = reading.part(places), (contact.radius / film.thickness)[places]
        parts.append((places, together(own, partial(_OfPoint, contact, film, window, own, places), extent)))
    return joined(parts, contact.radius.size)


def _slides(contact: Contact) -> bool:
    friction = contact.pressed.friction
    return friction is not None and bool(np.any(friction.coefficient))


class _OfPoint(Collected):
    """Cases of one window and electrode whose distances are of like size; lengths over the top layer's thickness."""

    def __init__(
        self, contact: Contact, film: Film, window: Window, reading: Reading, window_places: Indices,
        some: Indices, number: int, octave: int,
    ) -> None:  # fmt: skip
        stack, places = film.kind.film.stack(), window_places[some]
        super().__init__(
            Electrode(stack, number), reading.part(some), contact.pressed.force[places], contact.loads[places]
        )
        self.thickness = film.thickness[places]
        self.radius, self.size = contact.radius[places] / self.thickness, contact.size[places] * self.thickness
        if self.electrode.on_top and reading.size is None:
            return
        slides = reading.size is not None and _slides(contact)
        if slides and self.electrode.on_top:
            raise StackError("friction: of a point contact on patches of the electrode on top; must be 0")
        self.k, self.weights, self.rows = transfers(stack, number, octave)
        self.rubbed = Rubbed(contact).tractions.part(places) if slides else None
        causes, shape = contact.state.causes[places], film.shape
        added = window.tractions(np.log(self.radius), causes)
        count = added.shape[-1]
        if shape.exponent % 2:  # of an even power few terms are not zero
            count = max(count, int(np.max(self.radius) * self.k[-1] / 2) + 12)
        self.terms = np.einsum("ind,cd->cin", halfspace_terms(film.kind.compliance, shape, count), causes)
        self.terms[..., : added.shape[-1]] += added
        self.tractions = BelowPunch(contact, places, added)

    def _pressure(self) -> Array:
        pressure = self._integrated(1, lambda some: self.k / (2 * np.pi) * np.ones((some.size, 1)))
        return np.asarray(-pressure / self.thickness**2 * self.scale[2] / self.scale[1])

    def _patch(self, distance: Array) -> Array:
        found = self._charge(distance, slope=False)
        return found if self.rubbed is None else found + self._turned(self.rubbed, distance)

    def _gradient(self, distance: Array) -> Array:
        return self._charge(distance, slope=True) / self.thickness

    def _turned(self, rubbed: Tractions, distance: Array) -> Array:
        """What friction adds to charges [C] of patches in distances, odd in these; (case,)."""
        found = np.zeros_like(distance)
        at = self._nodes
        step = max(_BLOCK // (at.b.size * self.k.size), 1)
        for start in range(0, found.size, step):
            some = np.arange(start, min(start + step, found.size))
            turned = rubbed.vectors(at.b, some)[1]
            if turned is None:
                continue
            phase = self.radius[some, None, None] * self.k[:, None] * at.b
            carried = np.einsum("ckb,cb,k->ck", np.cos(phase), turned[:, 0] * at.weights, self.rows[:, 0, 0])
            down = np.einsum("ckb,cib->cki", np.sin(phase), turned[:, 1:] * at.weights, optimize=True)
            carried += np.einsum("cki,ki->ck", down, self.rows[:, 0, 1:])
            wave = -self._wave(some, distance, slope=True) / self.k
            found[some] = 2 * np.pi * self.radius[some] ** 2 * np.sum(carried * wave * self.weights, -1)
        return np.asarray(found * self.thickness**2 / self.scale[2])

    @property
    def _nodes(self) -> hankel.Nodes:
        return hankel.nodes(parts=int(np.max(self.radius) * self.k[-1] / _PHASE) + 4, kinked=True)

    def _charge(self, distance: Array, *, slope: bool) -> Array:
        """Charges [C] of patches in distances, or their derivatives by these; without friction."""
        found = self._integrated(0, lambda some: self._wave(some, distance, slope=slope))
        return found + self._local(distance, self._size, slope=slope) if self.electrode.on_top else found

    @property
    def _size(self) -> Array:
        return np.zeros_like(self.radius) if self.reading.size is None else self.reading.size

    def _wave(self, some: Indices, distance: Array, *, slope: bool) -> Array:
        """What patches of some cases make of waves, or its derivative by their distances (case,); (some, k)."""
        found = np.empty((some.size, self.k.size))
        for shape in np.unique(self.reading.shape[some]).tolist():
            own = np.flatnonzero(self.reading.shape[some] == shape)
            wave = self._strip if shape == STRIP else self._disc
            found[own] = wave(distance[some[own]], self._size[some[own]], slope=slope)
        return found

    def _local(self, distance: Array, size: Array, *, slope: bool) -> Array:
        """What patches on top get of the tractions on them, or its derivative by the distance."""
        found = np.zeros_like(distance)
        for shape in np.unique(self.reading.shape).tolist():
            own = np.flatnonzero(self.reading.shape == shape)
            lengths = (values[own] / self.radius[own] for values in (distance, size))
            r, weights = Covered(int(shape), *lengths).rule(slope=slope)
            carried = np.einsum("j,cjr->cr", self.electrode.local[1:], self.tractions.at(own, r))
            found[own] = np.sum(carried * weights, -1) / (self.radius[own] if slope else 1.0)
        return np.asarray(found * self.size * self.radius / self.scale[2])

    def _disc(self, distance: Array, size: Array, *, slope: bool) -> Array:
        """What discs make of waves, or its derivative by their distance; (case, k)."""
        kd, half = self.k * distance[:, None], size[:, None] / 2
        along = -self.k * j1(kd) if slope else j0(kd)
        return np.asarray(half * along * j1(self.k * half))

    def _strip(self, distance: Array, size: Array, *, slope: bool) -> Array:
        """What strips make of waves, or its derivative by their distance; (case, k)."""
        kd = self.k * distance[:, None]
        along = -self.k * np.sin(kd) if slope else np.cos(kd)
        return np.asarray(along * 2 * np.sin(self.k * size[:, None] / 2) / (np.pi * self.k))

    def _integrated(self, row: int, wave: Callable[[Indices], Array]) -> Array:
        """int (row of the transfers . tractions) wave dk over the charge's unit; (case,)."""
        count = self.terms.shape[-1]
        found, step = np.empty(self.radius.size), max(_BLOCK // (count * self.k.size), 1)
        for start in range(0, found.size, step):
            some = np.arange(start, min(start + step, found.size))
            carried = np.einsum("cik,ki->ck", self._waves(some), self.rows[:, row, 1:])
            found[some] = np.sum(carried * wave(some) * self.weights, -1)
        return np.asarray(2 * np.pi * found * self.size * self.radius / self.scale[2])

    def _waves(self, some: Indices) -> Array:
        """Transforms of the tractions of some cases, over C a^(e+1) 2 pi; (some, 3, k)."""
        orders = even_orders(self.radius[some, None] * self.k, self.terms.shape[-1])
        return np.asarray(np.einsum("cin,nck->cik", self.terms[some], orders, optimize=True))
