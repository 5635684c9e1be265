"""Degrees of the polynomials of the scaled inputs that a local scale is the exponential of."""

from collections.abc import Sequence

import numpy as np

from approximation.arrays import Indices


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
