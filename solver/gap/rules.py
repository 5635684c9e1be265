"""Rules that integrate a kernel against charges beside a contact, and where one rule serves every target.

A rule of n nodes errs by rho^-2n for what is analytic within the ellipse with foci at the interval's ends whose
semi-axes add to rho (over half the interval; Trefethen, SIAM Review 50 (2008) 67). A stack's kernels have their nearest
singularities at the distance of the strip from a target.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray

RULE = 12  # nodes where charges and a panel of the kernel meet: exact for both
GRADED = 0.12 ** np.arange(8.0)  # of the infinite panel, towards the logarithm at its end
_SHARE, _WEIGHTS = (np.polynomial.legendre.leggauss(RULE) + np.array([[1.0], [0.0]])) / 2  # of an interval
_ELLIPSE = 4.0  # rho^-16 is left, beside densities of degree 6: 2e-10


def spans(start: Array, stop: Array) -> tuple[Array, Array]:
    """Nodes and weights on each interval; (interval, node) each.

    start, stop: (interval,), ends of the intervals.
    """
    length = (stop - start)[:, None]
    return start[:, None] + length * _SHARE, length * _WEIGHTS


def gauss(ends: Array, count: int) -> tuple[Array, Array]:
    """Gauss's rule on each interval between ends: nodes and weights.

    ends: (interval + 1,).
    """
    x, w = _legendre(count)
    half = np.diff(ends) / 2
    return (ends[:-1, None] + half[:, None] * (1 + x)).ravel(), (half[:, None] * w).ravel()


@cache
def _legendre(count: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(count)


@dataclass(frozen=True, eq=False)
class Rules:
    """Rules on intervals of u."""

    panel: NDArray[np.intp]  # Panel of the densities; (interval,)
    # Ends in u; (interval,)
    start: Array
    stop: Array
    theta: Array  # Nodes; (interval, node)
    shape: Array  # Weights times what a panel's unknowns are at the nodes; (interval, node, unknown of the panel)

    def rough(self, singular: NDArray[np.complex128]) -> BoolArray:
        """Mark intervals to which singularities at u = ``singular`` (..., interval) lie too close."""
        z = (2 * singular - self.start - self.stop) / (self.stop - self.start)
        root = np.sqrt(z - 1) * np.sqrt(z + 1)
        return np.asarray(np.abs(z + root) < _ELLIPSE)
