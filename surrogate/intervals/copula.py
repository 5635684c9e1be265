"""Joint distribution of errors: an empirical copula over outputs, a Gaussian kernel over points.

The ranks of the held-out scores among those of their output form an empirical copula, whose rows are joint draws at one
point (L. Ruschendorf, J. Stat. Plan. Inference 139 (2009) 3921). The error of interpolation on Chebyshev-Gauss levels
is waves of equal width in the angle arccos(t), so that the correlation between points
exp(-sum_k (angle_k - angle'_k)^2 / (2 length_k^2)) has one length everywhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import scipy  # scipy.optimize, slow to import, when errors are learned
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Array, Indices, blocks
from surrogate.intervals.distribution import Distribution, central

MOST_ROWS = 1000  # of the copula
# The lengths are fitted to at most so many pairs of cases, at most this far apart [rad] along every input.
_CASES, _PAIRS, _APART = 10_000, 50_000, 1.0
_ROUNDS, _NEAR, _FEWEST = 4, 1.2, 500  # choices of pairs, within so many lengths, and least number of pairs
_LIKELY, _SPREAD, _BOUNDS = 0.3, 1.5, (1e-3, 1e2)  # log-normal prior of the lengths [rad], and their bounds
_NEIGHBOURS_AT_ONCE = 512  # points whose correlations with all others are stored at a time


@dataclass(frozen=True)
class Copula:
    """Joint ranks of held-out errors, and correlation lengths of errors between points."""

    ranks: Indices  # shape (m, p); ranks of the scores of every output from 0, a permutation in each column
    lengths: Array  # shape (d,); correlation lengths in the angle arccos(t) of every scaled input [rad]

    @classmethod
    def of(cls, scores: Array, t: Array) -> Self:
        """Return the copula of held-out scores, (p, n), NaN without any error, at scaled coordinates t, (d, n)."""
        rows = _evenly(scores.shape[1], MOST_ROWS)
        ranks = _ranks(scores[:, rows])
        sample = _evenly(scores.shape[1], _CASES)
        finite = np.isfinite(scores).all(axis=1)
        shares = (_ranks(scores[finite][:, sample]) + 0.5) / len(sample)
        return cls(ranks, _lengths(np.asarray(scipy.special.ndtri(shares)), _angles(t[:, sample])))

    def near(self, t: Array, other: Array) -> Array:
        """Return the correlation of an output's errors, (n, k), between scaled coordinates (d, n) and (d, k)."""
        return np.asarray(np.exp(-0.5 * _squares(_angles(t), _angles(other), self.lengths)))

    def only(self, columns: Sequence[int]) -> Self:
        """Return the copula of the outputs `columns`."""
        return replace(self, ranks=self.ranks[:, list(columns)])

    def state(self) -> dict[str, tuple[tuple[str, ...], NDArray[np.generic]]]:
        """Return the arrays with their dimensions, for a file."""
        return {
            "calibration_rank": (("held_row", "output"), self.ranks.astype(np.uint16)),
            "calibration_length": (("input",), self.lengths),
        }

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: int, outputs: int) -> Self | None:
        """Return the copula in a file, None where it has none."""
        if "calibration_rank" not in stored:
            return None
        ranks, lengths = stored["calibration_rank"].values, stored["calibration_length"].values
        fits = ranks.dtype.kind in "iu" and ranks.ndim == 2 and ranks.shape[1] == outputs and lengths.shape == (inputs,)
        if not fits or not 0 < len(ranks) <= MOST_ROWS or not (lengths > 0).all():
            raise ValueError("the rows of the calibration do not fit the model")
        if (np.sort(ranks, axis=0) != np.arange(len(ranks))[:, None]).any():
            raise ValueError("the ranks of the calibration's rows are not each there once")
        return cls(ranks.astype(np.intp), lengths)


def _evenly(cases: int, most: int) -> Indices:
    return np.unique(np.linspace(0, cases - 1, min(cases, most)).astype(np.intp))


def _ranks(scores: Array) -> Indices:
    """Return the ranks, (n, p), of scores (p, n) among those of their output."""
    return np.argsort(np.argsort(scores, axis=1, kind="stable"), axis=1, kind="stable").T


def _angles(t: Array) -> Array:
    return np.arccos(np.clip(t, -1, 1))


def _squares(angles: Array, other: Array, lengths: Array) -> Array:
    """Return squared distances over the lengths, (n, k), between angles (d, n) and (d, k)."""
    square = np.zeros((angles.shape[1], other.shape[1]))
    for a, b, length in zip(angles, other, lengths, strict=True):
        square += (np.subtract.outer(a, b) / length) ** 2
    return square


def _lengths(normal: Array, angles: Array) -> Array:
    """Return lengths fitted to products of normal scores, (p, n), of near pairs of cases at angles (d, n)."""
    lengths = np.full(len(angles), _LIKELY)
    if not normal.shape[1]:
        return lengths
    d, n = angles.shape
    distance = np.full(d, min(_APART, np.pi / 2 * (2 * _PAIRS / max(n * n, 1)) ** (1 / d)))
    for _ in range(_ROUNDS):  # near pairs show how the correlation falls from one; the lengths tell which are near
        pairs = _pairs(angles / distance[:, None])
        if len(pairs) < _FEWEST:
            break
        first, second = pairs.T
        products = np.einsum("np,np->n", normal[first], normal[second]) / normal.shape[1]
        lengths = _fitted((angles[:, first] - angles[:, second]) ** 2, products)
        distance = np.minimum(_NEAR * lengths, _APART)
    return lengths


def _fitted(squares: Array, products: Array) -> Array:
    """Return the lengths whose correlation is nearest to products (pairs,) at squared distances (d, pairs)."""
    noise = max(float(np.mean(products**2)), 1e-12)

    def cost(logarithms: Array) -> tuple[float, Array]:
        over = squares * np.exp(-2 * logarithms)[:, None]
        model = np.exp(-0.5 * over.sum(axis=0))
        left, prior = products - model, (logarithms - np.log(_LIKELY)) / _SPREAD
        slopes = -(over @ (left * model)) / noise + prior / _SPREAD
        return 0.5 * float(left @ left / noise + prior @ prior), slopes

    starts = [np.full(len(squares), np.log(length)) for length in (1.0, _LIKELY, 0.1)]
    bounds = [(float(np.log(_BOUNDS[0])), float(np.log(_BOUNDS[1])))] * len(squares)
    fits = [scipy.optimize.minimize(cost, start, jac=True, method="L-BFGS-B", bounds=bounds) for start in starts]
    return np.asarray(np.exp(min(fits, key=lambda fit: float(fit.fun)).x))


def _pairs(scaled: Array) -> Indices:
    """Return at most `_PAIRS` pairs of cases whose scaled angles (d, n) differ by at most one: (k, 2)."""
    from scipy.spatial import cKDTree  # slow to import

    pairs = cKDTree(scaled.T).query_pairs(1.0, p=np.inf, output_type="ndarray")
    return pairs if len(pairs) <= _PAIRS else np.random.default_rng(0).choice(pairs, _PAIRS, replace=False)


def ends(distribution: Distribution, copula: Copula | None, level: float, sizes: Array, t: Array) -> Array:
    """Return the ends, (2,), of the central interval of the sum of errors with sizes (p, n) at points t, (e, n).

    At one point the held-out rows give joint draws of the sum. The ends at several points add like standard deviations,
    with the correlation of the points' sums.
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
    for block in blocks(len(scale), _NEIGHBOURS_AT_ONCE):
        correlation = copula.near(t[:, block], t) * (sizes[:, block].T @ spread)
        correlation /= np.multiply.outer(scale[block], scale)
        squares += [float(end[block] @ correlation @ end) for end in quantiles]
    return np.sqrt(np.maximum(squares, 0)) * [-1, 1]
