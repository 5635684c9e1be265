"""Products of Chebyshev polynomials of several coordinates, each known by its degrees."""

from collections.abc import Iterator

import numpy as np

from approximation import chebyshev
from approximation.arrays import Array, Indices


def values(degrees: Indices, t: Array) -> Array:
    """Return prod_k T_{degrees[m, k]}(t_k), (m, B).

    degrees: (m, d); t: (d, B), places.
    """
    return product(degrees, polynomials(t, 1 + int(degrees.max())))


def slopes(degrees: Indices, t: Array) -> Iterator[Array]:
    """Yield the derivatives of `values` by every coordinate, (m, B) each.

    degrees: (m, d); t: (d, B), places.
    """
    T = polynomials(t, max(2, 1 + int(degrees.max())))
    S = derivatives(t, T)
    return (product(degrees, T, S, k) for k in range(len(t)))


def polynomials(t: Array, count: int) -> Array:
    """Return T_0 .. T_{count-1} of every coordinate, (count, d, B).

    t: (d, B), places.
    """
    return chebyshev.polynomials(t.ravel(), count).reshape(count, *t.shape)


def derivatives(t: Array, T: Array) -> Array:
    """Return the derivatives of polynomials, (count, d, B).

    t: (d, B), places; T: (count, d, B), count > 1, the polynomials there.
    """
    return chebyshev.slopes(t.ravel(), T.reshape(len(T), -1)).reshape(T.shape)


def product(degrees: Indices, T: Array, S: Array | None = None, derived: int = -1) -> Array:
    """Return products of polynomials that are known, (m, B).

    degrees: (m, d); T: (count, d, B), the polynomials of every coordinate; S: (count, d, B), their derivatives; None
    where none is asked for.
    """
    whole = np.ones((len(degrees), T.shape[2]))
    for k, degree in enumerate(degrees.T):
        if S is not None and k == derived:
            whole *= S[degree, k]
        else:
            held = np.flatnonzero(degree)  # T_0 is one
            whole[held] *= T[degree[held], k]
    return whole
