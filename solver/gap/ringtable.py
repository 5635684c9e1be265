"""Operators of rings over the radius: tables of half decades, and of parts of them next to a few radii (points, 6).

One table serves every sphere, force, charge and permittivity. A contact is sought in a narrow table, which is quick to
read. It is made of the operators themselves where a call asks for few radii, and of the table of half a decade where it
asks for many. Which it is follows from the call alone.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from approximation.piecewise import Interval
from solver.arrays import Array
from solver.cache import cached
from solver.gap.ringoperators import RingOperators
from solver.gap.rings import rings
from solver.line.windows import number_of
from solver.point.kernel import normal_kernel
from solver.point.table import PointKind, interval
from solver.stack.wavenumbers import strip

NODES, FEW = 18, 8  # radii of half a decade and of a twentieth: 1e-12 between them, 1e-9 of what takes derivatives


@dataclass(frozen=True, eq=False)
class RingTable:
    """Operators on layers between two radii, by Chebyshev's polynomials in log a."""

    exact: RingOperators
    interval: Interval
    source: "RingTable | None" = None

    @cached_property
    def values(self) -> tuple[Array, Array]:
        """Outputs at the radii, flat: those up to the pressures, and those below the contact; (node, ...)."""
        result = (self.source or self.exact).over(self.interval.points)
        split = self.exact.rows.pressure.start
        return result[:, :split].reshape(len(result), -1), result[:, split:].reshape(len(result), -1)

    def holds(self, log_radius: float) -> bool:
        """Return True if a radius lies between the ends."""
        return self.interval.low <= log_radius <= self.interval.high

    def over(self, log_radii: Array) -> Array:
        """Outputs of every cause and density at several log a (radius,); (radius, row, column)."""
        local = self.interval.polynomials(log_radii, clipped=False) @ self._series[0]
        result = np.concatenate([local @ part for part in self.values], 1)
        return result.reshape(log_radii.size, self.exact.rows.count, -1)

    def read(self, log_radius: float) -> tuple[Array, Array]:
        """The rows up to the pressures at log a, and their derivatives in it; (row, column) each."""
        if log_radius not in self._last:
            self._last.clear()
            outputs = self._polynomials(log_radius) @ self.values[0]
            self._last[log_radius] = outputs.reshape(2, self.exact.rows.pressure.start, -1)
        value, rate = self._last[log_radius]
        return value, rate

    @cached_property
    def _last(self) -> dict[float, Array]:
        """Last result of ``read``: iterations ask again where they begin."""
        return {}

    def read_inside(self, log_radius: float) -> Array:
        """The rows below the contact at log a; (row, column)."""
        result: Array = self._polynomials(log_radius)[0] @ self.values[1]
        return result.reshape(self.exact.rows.count - self.exact.rows.pressure.start, -1)

    def _polynomials(self, log_radius: float) -> Array:
        """Interpolation matrix from the radii to the value at log a and its derivative; (2, node)."""
        local = self.interval.polynomials(np.array([log_radius]), clipped=False)
        return np.asarray(local @ self._series)[:, 0]

    @cached_property
    def _series(self) -> Array:
        return self.interval.taylor(2)


@dataclass(frozen=True, eq=False)
class RingsOnHalfSpace:
    """Operators on a half-space, the same at every radius."""

    exact: RingOperators

    @cached_property
    def _values(self) -> Array:
        return self.exact.matrix(1.0)

    def holds(self, _log_radius: float) -> bool:
        """Return True: the operators do not depend on the radius."""
        return True

    def read(self, _log_radius: float) -> tuple[Array, Array]:
        """The rows up to the pressures, and zeros; (row, column) each."""
        value = self._values[: self.exact.rows.pressure.start]
        return value, np.zeros_like(value)

    def read_inside(self, _log_radius: float) -> Array:
        """The rows below the contact; (row, column)."""
        return self._values[self.exact.rows.pressure.start :]


#: Outputs at every radius of a body.
RingsByRadius = RingTable | RingsOnHalfSpace


_STEP, _BEYOND = 0.11, 0.015  # of log a: a part, and what it has in common with the next one; air moves less
_MOST = 2  # parts of half a decade that are made by themselves: the next one has as many radii as the whole


@cached
def _half_decade(kind: PointKind, number: int) -> RingTable:
    return RingTable(_operators(kind), interval(number, NODES))


@cached
def _part(kind: PointKind, place: int, number: int | None) -> RingTable:
    """The part of a place in log a, from the table of half a decade or else by itself."""
    part = Interval(place * _STEP - _BEYOND, (place + 1) * _STEP + _BEYOND, FEW)
    return RingTable(_operators(kind), part, None if number is None else _half_decade(kind, number))


@cached
def _operators(kind: PointKind) -> RingOperators:
    stack = kind.film.stack()
    fields = tuple(field for field in (0, 1) if kind.conducts[field])
    return RingOperators(rings(), fields, kind.compliance, kind.shape, normal_kernel(stack), strip(stack))


def _place(ratio: float) -> int:
    return int(np.floor(np.log(ratio) / _STEP))


def _number(ratio: float) -> int:
    return int(number_of(np.array([ratio]))[0])


@dataclass(frozen=True, eq=False)
class RingWindows:
    """Tables of one kind of film."""

    kind: PointKind  # The film and the punch
    many: frozenset[int]  # Half decades of which many radii are asked for

    @classmethod
    def of(cls, kind: PointKind, ratios: Array) -> Self:
        """Choose tables for the radii of one call.

        ratios: (...), contact radii over the thickness.
        """
        places_of: dict[int, set[int]] = {}
        for ratio in np.unique(ratios).tolist():
            places_of.setdefault(_number(ratio), set()).add(_place(ratio))
        return cls(kind, frozenset(number for number, places in places_of.items() if len(places) > _MOST))

    def narrow(self, ratio: float) -> RingTable:
        """About a radius over the thickness."""
        number = _number(ratio)
        return _part(self.kind, _place(ratio), number if number in self.many else None)

    def wide(self, ratio: float) -> RingTable:
        """Half a decade that holds it."""
        return _half_decade(self.kind, _number(ratio))
