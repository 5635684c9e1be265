"""Interval of a weighted sum of errors over several outputs and points, from their joint distribution.

At one point the held-out rows say it: the sum of each row is one that was seen. Over points the ends of their own sums
add as deviations do, by the correlation of the points' sums.
"""

import numpy as np

from approximation.arrays import Array, blocks
from surrogate.intervals.copula import Copula
from surrogate.intervals.distribution import Distribution, central

_BLOCK = 512  # points whose correlations with all others are held at a time


def ends(distribution: Distribution, copula: Copula | None, level: float, sizes: Array, t: Array) -> Array:
    """Return the ends of the central interval of a sum of errors.

    sizes: (p, n); t: (e, n); result: (2,).
    """
    known = sizes.any(axis=0)
    sizes, t = sizes[:, known], t[:, known]
    limits = np.broadcast_to(distribution.ends(level), (2, len(sizes)))[..., None] * sizes
    if copula is None or not sizes.size:
        return np.array([limits.min(axis=0).sum(), limits.max(axis=0).sum()])
    scores = distribution.inverse(((copula.ranks + 0.5) / len(copula.ranks)).T)
    quantiles = np.quantile(sizes.T @ scores, central(level), axis=1, method="weibull")
    lone = np.count_nonzero(sizes, axis=0) == 1
    quantiles[:, lone] = np.sort(limits[..., lone].sum(axis=1), axis=0)
    if sizes.shape[1] == 1:
        return np.asarray(quantiles[:, 0])
    spread = np.cov(scores).reshape(len(scores), -1) @ sizes
    scale = np.sqrt(np.maximum((sizes * spread).sum(axis=0), np.finfo(np.float64).tiny))
    squares = np.zeros(2)
    for block in blocks(len(scale), _BLOCK):
        alike = copula.near(t[:, block], t) * (sizes[:, block].T @ spread) / np.multiply.outer(scale[block], scale)
        squares += [float(end[block] @ alike @ end) for end in quantiles]
    return np.sqrt(np.maximum(squares, 0)) * [-1, 1]
