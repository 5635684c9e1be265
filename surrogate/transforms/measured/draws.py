"""Posteriors of uncertain constants and discrepancies: even mixtures of Gaussians, one a draw of hyperparameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array
from surrogate.transforms.measured.discrepancy import Discrepancy


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
