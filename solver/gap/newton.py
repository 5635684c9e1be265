"""Newton's iteration of contacts with air, along lines and at points: scaled systems, and gaps that a step shuts."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve

from solver.arrays import Array


@dataclass(frozen=True, eq=False)
class Factored:
    """LU factors of a system, its columns and then its rows divided by their largest entries first.

    Charges a thousand half-lengths away move the contact by a thousand times their density, and the gap's law next to
    the edge is divided by a gap of 1e-9: as it stands, the rounding of the ones is 1e-4 of the others.
    """

    factors: tuple[Array, NDArray[np.int32]]  # Of :func:`scipy.linalg.lu_factor`
    # What those are multiplied by; (n,) each
    rows: Array
    columns: Array

    @classmethod
    def of(cls, matrix: Array) -> Self:
        """Scale and factorise a matrix (n, n)."""
        columns = 1 / np.max(np.abs(matrix), axis=0)
        scaled = matrix * columns
        rows = 1 / np.max(np.abs(scaled), axis=1)
        scaled *= rows[:, None]
        return cls(lu_factor(scaled, overwrite_a=True, check_finite=False), rows, columns)

    def solve(self, right: Array) -> Array:
        """The solution; right (n,) or (n, m)."""
        result = lu_solve(self.factors, (right.T * self.rows).T, check_finite=False)
        return np.asarray((result.T * self.columns).T)


def solved(matrix: Array, right: Array) -> Array:
    """The solution of one system (:class:`Factored`)."""
    return Factored.of(matrix).solve(right)


MOST = 3  # times at most that such a gap is opened


def reopened(densities: Array, gap: Array) -> Array:
    """Densities that are those of the first open place from there up to the edge, where the gap is closed next to it.

    A density that draws the gap shut solves the gap's law too, with a potential of the other sign: Newton's iteration
    may come to it, and from here comes to the contact whose gap is open.
    """
    closed = np.flatnonzero(gap <= 0)
    first = min(int(closed[-1]) + 1, gap.size - 1) if closed.size else 0
    return np.where(np.arange(gap.size) < first, densities[:, first][:, None], densities)
