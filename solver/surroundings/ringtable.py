"""Operators of rings over the radius: one table for every sphere, force, charge and permittivity (points, 6)."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from approximation.chebyshev import coefficients
from approximation.piecewise import Interval
from solver.arrays import Array
from solver.point.profile import Shape
from solver.surroundings.ringoperators import RingOperators, Rows
from solver.surroundings.rings import Rings

NODES, FEW = 18, 8  # radii of half a decade and of a twentieth: 1e-12 between them, 1e-9 of what takes derivatives


class Places(Protocol):
    """What outputs and unknowns are those of."""

    @property
    def rows(self) -> Rows:
        """Places of the outputs."""

    @property
    def rings(self) -> Rings:
        """Panels beside the contact."""

    @property
    def shape(self) -> Shape:
        """The punch."""


@dataclass(frozen=True, eq=False)
class Read:
    """What is read of operators: it has their places.

    Parameters
    ----------
    operators
        Them.
    """

    operators: Places

    @cached_property
    def rows(self) -> Rows:
        """Places of the outputs."""
        return self.operators.rows

    @cached_property
    def rings(self) -> Rings:
        """Panels beside the contact."""
        return self.operators.rings

    @cached_property
    def shape(self) -> Shape:
        """The punch."""
        return self.operators.shape


class Tabled(Places, Protocol):
    """What a table is made of: operators, or another table."""

    @property
    def exact(self) -> RingOperators:
        """The operators."""

    def over(self, log_radii: Array) -> Array:
        """Outputs of every cause and density at several log a; (radius, row, column)."""


class RingsByRadius(Places, Protocol):
    """Outputs of :class:`solver.surroundings.ringoperators.RingOperators` at every radius of a body."""

    @property
    def exact(self) -> RingOperators:
        """Those that are solved at any radius."""

    def holds(self, log_radius: float) -> bool:
        """Whether it was made for this radius."""

    def read(self, log_radius: float, stop: int) -> tuple[Array, Array]:
        """The rows up to one, and their derivatives in log a; (row, column) each.

        Parameters
        ----------
        log_radius : float, log a in the unit of the body's lengths
        stop : int, the first row that is left out
        """

    def read_inside(self, log_radius: float) -> Array:
        """The rows below the contact; (row, column)."""


@dataclass(frozen=True, eq=False)
class RingTable(Read):
    """Operators on layers between two radii, by Chebyshev's polynomials in log a.

    Parameters
    ----------
    operators
        Operators at any radius.
    interval
        Range of log a, and its radii.
    """

    operators: Tabled
    interval: Interval

    @property
    def exact(self) -> RingOperators:
        """The operators that it is made of in the end."""
        return self.operators.exact

    @cached_property
    def values(self) -> tuple[Array, Array]:
        """Outputs at the radii, flat: those up to the pressures, and those below the contact; (node, ...)."""
        found = self.operators.over(self.interval.points)
        split = self.rows.pressure.start
        return found[:, :split].reshape(len(found), -1), found[:, split:].reshape(len(found), -1)

    def holds(self, log_radius: float) -> bool:
        """Whether a radius lies between the ends."""
        return self.interval.low <= log_radius <= self.interval.high

    def over(self, log_radii: Array) -> Array:
        """Outputs of every cause and density at several log a; (radius, row, column).

        Parameters
        ----------
        log_radii : ndarray, shape (radius,), log a in the unit of the body's lengths
        """
        local = self.interval.polynomials(log_radii, clipped=False) @ self._series[0]
        found = np.concatenate([local @ part for part in self.values], 1)
        return found.reshape(log_radii.size, self.rows.count, -1)

    def read(self, log_radius: float, stop: int) -> tuple[Array, Array]:
        """The rows up to the pressures, and their derivatives in log a; (row, column) each.

        Parameters
        ----------
        log_radius : float, log a in the unit of the body's lengths
        stop : int, the first row that is left out
        """
        if log_radius not in self._last:
            self._last.clear()
            self._last[log_radius] = (self._polynomials(log_radius) @ self.values[0]).reshape(2, stop, -1)
        found = self._last[log_radius]
        return found[0], found[1]

    @cached_property
    def _last(self) -> dict[float, Array]:
        """What was read last: iterations ask again where they begin."""
        return {}

    def read_inside(self, log_radius: float) -> Array:
        """The rows below the contact; (row, column)."""
        found: Array = self._polynomials(log_radius)[0] @ self.values[1]
        return found.reshape(self.rows.count - self.rows.pressure.start, -1)

    def _polynomials(self, log_radius: float) -> Array:
        """From values at the radii to those at log a and to derivatives; (2, node)."""
        local = self.interval.polynomials(np.array([log_radius]), clipped=False)
        return np.asarray(local @ self._series)[:, 0]

    @cached_property
    def _series(self) -> Array:
        series = coefficients(np.eye(self.interval.count))
        return np.stack([series, self.interval.derived(series)])


@dataclass(frozen=True, eq=False)
class RingsOnHalfSpace(Read):
    """Operators on a half-space, the same at every radius.

    Parameters
    ----------
    operators
        Them.
    """

    operators: RingOperators

    @property
    def exact(self) -> RingOperators:
        """The operators."""
        return self.operators

    @cached_property
    def _values(self) -> Array:
        return self.operators.at(1.0)

    def holds(self, log_radius: float) -> bool:
        """Whatever the radius."""
        return True

    def read(self, log_radius: float, stop: int) -> tuple[Array, Array]:
        """The rows up to one, and zeros.

        Parameters
        ----------
        log_radius : float, log a in the unit of the body's lengths
        stop : int, the first row that is left out
        """
        return self._values[:stop], np.zeros((stop, self._values.shape[1]))

    def read_inside(self, log_radius: float) -> Array:
        """The rows below the contact; (row, column)."""
        return self._values[self.rows.pressure.start :]
