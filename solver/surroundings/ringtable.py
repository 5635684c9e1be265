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

NODES = 18  # radii of a window: 1e-12 between them


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

    @property
    def rows(self) -> Rows:
        """Places of the outputs."""
        return self.operators.rows

    @property
    def rings(self) -> Rings:
        """Panels beside the contact."""
        return self.operators.rings

    @property
    def shape(self) -> Shape:
        """The punch."""
        return self.operators.shape


class RingsByRadius(Places, Protocol):
    """Outputs of :class:`solver.surroundings.ringoperators.RingOperators` at every radius of a body."""

    def read(self, log_radius: float, stop: int) -> tuple[Array, Array]:
        """The rows up to one, and their derivatives in log a; (row, column) each."""

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
        Range of log a.
    """

    operators: RingOperators
    interval: Interval

    @cached_property
    def values(self) -> tuple[Array, Array]:
        """Outputs at the radii, flat: those up to the pressures, and those below the contact; (node, ...)."""
        found = np.stack([self.operators.at(float(np.exp(at))) for at in self.interval.points])
        split = self.rows.pressure.start
        return found[:, :split].reshape(NODES, -1), found[:, split:].reshape(NODES, -1)

    def read(self, log_radius: float, stop: int) -> tuple[Array, Array]:
        """The rows up to the pressures, and their derivatives in log a; (row, column) each."""
        found = (self._polynomials(log_radius) @ self.values[0]).reshape(2, stop, -1)
        return found[0], found[1]

    def read_inside(self, log_radius: float) -> Array:
        """The rows below the contact; (row, column)."""
        found: Array = self._polynomials(log_radius)[0] @ self.values[1]
        return found.reshape(self.rows.count - self.rows.pressure.start, -1)

    def _polynomials(self, log_radius: float) -> Array:
        """From values at the radii to those at log a and to derivatives; (2, node)."""
        return np.asarray(self.interval.polynomials(np.array([log_radius])) @ self._series)[:, 0]

    @cached_property
    def _series(self) -> Array:
        series = coefficients(np.eye(NODES))
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

    @cached_property
    def _values(self) -> Array:
        return self.operators.at(1.0)

    def read(self, log_radius: float, stop: int) -> tuple[Array, Array]:
        """The rows up to one, and zeros."""
        return self._values[:stop], np.zeros((stop, self._values.shape[1]))

    def read_inside(self, log_radius: float) -> Array:
        """The rows below the contact; (row, column)."""
        return self._values[self.rows.pressure.start :]
