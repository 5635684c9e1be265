"""What NumPy and SciPy do not have: the difference of two digamma functions, without cancellation."""

import math

import numpy as np
from scipy.special import polygamma

from solver.arrays import Array

DIGAMMA_SERIES = np.array([float(polygamma(n, 1.5)) / math.factorial(n) for n in range(1, 49)])


def digamma_difference(delta: Array) -> Array:
    """``(digamma(3/2 + delta) - digamma(3/2)) / delta`` for ``|delta| <= 1/2``; trigamma(3/2) at 0.

    The Taylor series about 3/2 has radius 3/2, so 48 terms reach rounding at ``|delta| = 1/2``.
    """
    return np.asarray(np.polynomial.polynomial.polyval(delta, DIGAMMA_SERIES, tensor=False))
