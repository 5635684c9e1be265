"""What the layers of a stack add along the surface under points, over a distance (points, 6).

    Lambda(x) = int_0^inf Delta(k) cos(kx) dk,
    chi(s) = N S(s) + (1/pi) int_0^inf [Lambda(s - s') + Lambda(s + s')] S(s') ds',

of the six pairs of (y, phi, psi), Delta = Y_top - Y0. Far away only the beginning of Delta matters: a smooth end is
put to it, of a width that the distance does not see.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from approximation.chebyshev import coefficients, mapped_points, polynomials
from solver.arrays import Array
from solver.film.kernel import strip, tapered
from solver.film.reflection import waves
from solver.film.stack import Stack

_PAIRS = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3))
_DEGREE = 16  # of the panels in x, which grow as those of the plane's kernels
_GROWTH = 1.35
_FAR = 1e4  # strips from which what is left falls like 1/x^2


@dataclass(frozen=True, eq=False)
class Spread:
    """Lambda by Chebyshev panels in the distance.

    Attributes
    ----------
    edges
        Ends of the panels, from 0; (panel + 1,).
    series
        Chebyshev coefficients; (panel, degree + 1, 6).
    """

    edges: Array
    series: Array

    def at(self, x: Array) -> Array:
        """Lambda at distances x >= 0; (..., 6), or of as many pairs as there are series of."""
        distance = x.ravel()
        reach = self.edges[-1]
        near = np.minimum(distance, reach)
        panel = np.minimum(np.searchsorted(self.edges[1:-1], near, side="right"), len(self.series) - 1)
        order = np.argsort(panel.astype(np.uint16), kind="stable")
        own = panel[order]
        bounds = np.searchsorted(own, np.arange(len(self.series) + 1)).tolist()
        low, high = self.edges[:-1][own], self.edges[1:][own]
        T = polynomials((2 * near[order] - low - high) / (high - low), _DEGREE + 1).T
        sorted_, found = (np.empty((distance.size, self.series.shape[-1])) for _ in range(2))
        for p, (start, stop) in enumerate(pairwise(bounds)):
            sorted_[start:stop] = T[start:stop] @ self.series[p]
        found[order] = sorted_
        beyond = distance > reach
        found[beyond] *= (reach / distance[beyond, None]) ** 2
        return found.reshape(*x.shape, -1)


@lru_cache(32)
def spread(stack: Stack) -> Spread:
    """Lambda of a stack of homogeneous layers.

    Raises
    ------
    StackError
        A graded layer.
    """
    width = strip(stack)
    edges = [0.0, width / 2]
    while edges[-1] < _FAR * width:
        edges.append(_GROWTH * edges[-1] + width / 2)
    ends = np.array(edges)
    series = np.empty((ends.size - 1, _DEGREE + 1, 6))
    octave = np.floor(np.log2(ends[1:] / width))
    for height in np.unique(octave):
        some = np.flatnonzero(octave == height)
        x = np.concatenate([mapped_points(_DEGREE + 1, ends[p], ends[p + 1]) for p in some])
        series[some] = coefficients(_values(stack, width, x).reshape(some.size, _DEGREE + 1, 6), axis=1)
    return Spread(ends, series)


def _values(stack: Stack, width: float, x: Array) -> Array:
    """Lambda at distances that are not far apart; (x, 6)."""
    k, weights, taper = tapered(stack, width, x)
    difference = waves(stack, k)[0].difference
    rows = np.stack([weights * taper * difference[:, i, j] for i, j in _PAIRS], -1)
    return np.asarray(np.cos(x[:, None] * k) @ rows)
