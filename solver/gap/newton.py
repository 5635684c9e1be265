"""Newton's iteration of contacts with air, along lines and at points: scaled systems, steps, and closed gaps."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, Self, TypeVar

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
    # Scale factors of rows and columns; (n,) each
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
    """The solution of one system (:class:`Factored`), refined once: pivots of rows of one size may be poor ones."""
    factored = Factored.of(matrix)
    result = factored.solve(right)
    return result + factored.solve(right - matrix @ result)


_NEWTON_STEPS = 40
_NEWTON_CLOSE = 1e-11
_STALLED = 1e-7  # steps below it that no longer shrink are rounding
_LONGEST = 0.3  # of the extent's unknowns in a step
_REOPENED = 3  # times at most that a closed gap is opened


class Iterated(Protocol):
    """State of a contact at some unknowns, the first of which are its extent."""

    @property
    def unknowns(self) -> Array:
        """Unknowns; (unknown,)."""

    @property
    def sizes(self) -> Array:
        """Scales of the unknowns, over which steps are measured; (unknown,)."""

    @property
    def gap(self) -> Array:
        """Gap at the nodes; (n,)."""

    @property
    def reopened(self) -> Array:
        """Unknowns with densities that open a gap which is closed next to an edge; (unknown,)."""

    def moved(self, unknowns: Array) -> Self:
        """The same contact at other unknowns."""


_State = TypeVar("_State", bound=Iterated)


def is_open(state: Iterated) -> bool:
    """Return True if the gap is positive at every node."""
    return bool(np.all(state.gap > 0))


def iterated(
    state: _State, step: Callable[[_State, float], Array], extents: int, *, quadratic: bool = False
) -> _State | None:
    """Limit of Newton's iteration, its gap open or not; None if it does not converge.

    step: Newton's step at a state, by the size of the last step; extents: number of unknowns whose steps are bounded;
    quadratic: each step solves its state's equations, so that the next one is about size^3 / last^2.
    """
    last = np.inf
    for _ in range(_NEWTON_STEPS):
        change = step(state, last)
        change /= max(1.0, float(np.max(np.abs(change[:extents]))) / _LONGEST)
        size = float(np.max(np.abs(change) / state.sizes))
        state = state.moved(state.unknowns - change)
        if size < _NEWTON_CLOSE or (size < _STALLED and size > last / 2):
            return state
        if quadratic and np.isfinite(last) and size**3 < _NEWTON_CLOSE * last**2:
            return state
        last = size
    return None


def opened(result: _State | None, search: Callable[[_State], _State | None]) -> _State | None:
    """The result if its gap is open, else the limit of searches from states whose gap is reopened."""
    for _ in range(_REOPENED):
        if result is None or is_open(result):
            break
        result = search(result.moved(result.reopened)) or result
    return result


def reopened(densities: Array, gap: Array) -> Array:
    """Densities that are those of the first open place from there up to the edge, where the gap is closed next to it.

    A density that draws the gap shut solves the gap's law too, with a potential of the other sign: Newton's iteration
    may come to it, and from here comes to the contact whose gap is open.
    """
    closed = np.flatnonzero(gap <= 0)
    first = min(int(closed[-1]) + 1, gap.size - 1) if closed.size else 0
    return np.where(np.arange(gap.size) < first, densities[:, first][:, None], densities)
