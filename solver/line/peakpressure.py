"""Largest pressure of contacts between smooth edges, from the polynomial that the pressure has beside its weight."""

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from scipy.fft import dct

from solver.arrays import Array
from solver.line.contact import FilmContact
from solver.line.outputs import PRESSURE

_NEGLIGIBLE = 1e-13  # of the largest coefficient
_SCAN = 2  # points a coefficient
_RIVAL = 0.9  # of the highest point: how low a hill's may lie
_HILL_STEPS = 60
_ANGLE_CLOSE = 1e-7  # in the angle: the pressure is flat there
_PRESSURES = 4096  # cases at a time: bounded memory


def peak_pressure(contact: FilmContact) -> Array:
    """Largest contact pressure [Pa] between two smooth edges; (case,)."""
    series = pressure_series(contact.table.series[:, PRESSURE])
    peaks = np.empty(contact.load.size)
    for start in range(0, peaks.size, _PRESSURES):
        block = slice(start, start + _PRESSURES)
        log_half, causes = np.log(contact.half_width[block]), contact.causes.values[block]
        pressures = contact.table.interval.read(log_half, series, causes)
        peaks[block] = largest(pressures, contact.exponent)
    return np.asarray(peaks / contact.scale[1])


def pressure_series(samples: Array) -> Array:
    """Chebyshev series in X without its negligible end, by values at ``SAMPLES`` (case, sample, ...)."""
    series = dct(samples, type=1, axis=1) / (samples.shape[1] - 1)
    series[:, [0, -1]] /= 2
    size = np.max(np.abs(series), axis=(0, *range(2, series.ndim)))
    return np.asarray(series[:, : int(np.flatnonzero(size > _NEGLIGIBLE * np.max(size))[-1]) + 1])


def largest(series: Array, exponent: float) -> Array:
    """Largest (1 - X)^A (1 + X)^B f(X), A = alpha, B = 1 - alpha; (case,).

    series: (case, coefficient), Chebyshev series of f.
    """
    A, B = exponent, 1 - exponent
    count = series.shape[1]
    grid = np.cos(np.pi * (np.arange(_SCAN * count) + 0.5) / (_SCAN * count))
    values = (1 - grid) ** A * (1 + grid) ** B * (series @ chebvander(grid, count - 1).T)
    padded = np.pad(values, ((0, 0), (1, 1)), constant_values=-np.inf)
    hill = (values >= padded[:, :-2]) & (values >= padded[:, 2:]) & (values >= _RIVAL * values.max(1, keepdims=True))
    cases, places = np.nonzero(hill)
    highest = np.full(len(series), -np.inf)
    np.maximum.at(highest, cases, _tops(series[cases], A, np.arccos(grid[places])))
    return highest


def _tops(series: Array, A: float, angle: Array) -> Array:
    """The tops of the hills on which points lie; (hill,)."""
    B, count = 1 - A, series.shape[1]
    reach = np.pi / (_SCAN * count)
    low, high = np.maximum(angle - reach, 0.0), np.minimum(angle + reach, np.pi)
    orders = np.arange(count)
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
