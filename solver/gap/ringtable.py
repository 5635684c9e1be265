"""Operators of rings over the radius: one table for every sphere, force, charge and permittivity (points, 6)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.piecewise import Interval
from solver.arrays import Array
from solver.gap.ringoperators import RingOperators

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
        found = (self.source or self.exact).over(self.interval.points)
        split = self.exact.rows.pressure.start
        return found[:, :split].reshape(len(found), -1), found[:, split:].reshape(len(found), -1)

    def holds(self, log_radius: float) -> bool:
        """Whether a radius lies between the ends."""
        return self.interval.low <= log_radius <= self.interval.high

    def over(self, log_radii: Array) -> Array:
        """Outputs of every cause and density at several log a (radius,); (radius, row, column)."""
        local = self.interval.polynomials(log_radii, clipped=False) @ self._series[0]
        found = np.concatenate([local @ part for part in self.values], 1)
        return found.reshape(log_radii.size, self.exact.rows.count, -1)

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
        """What was read last: iterations ask again where they begin."""
        return {}

    def read_inside(self, log_radius: float) -> Array:
        """The rows below the contact at log a; (row, column)."""
        found: Array = self._polynomials(log_radius)[0] @ self.values[1]
        return found.reshape(self.exact.rows.count - self.exact.rows.pressure.start, -1)

    def _polynomials(self, log_radius: float) -> Array:
        """From values at the radii to those at log a and to derivatives; (2, node)."""
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
        return self.exact.at(1.0)

    def holds(self, _log_radius: float) -> bool:
        """Whatever the radius."""
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
