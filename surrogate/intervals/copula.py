"""Joint distribution of errors: an empirical copula over outputs, a Gaussian kernel over points.

The rows of held-out cases, every score as its rank among those of its output, are an empirical copula of the outputs
(L. Ruschendorf, J. Stat. Plan. Inference 139 (2009) 3921): the sum of a row is a joint draw at one point.

The error of interpolation on Chebyshev-Gauss levels is waves of equal width in the angle arccos(t): there the
correlation exp(-sum_k (angle_k - angle'_k)^2 / (2 length_k^2)) has one length everywhere.
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

#: Most rows that are kept.
MOST_ROWS = 1000
# Cases and pairs of them that tell the lengths, and how far apart [rad] along every input those of a pair are at most.
_CASES, _PAIRS, _APART = 10_000, 50_000, 1.0
# How often pairs are chosen again, within so many lengths, and of how few at least.
_ROUNDS, _NEAR, _FEWEST = 4, 1.2, 500
# Logarithms of lengths [rad] before any case: normal about this one, with this standard deviation; and their bounds.
_LIKELY, _SPREAD, _BOUNDS = 0.3, 1.5, (1e-3, 1e2)
_NEIGHBOURS_AT_ONCE = 512  # points whose correlations with all others are held at a time


@dataclass(frozen=True)
class Copula:
    """Joint ranks of held-out errors, and the lengths over which errors stay alike."""

    # shape (m, p); Of every row, the rank of its score among those of each output, from 0: every column is a
    # permutation
    ranks: Indices
    lengths: Array  # shape (d,); Of the correlation over points, in the angle arccos(t) of every scaled input [rad]

    @classmethod
    def of(cls, scores: Array, t: Array) -> Self:
        """Return that of held-out scores, (p, n), NaN where there is no error, at scaled coordinates t, (d, n)."""
        rows = _evenly(scores.shape[1], MOST_ROWS)
        ranks = _ranks(scores[:, rows])
        sample = _evenly(scores.shape[1], _CASES)
        finite = np.isfinite(scores).all(axis=1)
        shares = (_ranks(scores[finite][:, sample]) + 0.5) / len(sample)
        return cls(ranks, _lengths(np.asarray(scipy.special.ndtri(shares)), _angles(t[:, sample])))

    def near(self, t: Array, other: Array) -> Array:
        """Return the correlation of one error, (n, k), between scaled coordinates t, (d, n), and others, (d, k)."""
        return np.asarray(np.exp(-0.5 * _squares(_angles(t), _angles(other), self.lengths)))

    def only(self, columns: Sequence[int]) -> Self:
        """Return that of some outputs."""
        return replace(self, ranks=self.ranks[:, list(columns)])

    def state(self) -> dict[str, tuple[tuple[str, ...], NDArray[np.generic]]]:
        """Return the arrays with their dimensions, for a file."""
        return {
            "calibration_rank": (("held_row", "output"), self.ranks.astype(np.uint16)),
            "calibration_length": (("input",), self.lengths),
        }

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: int, outputs: int) -> Self | None:
        """Return what is in a file, None where it has none."""
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
    """Ranks of scores (p, n) among those of their output, (n, p)."""
    return np.argsort(np.argsort(scores, axis=1, kind="stable"), axis=1, kind="stable").T


def _angles(t: Array) -> Array:
    return np.arccos(np.clip(t, -1, 1))


def _squares(angles: Array, other: Array, lengths: Array) -> Array:
    """Squared distances over the lengths, (n, k), of angles (d, n) and (d, k)."""
    square = np.zeros((angles.shape[1], other.shape[1]))
    for a, b, length in zip(angles, other, lengths, strict=True):
        square += (np.subtract.outer(a, b) / length) ** 2
    return square


def _lengths(normal: Array, angles: Array) -> Array:
    """Lengths by which near cases have like normal scores (n, p), by least squares over pairs; angles (d, n).

    What is fitted is the fall from one that near pairs show: the pairs are chosen again by the lengths found so far.
    """
    lengths = np.full(len(angles), _LIKELY)
    if not normal.shape[1]:
        return lengths
    d, n = angles.shape
    distance = np.full(d, min(_APART, np.pi / 2 * (2 * _PAIRS / max(n * n, 1)) ** (1 / d)))
    for _ in range(_ROUNDS):
        pairs = _pairs(angles / distance[:, None])
        if len(pairs) < _FEWEST:
            break
        first, second = pairs.T
        alike = np.einsum("np,np->n", normal[first], normal[second]) / normal.shape[1]
        lengths = _fitted((angles[:, first] - angles[:, second]) ** 2, alike)
        distance = np.minimum(_NEAR * lengths, _APART)
    return lengths


def _fitted(squares: Array, alike: Array) -> Array:
    """Lengths of the correlation that is nearest to products of scores, (pairs,), at squared distances (d, pairs)."""
    noise = max(float(np.mean(alike**2)), 1e-12)

    def cost(logarithms: Array) -> tuple[float, Array]:
        over = squares * np.exp(-2 * logarithms)[:, None]
        model = np.exp(-0.5 * over.sum(axis=0))
        left, prior = alike - model, (logarithms - np.log(_LIKELY)) / _SPREAD
        slopes = -(over @ (left * model)) / noise + prior / _SPREAD
        return 0.5 * float(left @ left / noise + prior @ prior), slopes

    starts = [np.full(len(squares), np.log(length)) for length in (1.0, _LIKELY, 0.1)]
    bounds = [(float(np.log(_BOUNDS[0])), float(np.log(_BOUNDS[1])))] * len(squares)
    fits = [scipy.optimize.minimize(cost, start, jac=True, method="L-BFGS-B", bounds=bounds) for start in starts]
    return np.asarray(np.exp(min(fits, key=lambda fit: float(fit.fun)).x))


def _pairs(scaled: Array) -> Indices:
    """Pairs of cases of scaled angles (d, n) that differ by at most one along every input, `_PAIRS` at most: (k, 2)."""
    from scipy.spatial import cKDTree  # slow to import

    pairs = cKDTree(scaled.T).query_pairs(1.0, p=np.inf, output_type="ndarray")
    return pairs if len(pairs) <= _PAIRS else np.random.default_rng(0).choice(pairs, _PAIRS, replace=False)


def ends(distribution: Distribution, copula: Copula | None, level: float, sizes: Array, t: Array) -> Array:
    """Return the ends, (2,), of the central interval of a sum of errors of sizes (p, n) over outputs and points (e, n).

    At one point the held-out rows say it: the sum of each row is one that was seen. Over points the ends of their own
    sums add as deviations do, by the correlation of the points' sums.
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
        alike = copula.near(t[:, block], t) * (sizes[:, block].T @ spread) / np.multiply.outer(scale[block], scale)
        squares += [float(end[block] @ alike @ end) for end in quantiles]
    return np.sqrt(np.maximum(squares, 0)) * [-1, 1]
