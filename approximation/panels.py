"""Adjacent panels of Chebyshev points in one or two coordinates, with polynomials between the points."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebder
from numpy.typing import NDArray

from approximation.arrays import Array, Indices
from approximation.chebyshev import coefficients, gauss_points, mapped_points


@dataclass(frozen=True)
class Panels:
    """Net of panels, whose points are ordered by row of panels, then by panel, then row by row in the panel."""

    across: tuple[int, ...]  # number of points of every panel along the first coordinate
    down: tuple[int, ...] = (1,)  # number of points of every row of panels along the second coordinate, if there is one

    def __post_init__(self) -> None:
        if not self.across or not self.down or min(self.across) < 2 or min(self.down) < 1:
            raise ValueError(f"panels of {self.across} by {self.down} points are none")

    @property
    def size(self) -> int:
        """Number of points of all panels."""
        return sum(self.down) * sum(self.across)

    @cached_property
    def parts(self) -> tuple[tuple[int, int, slice], ...]:
        """Number of points down and across of every panel, and the slice of its points."""
        shapes = [(down, across) for down in self.down for across in self.across]
        ends = np.cumsum([0, *(down * across for down, across in shapes)]).tolist()
        return tuple((*shape, slice(*pair)) for shape, pair in zip(shapes, pairwise(ends), strict=True))

    def by_panel(self, values: Array) -> Array:
        """Return values on a net of all points, (..., down, across), in the points' order: (..., point)."""
        rows, columns = np.cumsum(self.down)[:-1], np.cumsum(self.across)[:-1]
        panels = [part for row in np.split(values, rows, -2) for part in np.split(row, columns, -1)]
        return np.concatenate([part.reshape(*part.shape[:-2], -1) for part in panels], -1)

    @cached_property
    def scan(self) -> "Scan":
        """The points at which local maxima are searched: every other row of a panel, and its last row."""
        sampled_rows = [np.union1d(np.arange(0, down, 2), [down - 1]) for down, _, _ in self.parts]
        points = [
            (part.start + sampled[:, None] * across + np.arange(across)).ravel()
            for (_, across, part), sampled in zip(self.parts, sampled_rows, strict=True)
        ]
        places = [
            np.stack(np.meshgrid(gauss_points(across), gauss_points(down)[sampled])).reshape(2, -1)
            for (down, across, _), sampled in zip(self.parts, sampled_rows, strict=True)
        ]
        shapes = tuple((len(sampled), across) for (_, across, _), sampled in zip(self.parts, sampled_rows, strict=True))
        panel = np.repeat(np.arange(len(points)), list(map(len, points)))
        return Scan(shapes, np.concatenate(points), panel, *np.concatenate(places, axis=1))


@dataclass(frozen=True, eq=False)
class Scan:
    """A subset of the points of panels."""

    shapes: tuple[tuple[int, int], ...]  # number of points down and across of every panel
    points: Indices  # numbers of the points
    panel: Indices  # number of the panel of every point
    across: Array  # coordinates of every point in its panel
    down: Array

    def hills(self, values: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]]:
        """Return values (B, point), -inf where a neighbour in the same row or column of the panel is higher."""
        out = values.copy()
        for lower, upper in self._neighbours:
            first, second = values[:, lower], values[:, upper]
            out[:, lower] = np.where(first < second, -np.inf, out[:, lower])
            out[:, upper] = np.where(second < first, -np.inf, out[:, upper])
        return out

    @cached_property
    def _neighbours(self) -> list[tuple[Indices, Indices]]:
        """First and second points of all neighbours along rows, and of all neighbours along columns."""
        pairs: tuple[list[Indices], list[Indices]] = ([], [])
        start = 0
        for down, across in self.shapes:
            net = start + np.arange(down * across).reshape(down, across)
            pairs[0].append(np.stack([net[:, :-1].ravel(), net[:, 1:].ravel()]))
            pairs[1].append(np.stack([net[:-1].ravel(), net[1:].ravel()]))
            start += down * across
        joined = [np.concatenate(pair, axis=1) for pair in pairs]
        return [(pair[0], pair[1]) for pair in joined if pair.size]


def line(counts: Sequence[int], ends: Sequence[float]) -> Array:
    """Return the coordinates of the points of adjacent panels with the given `ends`, (point,)."""
    return np.concatenate([mapped_points(n, *pair) for n, pair in zip(counts, pairwise(ends), strict=True)])


def spacing(place: Array, count: int | Indices) -> Array:
    """Return the approximate distance of `count` Chebyshev points near a place in [-1, 1]."""
    angle = np.pi / count
    return np.asarray(angle * np.sqrt(np.maximum(1 - place**2, 0)) + angle**2 / 2)


def rows(count: int, places: Array) -> Array:
    """Return matrices from values at a panel's points to the value and two derivatives at places: (n, 3, count)."""
    if count == 1:
        return np.tile([[1.0], [0.0], [0.0]], (len(places), 1, 1))
    T = np.cos(np.arccos(places)[:, None] * np.arange(count))
    return (T @ _derived(count)).reshape(len(places), 3, count)


@cache
def _derived(count: int) -> Array:
    """Matrix from values at the points to Chebyshev coefficients of function and two derivatives; (count, 3 count)."""
    series = coefficients(np.eye(count))
    derivatives = [chebder(series, m) if count > m else np.zeros((0, count)) for m in (0, 1, 2)]
    whole = [np.concatenate([matrix, np.zeros((count - len(matrix), count))]) for matrix in derivatives]
    return np.ascontiguousarray(np.stack(whole, axis=1).reshape(count, 3 * count))


def jets(fields: Array, across: Array, down: Array) -> Array:
    """Return fields (n, m, down, across) and their derivatives, by order down and across, (n, m, 3, 3), from `rows`."""
    n, m, height, width = fields.shape
    along = (fields.reshape(n, m * height, width) @ np.swapaxes(across, 1, 2)).reshape(n, m, height, 3)
    return np.asarray(down[:, None] @ along)
