"""Elementary functions in forms that keep their figures where the plain ones cancel.

Only what NumPy and SciPy do not have: remainders of Taylor series, and the difference of two digamma functions.
"""

import math

import numpy as np
from scipy.special import hyp1f1, polygamma

from solver.arrays import Array

_ATANH_SERIES = np.array([1.0 / (2 * n + 1) for n in range(1, 18)])
_DIGAMMA_SERIES = np.array([float(polygamma(n, 1.5)) / math.factorial(n) for n in range(1, 49)])


def atanh_minus(u: Array) -> Array:
    """``arctanh(u) - u`` for ``|u| < 1``, exact to rounding also where ``u`` is small."""
    square = u * u
    small = square < 0.1
    series = u * square * np.polynomial.polynomial.polyval(np.where(small, square, 0.0), _ATANH_SERIES, tensor=False)
    return np.where(small, series, np.arctanh(np.where(small, 0.5, u)) - u)


def exprel2(v: Array) -> Array:
    """``(exp(v) - 1 - v) / v**2``, 1/2 at ``v = 0``."""
    return np.asarray(hyp1f1(1.0, 3.0, v) / 2.0)


def exprel3(v: Array) -> Array:
    """``(exp(v) - 1 - v - v**2/2) / v**3``, 1/6 at ``v = 0``."""
    return np.asarray(hyp1f1(1.0, 4.0, v) / 6.0)


def digamma_difference(delta: Array) -> Array:
    """``(digamma(3/2 + delta) - digamma(3/2)) / delta`` for ``|delta| <= 1/2``; trigamma(3/2) at 0.

    The Taylor series about 3/2 has radius 3/2, so 48 terms reach rounding at ``|delta| = 1/2``.
    """
    return np.asarray(np.polynomial.polynomial.polyval(delta, _DIGAMMA_SERIES, tensor=False))
