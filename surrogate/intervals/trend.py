"""Polynomials of the scaled inputs that a local scale is the exponential of."""

from itertools import combinations

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from surrogate.data.arrays import Array


def additive(t: Array, degree: int) -> Array:
    """Return a constant and T_1 .. T_degree of every scaled input: (d, n) -> (n, 1 + d * degree)."""
    terms = chebvander(t, degree)[..., 1:].swapaxes(0, 1)
    return np.concatenate([np.ones((t.shape[1], 1)), terms.reshape(t.shape[1], -1)], axis=1)


def pairwise(t: Array) -> Array:
    """Return the product of every two scaled inputs, in the order of `itertools.combinations`: (n, d (d - 1) / 2)."""
    pairs = [a * b for a, b in combinations(t, 2)]
    return np.stack(pairs, axis=1) if pairs else np.empty((t.shape[1], 0))
