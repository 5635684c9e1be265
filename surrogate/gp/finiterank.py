"""Gaussian processes of finite rank on many scattered cases: the Chebyshev kernel's terms of largest weight.

The process is sum_a w_a prod_j T_{a_j}(t_j) with independent w_a of variance s^2 lambda_a, the kernel's coefficients;
the indices a of the largest lambda_a are a weighted hyperbolic cross of the grid's basis. Every case has a noise of
variance sigma^2 besides. Conditioning is then exact Bayesian linear regression (C. E. Rasmussen and C. K. I. Williams,
Gaussian Processes for Machine Learning (2006), section 2.1): n cases enter by the products of r features, at a cost of
r^2 n. The eigenvectors of these products give every output its own s and sigma, by marginal likelihood, at r operations
a trial. Sigma holds what the r features leave out too.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.linalg import eigh
from scipy.linalg.blas import dsyrk
from typing_extensions import override

from approximation import products
from approximation.arrays import Array, Indices, blocks
from surrogate.face.core import Posterior
from surrogate.gp.exact import regressor
from surrogate.gp.hyperparameters import least
from surrogate.gp.kernels import Chebyshev

#: Cases from which the decay of the kernel is learnt; the cost of a step grows with their cube.
SUBSET = 400
# Features are made for so many cases at once, so that memory stays bounded, and of degrees up to this one.
BLOCK, DEGREES = 4096, 100
# Noise over signal, as variances, that is searched through, and first in so many steps.
RATIOS, STEPS = (1e-16, 1e4), 60
# Squares of features, beside the largest along any direction, that are told from zero.
ROUNDING = 1e-14


@dataclass(frozen=True)
class FiniteRank(Posterior):
    """The posterior of all outputs."""

    indices: Indices  # shape (r, d); Degrees of the features
    coefficients: Array  # shape (r, p); Posterior means of the weights of the standardised outputs
    # shape (r, r); Combinations of features, columns, whose weights are independent before and after the cases
    directions: Array
    # shape (r,); What the cases know of every direction: its variance is s^2 sigma^2 / (s^2 spectrum + sigma^2)
    spectrum: Array
    # shape (p,); Variances s^2 and sigma^2 of the standardised outputs
    signal: Array
    noise: Array
    # shape (p,); What takes standardised outputs to the outputs
    offset: Array
    scale: Array

    parts = 2

    @classmethod
    def fit(cls, t: Array, values: Array, rank: int, seed: int, weights: Array | None = None) -> "FiniteRank":
        """Condition on cases.

        t: (d, n); values: (n, p); weights: (n,), optional.
        """
        root_weight = np.ones(t.shape[1]) if weights is None else np.sqrt(weights)
        offset, scale = values.mean(axis=0), values.std(axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        y = (values - offset) / scale
        sample_index = np.random.default_rng(seed).permutation(t.shape[1])[:SUBSET]
        varies = y[sample_index].std(axis=0) > 0
        kernel = Chebyshev(*np.full((2, len(t)), 0.5))
        if varies.any():
            sample = t[:, sample_index].T, y[sample_index][:, varies]
            kernel = regressor(
                "chebyshev", *sample, None, 0.0, weights=root_weight[sample_index] ** 2, noisy=True
            ).kernel_.k1.k2
        indices, sizes = largest(kernel, rank)
        y = y * root_weight[:, None]
        gram, seen = _gathered(t, y, indices, root_weight)
        root = np.sqrt(sizes)
        spectrum, vectors = eigh(gram * root * root[:, None], overwrite_a=True, check_finite=False, driver="evd")
        # what rounding leaves of small squares says nothing: as good as not seen by any case
        spectrum[spectrum < ROUNDING * spectrum[-1]] = 0.0
        directions = root[:, None] * vectors
        known = _along(directions, spectrum, seen)
        remainder = Rest(np.zeros_like(known), known, np.einsum("np,np->p", y, y))
        variances = [remainder.variances(spectrum, p, t.shape[1]) for p in range(y.shape[1])]
        # products of features know squares of the outputs to rounding only; what is left after a first fit knows more
        first = remainder.weights(spectrum, np.array([noise / signal for signal, noise in variances]))
        seen, energy = _left(t, y, indices, directions @ first, root_weight)
        remainder = Rest(first, _along(directions, spectrum, seen), energy)
        signal, noise = np.array([remainder.variances(spectrum, p, t.shape[1]) for p in range(y.shape[1])]).T
        coefficients = directions @ remainder.weights(spectrum, noise / signal)
        return cls(indices, coefficients, directions, spectrum, signal, noise, offset, scale)

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        """Return mean and weighted variance of a new case, its noise included: (p, B) each."""
        features = products.values(self.indices, t)
        mean = self._physical(self.coefficients.T @ features) + self.offset[:, None]
        if weights is None:
            return mean, None
        return mean, self._posterior(features, weights[0]) + (weights[1] * self.noise * self.scale**2)[:, None]

    @override
    def slopes(self, t: Array) -> Array:
        return np.stack(
            [self._physical(self.coefficients.T @ features) for features in products.slopes(self.indices, t)]
        )

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of these derivatives, (d, p, B); noise has no part in them."""
        return np.stack([self._posterior(features, weights[0]) for features in products.slopes(self.indices, t)])

    def state(self) -> xr.Dataset:
        """Return what a file must hold."""
        return xr.Dataset(
            {
                "feature_degree": (("feature", "input"), self.indices),
                "feature_coefficient": (("feature", "output"), self.coefficients),
                "feature_direction": (("feature", "direction"), self.directions),
                "direction_spectrum": ("direction", self.spectrum),
                "signal_variance": ("output", self.signal),
                "noise_variance": ("output", self.noise),
                "output_offset": ("output", self.offset),
                "output_scale": ("output", self.scale),
            }
        )

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: int, outputs: int) -> "FiniteRank":
        """Return the posterior in a file."""
        indices = stored["feature_degree"].values
        arrays = [
            stored[name].values
            for name in (
                "feature_coefficient", "feature_direction", "direction_spectrum", "signal_variance", "noise_variance",
                "output_offset", "output_scale",
            )
        ]  # fmt: skip
        r = len(indices)
        shapes = [(r, outputs), (r, r), (r,), *[(outputs,)] * 4]
        if indices.dtype.kind not in "iu" or indices.shape[1:] != (inputs,) or [a.shape for a in arrays] != shapes:
            raise ValueError("the features do not fit the model")
        if not 0 <= indices.min(initial=0) <= indices.max(initial=0) <= DEGREES:
            raise ValueError("the features have degrees that none has")
        if min(array.min(initial=0) for array in arrays[2:5]) < 0:
            raise ValueError("negative variance or spectrum")
        return cls(indices.astype(np.intp), *arrays)

    def _physical(self, standardised: Array) -> Array:
        return np.asarray(standardised * self.scale[:, None])

    def _posterior(self, features: Array, weights: Array) -> Array:
        along = self.directions.T @ features
        np.square(along, out=along)
        shares = self.signal * self.noise / (self.signal * self.spectrum[:, None] + self.noise)
        return (shares * (weights * self.scale**2)).T @ along


def largest(kernel: Chebyshev, count: int) -> tuple[Indices, Array]:
    """Return the indices of the largest products of a kernel's coefficients, (count, d), and these, both descending.

    One input after the other: what is among the first of all has its first parts among the first of theirs.
    """
    indices, weights = np.zeros((1, 0), dtype=np.intp), np.ones(1)
    for first, rho in zip(np.atleast_1d(kernel.first), np.atleast_1d(kernel.rho), strict=True):
        coefficients = np.append(1.0, first * rho ** np.arange(DEGREES))
        products_ = np.multiply.outer(weights, coefficients)
        order = np.argsort(-products_, axis=None, kind="stable")[:count]
        before, degree = np.unravel_index(order, products_.shape)
        indices, weights = np.column_stack([indices[before], degree]), products_[before, degree]
    return indices, weights


def _weighted(t: Array, y: Array, indices: Indices, root_weight: Array) -> Iterator[tuple[Array, Array]]:
    """Weighted features of the cases and their outputs, (r, B) and (B, p), block by block."""
    for sample_index in blocks(t.shape[1], BLOCK):
        features = products.values(indices, t[:, sample_index])
        features *= root_weight[sample_index]
        yield features, y[sample_index]


def _gathered(t: Array, y: Array, indices: Indices, root_weight: Array) -> tuple[Array, Array]:
    """Products of the weighted features with each other, (r, r), and with the outputs, (r, p), over all cases."""
    gram, seen = np.zeros((len(indices), len(indices)), order="F"), np.zeros((len(indices), y.shape[1]))
    for features, outputs in _weighted(t, y, indices, root_weight):
        # half of the products, added in place; the block's transpose is what LAPACK's order sees
        gram = dsyrk(1.0, features.T, 1.0, gram, trans=1, lower=1, overwrite_c=1)
        seen += features @ outputs
    return gram + np.tril(gram, -1).T, seen


def _along(directions: Array, spectrum: Array, seen: Array) -> Array:
    """Products with the directions from those with the features, (r, p)."""
    return np.asarray(np.where(spectrum[:, None] > 0, directions.T @ seen, 0.0))


def _left(t: Array, y: Array, indices: Indices, coefficients: Array, root_weight: Array) -> tuple[Array, Array]:
    """Products of the weighted features with what coefficients leave of the outputs, (r, p), and its squares, (p,)."""
    seen, energy = np.zeros_like(coefficients), np.zeros(y.shape[1])
    for features, outputs in _weighted(t, y, indices, root_weight):
        left = outputs - features.T @ coefficients
        seen += features @ left
        energy += np.einsum("np,np->p", left, left)
    return seen, energy


@dataclass(frozen=True)
class Rest:
    """Residuals of the outputs at the first weights of independent directions."""

    first: Array  # shape (r, p); These weights, whose prior variance is s^2
    known: Array  # shape (r, p); Products of what is left with the directions
    energy: Array  # shape (p,); Sum of its squares

    def weights(self, spectrum: Array, ratio: Array) -> Array:
        """Return the posterior means of the weights, (r, p).

        spectrum: (r,), what the cases know of every direction; ratio: (p,), noise over signal.
        """
        return np.asarray((self.known + spectrum[:, None] * self.first) / (spectrum[:, None] + ratio))

    def variances(self, spectrum: Array, output: int, cases: int) -> tuple[float, float]:
        """Return the most likely s^2 and sigma^2 of one output: s^2 at its best for every ratio of the two.

        spectrum: (r,), what the cases know of every direction.
        """
        first, known, energy = self.first[:, output], self.known[:, output], float(self.energy[output])

        def left(ratio: float) -> float:
            """The least sum of squares with the penalty, y^T (K + ratio)^-1 y times the ratio."""
            step = (known - ratio * first) / (spectrum + ratio)
            parts = spectrum * step**2 - 2 * step * known + ratio * (first + step) ** 2
            return max(energy + float(parts.sum()), 1e-28 * cases)

        def cost(logarithm: float) -> float:
            ratio = float(np.exp(logarithm))
            determinant = float(np.log1p(spectrum / ratio).sum()) + cases * logarithm
            return cases * float(np.log(left(ratio) / ratio)) + determinant

        ratio = least(cost, RATIOS, STEPS)
        noise = left(ratio) / cases
        return noise / ratio, noise
