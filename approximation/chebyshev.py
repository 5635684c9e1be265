"""Chebyshev points of the first kind, the polynomials through values at them, and Gauss-Legendre rules.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice (2013), chapters 2 to 4.
"""

from functools import cache
from typing import Any

import numpy as np
import scipy  # scipy.fft, and scipy.special: slow to import, and not every job needs them
from numpy.polynomial.chebyshev import chebvander

from approximation.arrays import Array

_FEW = 32  # points below which one compiled recurrence a polynomial beats a step in Python for all points


def gauss_points(count: int) -> Array:
    """Return the zeros of the Chebyshev polynomial T_count, ascending and antisymmetric, shape (count,)."""
    if count != int(count) or count < 1:
        raise ValueError(f"a number of Chebyshev points must be a whole number >= 1, got {count!r}")
    # equal shares of a right angle are equal numbers: those of n are among those of 3 n, to the last bit
    return np.asarray(np.sin(np.pi / 2 * (np.arange(1 - int(count), int(count), 2) / count)))


@cache
def legendre_rule(count: int) -> tuple[Array, Array]:
    """Return nodes and weights of the Gauss-Legendre rule on [-1, 1]; (count,) each."""
    return np.polynomial.legendre.leggauss(count)


def mapped_points(count: int, start: float, end: float) -> Array:
    """Return the points of `gauss_points` on another interval, from `start` on; (count,)."""
    return np.asarray((start + end) / 2 + (end - start) / 2 * gauss_points(count))


def coefficients(values: Array, axis: int = 0) -> Array:
    """Return the coefficients of polynomials through values (..., n, ...) at `gauss_points`, by a cosine transform."""
    # the transform counts points from the right end
    series = scipy.fft.dct(np.flip(values, axis), type=2, axis=axis) / values.shape[axis]
    first: list[Any] = [slice(None)] * values.ndim
    first[axis] = 0
    series[tuple(first)] /= 2
    return np.asarray(series)


def interpolation(count: int, places: Array) -> Array:
    """Return the interpolation matrix from values at `gauss_points` to places (n,) within [-1, 1]; (n, count)."""
    return np.asarray(chebvander(places, count - 1) @ coefficients(np.eye(count)))


def polynomials(t: Array, count: int) -> Array:
    """Return T_0 .. T_{count-1} at t, (B,), by their recurrence: (count, B); valid outside [-1, 1] too."""
    if len(t) < _FEW:
        return np.asarray(scipy.special.eval_chebyt(np.arange(count)[:, None], t))
    T = np.empty((count, len(t)))
    T[0] = 1
    if count > 1:
        T[1] = t
    double = 2 * t
    for m in range(2, count):
        np.multiply(double, T[m - 1], out=T[m])
        T[m] -= T[m - 2]
    return T


def slopes(t: Array, T: Array) -> Array:
    """Return the derivatives, (count, B), of polynomials T, (count, B), at places t, (B,); count > 1."""
    S = np.zeros_like(T)
    S[1] = 1
    for m in range(2, len(T)):
        S[m] = 2 * (T[m - 1] + t * S[m - 1]) - S[m - 2]
    return S
