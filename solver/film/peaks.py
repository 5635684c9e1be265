"""Largest stresses of a film and on its lowest interface, read from tables over half-lengths (film surrogates, 2).

Stresses on Chebyshev panels tied to the edges of the contact are linear in the causes at a half-length and smooth in
its logarithm. A case is a product; the best node of every panel starts a climb on the interpolant.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from approximation.chebyshev import coefficients, mapped_points
from approximation.measure import ITSELF, Measure
from approximation.summit import highest
from solver.arrays import Array
from solver.curves import PRINCIPAL, REGIONS, VON_MISES
from solver.film.contact import FilmContact
from solver.film.interior import Interior
from solver.film.stack import StackError
from solver.film.table import Table
from solver.film.tractions import Tractions

DEPTH = 0.1  # of the half-length: the least depth of the film's peaks
WINDOW = 10.0  # thicknesses beside the contact in which the interface is searched

_STRESSES = ("stress_xx", "stress_yy", "stress_xy", "stress_zz")
ACROSS = (44, 72, 44)  # nodes of the panels beside, under and beside the contact, of the film
DOWN = 16
INTERFACE = REGIONS["interface"].across
_NEAR = 2.0  # thicknesses, where the two panels of the interface beside the contact meet
_ALIKE = 1e-9  # relative difference up to which two tops are equals
_CLOSE = 1e-8  # step of Newton's iteration in a panel's half-width: the next is of its square
_CHUNK = 256  # cases at a time: bounded memory


Spans = Callable[[float], tuple[tuple[float, float], ...]]


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
        return coefficients(found[:, :, 0])

    def _inside(
        self, counts: tuple[int, ...], spans: Spans, depths: Callable[[float], Array], names: tuple[str, ...]
    ) -> Array:
        """Fields at the half-lengths of the table, on panels and at depths of each; (node, field, depth, x, cause)."""
        lengths = self.table.half_lengths.tolist()
        across = [[mapped_points(n, *ends) / h for n, ends in zip(counts, spans(h), strict=True)] for h in lengths]
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
            np.where(shear >= other * (1 - _ALIKE), place, other_place),
            np.where(pulled, tension, 0.0),
            np.where(pulled, tension_place, np.nan),
        )

    # -- film ----------------------------------------------------------------------------------------------------------
    @cached_property
    def film_series(self) -> Array:
        """Chebyshev coefficients in log h of the four stresses; (node, 4, depth, x, cause)."""
        if DEPTH * self.table.upper >= self._thickness:
            raise StackError(f"film peaks: contacts wider than {1 / DEPTH:g} thicknesses have no film under 0.1 h")
        share = mapped_points(DOWN, 0.0, 1.0)
        return self._in_body(self._film_spans, lambda h: DEPTH * h * (self._thickness / (DEPTH * h)) ** share)

    def _in_body(self, spans: Spans, depths: Callable[[float], Array]) -> Array:
        """Chebyshev coefficients in log h of the four stresses at depths, over panels."""
        return coefficients(self._inside(ACROSS, spans, depths, _STRESSES))

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
        return self._in_body(self._base_spans, lambda h: mapped_points(DOWN, top, 2 * (self._thickness + h)))

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
            for number, measure in enumerate((VON_MISES, PRINCIPAL)):
                largest[number, some] = _largest_measure(stresses, measure)
        return BodyPeaks(*largest)

    def read(self, contact: FilmContact, series: Array, some: slice = slice(None)) -> Array:
        """What some contacts read from a series of this table is at their half-lengths and causes; (case, ...)."""
        polynomials = self.table.polynomials(np.log(contact.half_width[some]))
        weights = np.einsum("cn,cq->cnq", polynomials, contact.causes.values[some]).reshape(len(polynomials), -1)
        flat = np.moveaxis(series, -1, 1).reshape(weights.shape[1], -1)
        return np.asarray((weights @ flat).reshape(-1, *series.shape[1:-1]))


def _largest(values: Array, half: Array, spans: Spans) -> tuple[Array, Array]:
    """Largest value over the panels of the interface, and its X; (case,) each. Values (case, x)."""
    ends = np.array([spans(h) for h in half.tolist()])
    tops, places = [], []
    for panel, part in enumerate(_parts(INTERFACE)):
        local, _, top = highest(values[:, None, None, part], ITSELF, _CLOSE)
        start, end = ends[:, panel].T
        tops.append(top)
        places.append(((start + end) / 2 + (end - start) / 2 * local) / half)
    alike = np.array(tops) >= np.max(tops, 0) - _ALIKE * np.abs(np.max(tops, 0))
    best = np.argmax(alike, 0), np.arange(half.size)  # of equals the first from the leading side
    return np.max(tops, 0), np.array(places)[best]


def _largest_measure(stresses: Array, measure: Measure) -> Array:
    """Largest measure over the panels of the film; (case,). Stresses (case, 4, depth, x)."""
    return np.asarray(np.max([highest(stresses[..., part], measure, _CLOSE)[2] for part in _parts(ACROSS)], 0))


def _parts(counts: tuple[int, ...]) -> list[slice]:
    """The points of every panel across."""
    return [slice(*ends) for ends in pairwise(np.cumsum((0, *counts)).tolist())]
