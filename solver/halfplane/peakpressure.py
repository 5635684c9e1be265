"""Largest pressure between smooth edges: (1 - X)^A (1 + X)^B f(X), A = alpha, B = 1 - alpha, f a Chebyshev series."""

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from solver.arrays import Array

_SCAN, _FEWEST = 2, 64  # points per coefficient, and their least number
_RIVAL = 0.9  # of the highest point: the least height of a climbed hill's
_HILL_STEPS = 60
_ANGLE_CLOSE = 1e-7  # last step in the angle: the pressure is flat at its maximum


def largest(series: Array, exponent: Array | float) -> Array:
    """Largest pressures for series f (case, coefficient) and one exponent alpha or one per case; (case,)."""
    A, size = np.broadcast_to(exponent, len(series)), max(_SCAN * series.shape[1], _FEWEST)
    grid = np.cos(np.pi * (np.arange(size) + 0.5) / size)
    weight = (1 - grid) ** A[:, None] * (1 + grid) ** (1 - A[:, None])
    values = weight * (series @ chebvander(grid, series.shape[1] - 1).T)
    padded = np.pad(values, ((0, 0), (1, 1)), constant_values=-np.inf)
    hill = (values >= padded[:, :-2]) & (values >= padded[:, 2:]) & (values >= _RIVAL * values.max(1, keepdims=True))
    cases, points = np.nonzero(hill)
    highest = np.full(len(series), -np.inf)
    np.maximum.at(highest, cases, _tops(series[cases], A[cases], np.arccos(grid[points]), np.pi / size))
    return highest


def _tops(series: Array, A: Array, angle: Array, reach: float) -> Array:
    """Largest pressures of hills within ``reach`` of the angles (hill,) of points on them; (hill,)."""
    B, orders = 1 - A, np.arange(series.shape[1])
    low, high = np.maximum(angle - reach, 0.0), np.minimum(angle + reach, np.pi)
    for _ in range(_HILL_STEPS):
        X, sine = np.cos(angle), np.sin(angle)
        cosines, sines = np.cos(angle[:, None] * orders), np.sin(angle[:, None] * orders)
        f, first = np.sum(series * cosines, 1), -np.sum(series * orders * sines, 1)
        second = -np.sum(series * orders**2 * cosines, 1)
        # d/d(angle) of the logarithm: A (1 + X) - B (1 - X) over the sine, and f'/f
        slope = (A * (1 + X) - B * (1 - X)) / sine + first / f
        bend = -A / (1 - X) - B / (1 + X) + second / f - (first / f) ** 2
        low, high = np.where(slope > 0, angle, low), np.where(slope > 0, high, angle)
        step = np.where(bend < 0, slope / np.where(bend < 0, -bend, 1.0), np.inf)
        ahead = angle + step
        ahead = np.where((ahead > low) & (ahead < high), ahead, (low + high) / 2)
        close = np.all(np.abs(ahead - angle) < _ANGLE_CLOSE)
        angle = ahead
        if close:
            break
    X = np.cos(angle)
    return np.asarray((1 - X) ** A * (1 + X) ** B * np.sum(series * np.cos(angle[:, None] * orders), 1))
