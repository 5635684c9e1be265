"""Functions tabulated at Chebyshev points: polynomials on an interval and on adjacent panels."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial.chebyshev import chebder

from approximation.arrays import Array, Flags
from approximation.chebyshev import coefficients, mapped_points, polynomials
from approximation.panels import line


@dataclass(frozen=True)
class Interval:
    """An interval with `count` Chebyshev points."""

    low: float
    high: float
    count: int

    @cached_property
    def points(self) -> Array:
        """Chebyshev points of the interval, rising; (count,)."""
        return mapped_points(self.count, self.low, self.high)

    def polynomials(self, places: Array, *, clipped: bool = True) -> Array:
        """Return Chebyshev polynomials at places (place,): (place, count)."""
        local = (2 * places - self.low - self.high) / (self.high - self.low)
        return polynomials(np.clip(local, -1.0, 1.0) if clipped else local, self.count).T

    def read(self, places: Array, series: Array, causes: Array | None = None) -> Array:
        """Return series (count, ...) at places: (place, ...); `causes` (place, cause) sum a last axis of the series."""
        weights = self.polynomials(places)
        if causes is None:
            return np.asarray(np.tensordot(weights, series, 1))
        weights = np.einsum("pn,pc->pnc", weights, causes).reshape(len(weights), -1)
        flat = np.moveaxis(series, -1, 1).reshape(weights.shape[1], -1)
        return np.asarray((weights @ flat).reshape(-1, *series.shape[1:-1]))

    def derived(self, series: Array) -> Array:
        """Return the Chebyshev coefficients of the derivative, as many as of the function; (count, ...)."""
        slopes = chebder(series) * 2 / (self.high - self.low)
        return np.concatenate([slopes, np.zeros((1, *slopes.shape[1:]))])


@dataclass(frozen=True, eq=False)
class Piecewise:
    """A function that is a polynomial on every panel."""

    ends: Array  # shape (panel + 1,); ends of the panels, rising
    series: Array  # shape (panel, count, ...); Chebyshev coefficients on every panel

    @classmethod
    def of(cls, values: Callable[[Array], Array], ends: Array, count: int, groups: Array | None = None) -> "Piecewise":
        """Tabulate a function on panels with ends (panel + 1,), calling it once for each group (panel,) of panels."""
        parts: list[Array] = []
        marks = np.zeros(ends.size - 1) if groups is None else groups
        for first, last in pairwise([0, *(1 + np.flatnonzero(np.diff(marks))).tolist(), marks.size]):
            tabulated = values(line([count] * (last - first), ends[first : last + 1].tolist()))
            parts.append(coefficients(tabulated.reshape(last - first, count, *tabulated.shape[1:]), axis=1))
        return cls(ends, np.concatenate(parts))

    def at(self, places: Array, mixing: Array | None = None) -> Array:
        """Return values at places (...) within the panels, (..., output), or their sums by mixing (output, mixed)."""
        flat, count = places.ravel(), self.series.shape[1]
        series = self.series.reshape(len(self.series), count, -1) if mixing is None else self.series @ mixing
        panel = np.searchsorted(self.ends[1:-1], flat, side="right")
        order = np.argsort(panel.astype(np.uint16), kind="stable")
        panels = panel[order]
        bounds = np.searchsorted(panels, np.arange(len(series) + 1)).tolist()
        middle, half = (self.ends[1:] + self.ends[:-1]) / 2, np.diff(self.ends) / 2
        T = polynomials((flat[order] - middle[panels]) / half[panels], count).T
        sorted_values, out = np.empty((flat.size, series.shape[2])), np.empty((flat.size, series.shape[2]))
        for panel_series, (start, stop) in zip(series, pairwise(bounds), strict=True):
            if stop > start:
                sorted_values[start:stop] = T[start:stop] @ panel_series
        out[order] = sorted_values
        return out.reshape(*places.shape, *(self.series.shape[2:] if mixing is None else mixing.shape[1:]))

    def halved(self, values: Callable[[Array], Array], which: Flags) -> "Piecewise":
        """Return the function with the panels marked in `which`, (panel,), halved and tabulated again."""
        middles = (self.ends[:-1] + self.ends[1:]) / 2
        ends = np.sort(np.concatenate([self.ends, middles[which]]))
        series, count = np.repeat(self.series, 1 + which, axis=0), self.series.shape[1]
        first = np.flatnonzero(which) + np.arange(np.count_nonzero(which))  # of the halves, among the new panels
        halves = np.sort(np.concatenate([first, first + 1]))
        points = np.concatenate([mapped_points(count, *ends[p : p + 2].tolist()) for p in halves])
        series[halves] = coefficients(values(points).reshape(len(halves), *series.shape[1:]), axis=1)
        return Piecewise(ends, series)

    def mirrored(self, odd: Flags) -> "Piecewise":
        """Return the function continued below its first end, 0, its outputs odd where marked, (output,), else even."""
        signs = (-1.0) ** np.arange(self.series.shape[1])[:, None] * np.where(odd, -1.0, 1.0)
        ends = np.concatenate([-self.ends[:0:-1], self.ends])
        return Piecewise(ends, np.concatenate([signs * self.series[::-1], self.series]))
