"""Products of Chebyshev polynomials of several coordinates, each given by its degrees."""

from collections.abc import Sequence

import numpy as np

from approximation import chebyshev
from approximation.arrays import Array, Indices


def additive(highest: Sequence[int]) -> Indices:
    """Return the degrees of a constant and T_1 .. T_highest of every input: (1 + sum(highest), d)."""
    rows = [np.zeros((1, len(highest)), dtype=np.intp)]
    for k, most in enumerate(highest):
        rows.append(np.zeros((most, len(highest)), dtype=np.intp))
        rows[-1][:, k] = np.arange(1, most + 1)
    return np.concatenate(rows)


def pairwise(inputs: int, pair: tuple[int, int], total: int, least: int = 2) -> Indices:
    """Return the degrees of T_a T_b of two inputs, a, b >= 1, least <= a + b <= total: (m, inputs)."""
    degree_pairs = [(a, b) for a in range(1, total) for b in range(1, total) if least <= a + b <= total]
    degrees = np.zeros((len(degree_pairs), inputs), dtype=np.intp)
    degrees[:, pair] = np.reshape(degree_pairs, (-1, 2))
    return degrees


def values(degrees: Indices, t: Array) -> Array:
    """Return prod_k T_{degrees[m, k]}(t_k) of degrees (m, d) at places (d, B): (m, B)."""
    return product(degrees, polynomials(t, 1 + int(degrees.max())))


def polynomials(t: Array, count: int) -> Array:
    """Return T_0 .. T_{count-1} of every coordinate at places (d, B): (count, d, B)."""
    return chebyshev.polynomials(t.ravel(), count).reshape(count, *t.shape)


def derivatives(t: Array, T: Array) -> Array:
    """Return derivatives, (count, d, B), of polynomials T, (count, d, B), at places t (d, B); count > 1."""
    return chebyshev.slopes(t.ravel(), T.reshape(len(T), -1)).reshape(T.shape)


def product(degrees: Indices, T: Array, S: Array | None = None, derived: int = -1) -> Array:
    """Return products of polynomials T (count, d, B) with degrees (m, d), S replacing T for input `derived`: (m, B)."""
    whole = np.ones((len(degrees), T.shape[2]))
    for k, degree in enumerate(degrees.T):
        if S is not None and k == derived:
            whole *= S[degree, k]
        else:
            nonzero = np.flatnonzero(degree)  # T_0 is one
            whole[nonzero] *= T[degree[nonzero], k]
    return whole
