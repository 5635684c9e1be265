"""Factors on intervals in slabs of every input and corners of every two inputs.

Held-out cases that share some inputs form a group, which counts as one place of these inputs. Source: V. Vovk, Proc.
Mach. Learn. Res. 25 (2012) 475 (coverage by class).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Self

import numpy as np

from approximation.arrays import Array, Flags, Indices
from surrogate.intervals.distribution import NOMINAL

SLABS = 10
SLAB_PLACES, CORNER_PLACES = 20, 8  # fewest places from which a slab's or a corner's quantile is estimated
SLAB_LEVEL, CORNER_LEVEL = NOMINAL, 0.98  # shares of their cases that must hold: a corner has few, so room for error


@dataclass(frozen=True)
class Guard:
    """Logarithms of further scales, >= 0; the largest of all cells that contain a point counts."""

    slabs: Array  # shape (d, SLABS, p); in slabs of equal width of every scaled input
    # shape (d (d - 1) / 2, 3, 3, p); where both inputs of a pair are in outermost slabs: 0 lower, 2 upper; 1, between
    # them, is zero. Pairs are in the order of `itertools.combinations`.
    corners: Array
    pooled: Array | None = None  # shape (p,); in any of these corners, from the cases of all corners together

    def at(self, t: Array) -> Array:
        """Return the guard at scaled coordinates t within the box, (d, B): (B, p)."""
        slab = slabs(t)
        guard: Array = self.slabs[0][slab[0]]
        for by_factor, place in zip(self.slabs[1:], slab[1:], strict=True):
            np.maximum(guard, by_factor[place], out=guard)
        edge = _edge(slab)
        rows = np.flatnonzero((edge != 1).sum(0) > 1)
        if rows.size:
            i, j = np.array(list(combinations(range(len(t)), 2))).T
            corners = self.corners[np.arange(i.size)[:, None], edge[i][:, rows], edge[j][:, rows]]
            guard[rows] = np.maximum(guard[rows], corners.max(0))
            if self.pooled is not None:
                guard[rows] = np.maximum(guard[rows], self.pooled)
        return guard

    def only(self, columns: Sequence[int]) -> Self:
        """Return the guard of the outputs `columns`."""
        chosen = list(columns)
        pooled = None if self.pooled is None else self.pooled[chosen]
        return replace(self, slabs=self.slabs[..., chosen], corners=self.corners[..., chosen], pooled=pooled)


def unguarded(inputs: int, outputs: int, pooled: bool = False) -> Guard:
    """Return a guard of zeros, to be filled."""
    corners = np.zeros((inputs * (inputs - 1) // 2, 3, 3, outputs))
    return Guard(np.zeros((inputs, SLABS, outputs)), corners, np.zeros(outputs) if pooled else None)


def fill(guard: Guard, output: int, scores: Array, level: float, t: Array, groups: Indices, even: Flags) -> None:
    """Set an output's guard so that its intervals hold in every cell, from scores (n,) at scaled coordinates (d, n)."""

    def needed(cell: Indices, fewest: int, share: float) -> float:
        if len(np.unique(groups[cell])) < fewest:
            return 0.0
        ordered = np.sort(scores[cell])
        rank = min(len(ordered), int(np.ceil((len(ordered) + 1) * share)))
        return max(0.0, float(ordered[rank - 1]) - level)

    slab = slabs(t)
    for place, cell in _cells(slab):
        if len(place) == 2:
            cells = cell, cell[even[cell]]
            guard.slabs[(*place, output)] = max(needed(cell_scores, SLAB_PLACES, SLAB_LEVEL) for cell_scores in cells)
        else:
            guard.corners[(*place, output)] = needed(cell, CORNER_PLACES, CORNER_LEVEL)
    if guard.pooled is not None:
        corner = np.flatnonzero((_edge(slab) != 1).sum(axis=0) > 1)
        guard.pooled[output] = needed(corner, CORNER_PLACES, CORNER_LEVEL)


def slabs(t: Array) -> Indices:
    """Return the slab numbers of scaled coordinates, any shape."""
    return np.clip(((t + 1) / 2 * SLABS).astype(np.intp), 0, SLABS - 1)


def _cells(slab: Indices) -> Iterator[tuple[tuple[int, ...], Indices]]:
    """Yield the position of every cell in the guard's arrays, and its cases."""
    for factor, numbers in enumerate(slab):
        for number in range(SLABS):
            yield (factor, number), np.flatnonzero(numbers == number)
    for pair, (i, j) in enumerate(combinations(range(len(slab)), 2)):
        for a in (0, 2):
            for b in (0, 2):
                yield (pair, a, b), np.flatnonzero((_edge(slab[i]) == a) & (_edge(slab[j]) == b))


def _edge(slab: Indices) -> Indices:
    """Return 0 in the lowest slab, 2 in the highest, 1 between."""
    return np.asarray((slab > 0).astype(np.intp) + (slab == SLABS - 1))


def sharing(t: Array) -> Indices:
    """Return the group of every case, (n,), by equality in the coordinates (d, n) with at most n/2 distinct values."""
    few = [row for row in t if len(np.unique(row)) <= t.shape[1] / 2]
    if not few:
        return np.arange(t.shape[1])
    return np.unique(np.stack(few), axis=1, return_inverse=True)[1].reshape(-1)


def places(t: Array, groups: Indices) -> Indices:
    """Return the number of places along every input, (d,): of groups for inputs that they share, else of cases."""
    count, cases = len(np.unique(groups)), t.shape[1]
    return np.array([count if len(np.unique(row)) <= count else cases for row in t])
