"""What a graded film adds along the surface under points, over a distance (points, 4).

    Lambda(x) = int_0^inf Delta(k) cos(kx) dk = sum_j Y_j rho_j(x) + T(x),    Delta = Y_top - Y0,

of the six pairs of (y, phi, psi). rho_j are closed and hold what is singular at x = 0, T stands in a table.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from scipy.special import erfc

from approximation.chebyshev import coefficients, mapped_points
from solver.arrays import Array
from solver.film.grading import GradedResponse, local_tails
from solver.film.kernel import graded_response, graded_strip, strip, wavenumbers
from solver.film.stack import Stack

#: The pairs, over (x, y, phi, psi).
PAIRS = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3))

_DEGREE = 16  # of the panels in x
_GROWTH, _FINEST = 1.35, 10  # of the panels; halvings of the first one
_END, _SLOPE = 72.0, 12.0  # k times the distance where far transforms end, and the width of that: e^-36 of it is left
_DECAYED = 34.0
_MOST = 4_000_000  # values of one block of a transform
_TAILS = 4


@dataclass(frozen=True, eq=False)
class GradedSpread:
    """Lambda at distances up to the end of its table.

    Attributes
    ----------
    tails
        Y_j of the pairs; (4, 6).
    width
        b of rho_j, see :func:`solver.film.grading.local_tails`.
    edges
        Ends of the panels of T, from 0; (panel + 1,).
    series
        Chebyshev coefficients of T; (panel, degree + 1, 6).
    """

    tails: Array
    width: float
    edges: Array
    series: Array

    def at(self, x: Array) -> Array:
        """Lambda at distances x > 0; (x, 6)."""
        found = np.asarray(local_tails(x, self.width).T @ self.tails)
        panel = np.minimum(np.searchsorted(self.edges[1:-1], x, side="right"), len(self.series) - 1)
        order = np.argsort(panel, kind="stable")
        bounds = np.searchsorted(panel[order], np.arange(len(self.series) + 1))
        for p, (start, stop) in enumerate(pairwise(bounds)):
            some, low, high = order[start:stop], self.edges[p], self.edges[p + 1]
            found[some] += chebvander((2 * x[some] - low - high) / (high - low), _DEGREE) @ self.series[p]
        return found


@lru_cache(16)
def graded_spread(stack: Stack, reach: float) -> GradedSpread:
    """Lambda of a stack whose top layer is graded, for distances up to ``reach`` [m].

    Parameters
    ----------
    stack : Stack, its top layer graded
    reach : float, the largest distance [m]

    Raises
    ------
    StackError
        A profile that is not smooth.
    """
    width, response = strip(stack), graded_response(stack)
    edges = [0.0, *(width / 2 * 0.5 ** np.arange(_FINEST, 0, -1)), width / 2]
    while edges[-1] < reach:
        edges.append(_GROWTH * edges[-1] + width / 2)
    ends = np.array(edges)
    series = np.empty((ends.size - 1, _DEGREE + 1, len(PAIRS)))
    octave = np.floor(np.log2(ends[1:] / width))
    for height in np.unique(octave):
        some = np.flatnonzero(octave == height)
        x = np.concatenate([mapped_points(_DEGREE + 1, ends[p], ends[p + 1]) for p in some])
        values = _transformed(response, width, x)
        series[some] = coefficients(values.reshape(some.size, _DEGREE + 1, len(PAIRS)), axis=1)
    tails = np.stack([response.tails[:, i, j] for i, j in PAIRS], -1)
    return GradedSpread(tails, width, ends, series)


def _transformed(response: GradedResponse, width: float, x: Array) -> Array:
    """T at distances of like size; (x, 6)."""
    stack, least = response.stack, float(np.min(x))
    whole, ended = graded_strip(stack), _DECAYED * least / (_END + 6 * _SLOPE)
    far = ended > whole and least > stack.thickness
    k, weights = wavenumbers(stack, float(np.max(x)), ended if far else whole)
    if far:
        weights = weights * erfc((k * least - _END) / _SLOPE) / 2
    difference = response.decayed(k, width, _TAILS)
    rows = np.stack([weights * difference[:, i, j] for i, j in PAIRS], -1)
    found, step = np.empty((x.size, len(PAIRS))), max(_MOST // k.size, 1)
    for start in range(0, x.size, step):
        found[start : start + step] = np.cos(x[start : start + step, None] * k) @ rows
    return found
