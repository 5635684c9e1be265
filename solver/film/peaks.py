"""Largest stresses of a film and on its lowest interface, read from tables over half-lengths (film surrogates, 2).

Stresses on Chebyshev panels tied to the edges of the contact are linear in the causes at a half-length and smooth in
its logarithm. A case is a product; the best node of every panel starts a Newton iteration on the interpolant.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.curves import REGIONS, nodes
from solver.film.contact import FilmContact
from solver.film.interior import Interior
from solver.film.stack import StackError
from solver.film.table import Table
from solver.film.tractions import Tractions
from solver.halfplane.interior import principal_tension, von_mises

DEPTH = 0.1  # of the half-length: the least depth of the film's peaks
WINDOW = 10.0  # thicknesses beside the contact in which the interface is searched

_STRESSES = ("stress_xx", "stress_yy", "stress_xy", "stress_zz")
ACROSS = (44, 72, 44)  # nodes of the panels beside, under and beside the contact, of the film
DOWN = 16
INTERFACE = REGIONS["interface"].across
_NEAR = 2.0  # thicknesses, where the two panels of the interface beside the contact meet
_STEPS = 12
_STENCIL = np.array([(i, j) for j in (-1, 0, 1) for i in (-1, 0, 1)], dtype=np.float64)
_STEP = 2e-3  # of the stencil in the local coordinates of a panel
_CHUNK = 256  # cases at a time: bounded memory


Spans = Callable[[float], tuple[tuple[float, float], ...]]
Measure = Callable[[Array, Array, Array, Array], Array]


@dataclass(frozen=True, eq=False)
class InterfacePeaks:
    """Largest stresses on the upper side of the lowest interface; (case,) each, positions X = (x - c)/h.

    Attributes
    ----------
    shear, shear_position
        Largest abs(sigma_xy) [Pa].
    tension, tension_position
        Largest sigma_yy within ten thicknesses of the contact [Pa]; 0 and NaN where none is tensile.
    """

    shear: Array
    shear_position: Array
    tension: Array
    tension_position: Array


@dataclass(frozen=True, eq=False)
class BodyPeaks:
    """Largest von Mises and principal stress of the film below depth 0.1 h, or of the base [Pa]; (case,) each."""

    von_mises: Array
    principal_tension: Array


@dataclass(frozen=True, eq=False)
class PeakTable:
    """Stresses of a film over the half-lengths of a table of contacts.

    Parameters
    ----------
    table
        Table of the contacts.
    """

    table: Table

    @property
    def _thickness(self) -> float:
        return self.table.system.kernel.stack.thickness

    # -- interface -----------------------------------------------------------------------------------------------------
    @cached_property
    def interface_series(self) -> Array:
        """Chebyshev coefficients in log h of (sigma_xy, sigma_yy) on the interface; (node, 2, x, cause)."""
        found = self._inside(INTERFACE, self.spans, lambda h: np.array([self._thickness]), ("stress_xy", "stress_yy"))
        return self.table.in_series(found[:, :, 0])

    def _inside(
        self, counts: tuple[int, ...], spans: Spans, depths: Callable[[float], Array], names: tuple[str, ...]
    ) -> Array:
        """Fields at the half-lengths of the table, on panels and at depths of each; (node, field, depth, x, cause)."""
        lengths = self.table.half_lengths.tolist()
        across = [[_map(n, *ends) / h for n, ends in zip(counts, spans(h), strict=True)] for h in lengths]
        X = np.array([np.concatenate(panels) for panels in across])
        Y = np.array([-depths(h) / h for h in lengths])
        return Interior(self._tractions).fields(X, Y, names)

    @cached_property
    def _tractions(self) -> Tractions:
        return Tractions.by_cause(self.table.system, self.table.half_lengths)

    def spans(self, h: float) -> tuple[tuple[float, float], ...]:
        """Ends of the panels on the interface [m]."""
        near, far = h + _NEAR * self._thickness, h + WINDOW * self._thickness
        return (-far, -near), (-near, -h), (-h, h), (h, near), (near, far)

    def interface(self, contact: FilmContact) -> InterfacePeaks:
        """Largest stresses on the lowest interface of contacts read from the same table."""
        values = self.read(contact, self.interface_series)
        shear, place = _largest(values[:, 0], contact.half_width, self.spans)
        other, other_place = _largest(-values[:, 0], contact.half_width, self.spans)
        tension, tension_place = _largest(values[:, 1], contact.half_width, self.spans)
        pulled = tension > 0
        return InterfacePeaks(
            np.maximum(shear, other),
            np.where(shear >= other, place, other_place),
            np.where(pulled, tension, 0.0),
            np.where(pulled, tension_place, np.nan),
        )

    # -- film ----------------------------------------------------------------------------------------------------------
    @cached_property
    def film_series(self) -> Array:
        """Chebyshev coefficients in log h of the four stresses; (node, 4, depth, x, cause)."""
        if DEPTH * self.table.upper >= self._thickness:
            raise StackError(f"film peaks: contacts wider than {1 / DEPTH:g} thicknesses have no film under 0.1 h")
        share = _map(DOWN, 0.0, 1.0)
        return self._in_body(self._film_spans, lambda h: DEPTH * h * (self._thickness / (DEPTH * h)) ** share)

    def _in_body(self, spans: Spans, depths: Callable[[float], Array]) -> Array:
        """Chebyshev coefficients in log h of the four stresses at depths, over panels."""
        return self.table.in_series(self._inside(ACROSS, spans, depths, _STRESSES))

    def _film_spans(self, h: float) -> tuple[tuple[float, float], ...]:
        """Ends of the panels over the film [m]: beside the contact as far as its width or the thickness lets it be."""
        beside = 2 * h * self._thickness / (h + self._thickness)
        return (-h - beside, -h), (-h, h), (h, h + beside)

    def film(self, contact: FilmContact) -> BodyPeaks:
        """Largest stresses of the film below depth 0.1 h of contacts read from the same table."""
        return self._body(contact, self.film_series)

    # -- base ----------------------------------------------------------------------------------------------------------
    @cached_property
    def base_series(self) -> Array:
        """As of the film, from the interface to two half-lengths and a thickness below it."""
        if self.table.system.kernel.stack.rigid:
            raise StackError("base peaks: a rigid base has no stresses")
        top = self._thickness * (1 + 1e-9)
        return self._in_body(self._base_spans, lambda h: _map(DOWN, top, 2 * (self._thickness + h)))

    def _base_spans(self, h: float) -> tuple[tuple[float, float], ...]:
        """Ends of the panels over the base [m]."""
        beside = h + 2 * self._thickness
        return (-beside, -h), (-h, h), (h, beside)

    def base(self, contact: FilmContact) -> BodyPeaks:
        """Largest stresses of the half-plane below the film, of contacts read from the same table."""
        return self._body(contact, self.base_series)

    def _body(self, contact: FilmContact, series: Array) -> BodyPeaks:
        count = contact.load.size
        largest = np.empty((2, count))
        for start in range(0, count, _CHUNK):
            some = slice(start, start + _CHUNK)
            stresses = self.read(contact, series, some)
            for number, measure in enumerate((von_mises, principal_tension)):
                largest[number, some] = _largest_measure(stresses, measure)
        return BodyPeaks(*largest)

    def read(self, contact: FilmContact, series: Array, some: slice = slice(None)) -> Array:
        """What some contacts read from a series of this table is at their half-lengths and causes; (case, ...)."""
        polynomials = self.table.polynomials(np.log(contact.half_width[some]))
        weights = np.einsum("cn,cq->cnq", polynomials, contact.causes.values[some]).reshape(len(polynomials), -1)
        flat = np.moveaxis(series, -1, 1).reshape(weights.shape[1], -1)
        return np.asarray((weights @ flat).reshape(-1, *series.shape[1:-1]))


def _map(count: int, start: float, end: float) -> Array:
    return np.asarray((start + end) / 2 + (end - start) / 2 * nodes(count))


def to_series(count: int) -> Array:
    """From values at the points to Chebyshev coefficients; (coefficient, point)."""
    matrix = 2 / count * np.polynomial.chebyshev.chebvander(nodes(count), count - 1).T
    matrix[0] /= 2
    return np.asarray(matrix, dtype=np.float64)


def _largest(values: Array, half: Array, spans: Spans) -> tuple[Array, Array]:
    """Largest value over the panels of the interface, and its X; (case,) each. Values (case, x)."""
    best, place = np.full(half.size, -np.inf), np.zeros(half.size)
    start = 0
    for panel, count in enumerate(INTERFACE):
        own = values[:, start : start + count]
        start += count
        series = own @ to_series(count).T
        slope, bend = (np.asarray(np.polynomial.chebyshev.chebder(series, n, axis=1), np.float64) for n in (1, 2))
        local = nodes(count)[np.argmax(own, 1)]
        reach = np.pi / count
        for _ in range(_STEPS):
            first, second = _series_at(slope, local), _series_at(bend, local)
            step = np.where(second < 0, -first / np.where(second < 0, second, 1.0), np.sign(first) * reach)
            step = np.clip(step, -reach, reach)
            local = np.clip(local + step, -1.0, 1.0)
            if np.all((np.abs(step) < 1e-8) | (np.abs(local) == 1.0)):
                break
        top = _series_at(series, local)
        ends = np.array([spans(float(h))[panel] for h in half])
        X = (ends.mean(1) + (ends[:, 1] - ends[:, 0]) / 2 * local) / half
        better = top > best
        best, place = np.where(better, top, best), np.where(better, X, place)
    return best, place


def _series_at(series: Array, local: Array) -> Array:
    """Each case's own series at its own point."""
    return np.asarray(np.polynomial.chebyshev.chebval(local, series.T, tensor=False))


def _largest_measure(stresses: Array, measure: Measure) -> Array:
    """Largest measure over the panels of the film; (case,). Stresses (case, 4, depth, x)."""
    best = np.full(len(stresses), -np.inf)
    down, start = to_series(DOWN), 0
    for count in ACROSS:
        own = stresses[..., start : start + count]
        start += count
        nodal = measure(*np.moveaxis(own, 1, 0)).reshape(len(own), -1)
        v, u = np.divmod(np.argmax(nodal, 1), count)
        series = down @ own @ to_series(count).T
        place = np.stack([nodes(DOWN)[v], nodes(count)[u]], -1)
        best = np.maximum(best, _climbed(series, place, measure, np.pi / np.array([DOWN, count])))
    return best


def _climbed(series: Array, place: Array, measure: Measure, reach: Array) -> Array:
    """Largest measure of the interpolant near a place (case, 2) within the panel: Newton's iteration on a stencil."""
    held, size = np.full(len(place), -np.inf), 1 - _STEP
    for _ in range(_STEPS):
        place = np.clip(place, -size, size)
        points = place[:, None] + _STEP * _STENCIL[:, ::-1]
        down = np.polynomial.chebyshev.chebvander(points[..., 0], series.shape[2] - 1)
        across = np.polynomial.chebyshev.chebvander(points[..., 1], series.shape[3] - 1)
        found = np.einsum("cfdp,cpd->fcp", series @ np.swapaxes(across, 1, 2)[:, None], down)
        around = measure(*found)
        held = np.maximum(held, around.max(1))
        sw, s, se, w, centre, e, nw, n, ne = around.T
        gradient = np.stack([(n - s) / 2, (e - w) / 2], -1) / _STEP
        mixed = (ne - nw - se + sw) / 4
        hessian = np.array([[n + s - 2 * centre, mixed], [mixed, e + w - 2 * centre]]) / _STEP**2
        stopped = (np.abs(place) >= size) & (gradient * place > 0)  # at the end of the panel and up beyond it
        gradient = np.where(stopped, 0.0, gradient)
        hessian = np.where(stopped.any(1), hessian * np.eye(2)[..., None], hessian)
        bend, turned = np.linalg.eigh(np.moveaxis(hessian, -1, 0))
        along = np.einsum("cij,ci->cj", turned, gradient)
        least = np.abs(along) / np.max(reach)
        step = np.einsum("cij,cj->ci", turned, along / np.maximum(np.maximum(-bend, np.abs(bend)), least + 1e-300))
        step = np.clip(step, -reach, reach)
        place = place + step
        if np.all(np.abs(np.clip(place, -size, size) - place + step) < 1e-5):
            break
    return held
