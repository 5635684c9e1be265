"""Discrepancy of a model in one measured output: a smooth Gaussian process of the inputs, plus noise.

Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425: measured = model(input, constants) + discrepancy(input) + noise.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.spatial.distance import cdist

from approximation.arrays import Array


@dataclass(frozen=True)
class Discrepancy:
    """A process a^2 exp(-|x - x'|^2/2) in the scaled inputs over their lengths, known at measured points."""

    points: Array  # shape (n, d); Scaled inputs, -1 to 1, of the measured values
    noise: Array  # shape (n,); Variance of their errors, that of the model among them
    amplitude: float  # Standard deviation a of the process, in the output's unit
    lengths: Array  # shape (d,); Length along every scaled input
    residual: Array  # shape (n,); Measured less model with the constants at zero, as linear in them
    slopes: Array  # shape (n, k); Derivatives of the model by the constants at the points

    def covariance(self, points: Array) -> Array:
        """Return the covariance of the process at scaled points (m, d) with its values at its own: (m, n)."""
        square = cdist(points / self.lengths, self.points / self.lengths, "sqeuclidean")
        return np.asarray(self.amplitude**2 * np.exp(-0.5 * square))

    @cached_property
    def factor(self) -> Array:
        """Lower Cholesky factor of the covariance of the residuals at given constants, (n, n)."""
        covariance = self.covariance(self.points)
        covariance.flat[:: len(covariance) + 1] += self.noise + 1e-10 * self.amplitude**2
        return np.asarray(cholesky(covariance, lower=True))

    @cached_property
    def whitened(self) -> tuple[Array, Array]:
        """The inverse of the covariance applied to the residuals (n,) and to the slopes (n, k)."""
        solved = cho_solve((self.factor, True), np.column_stack([self.residual, self.slopes]))
        return solved[:, 0], solved[:, 1:]

    @property
    def information(self) -> tuple[Array, Array]:
        """Return the precision (k, k) of the constants, and its product with their estimate (k,)."""
        residual, slopes = self.whitened
        return self.slopes.T @ slopes, self.slopes.T @ residual

    def at(self, points: Array) -> tuple[Array, Array, Array]:
        """Return m0 (m,), m1 (m, k) and the variance (m,) at scaled points (m, d): the mean is m0 - m1 @ constants."""
        return self._conditioned(self.covariance(points), self.amplitude**2)

    def gradient(self, points: Array) -> tuple[Array, Array, Array]:
        """Return the same of its derivatives by the scaled inputs: (d, m), (d, m, k), (d, m)."""
        cross = self.covariance(points)
        parts = [
            self._conditioned(
                -(points[:, i, None] - self.points[:, i]) / length**2 * cross, (self.amplitude / length) ** 2
            )
            for i, length in enumerate(self.lengths)
        ]
        mean, by_constants, variance = map(np.stack, zip(*parts, strict=True))
        return mean, by_constants, variance

    def _conditioned(self, cross: Array, prior: float) -> tuple[Array, Array, Array]:
        """Return m0, m1 and the variance from a prior variance and the covariances with the values, (m, n)."""
        residual, slopes = self.whitened
        white = solve_triangular(self.factor, cross.T, lower=True)
        variance = prior - np.einsum("nm,nm->m", white, white)
        return cross @ residual, cross @ slopes, np.maximum(variance, 0)


@dataclass(frozen=True)
class Draw:
    """The posterior at one draw of all else that is unknown: discrepancies' sizes and lengths, errors, outliers."""

    # Of the scaled constants: (k,), (k, k)
    mean: Array
    covariance: Array
    discrepancies: Mapping[int, Discrepancy]  # The process of every measured output, by its number

    @classmethod
    def of(cls, discrepancies: Mapping[int, Discrepancy], prior: Array) -> "Draw":
        """Return what measured values say of the scaled constants.

        prior: (k,), prior deviations of the constants, zero where one is known.
        """
        precision, weighted = np.zeros((len(prior), len(prior))), np.zeros(len(prior))
        for discrepancy in discrepancies.values():
            information, estimate = discrepancy.information
            precision += information
            weighted += estimate
        return cls(*posterior(precision, weighted, prior), discrepancies)


def posterior(precision: Array, weighted: Array, prior: Array) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) of normal unknowns of zero prior means and these prior deviations (k,)."""
    inner = np.linalg.inv(np.eye(len(prior)) + prior[:, None] * precision * prior)
    covariance = prior[:, None] * (inner + inner.T) / 2 * prior
    return covariance @ weighted, covariance


def moments(parts: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return mean and variance of an even mixture from the means and variances of its parts, of any shape."""
    means, variances = (np.stack(part) for part in zip(*parts, strict=True))
    return means.mean(axis=0), variances.mean(axis=0) + means.var(axis=0)


def mixture(draws: Sequence[Draw]) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) of the scaled constants over all draws."""
    means = np.stack([draw.mean for draw in draws])
    deviation = means - means.mean(axis=0)
    return means.mean(axis=0), np.mean([draw.covariance for draw in draws], axis=0) + deviation.T @ deviation / len(
        draws
    )
