"""Posteriors of uncertain constants and discrepancies: even mixtures of Gaussians, one a draw of hyperparameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Array
from surrogate.transforms.measured.discrepancy import Discrepancy


@dataclass(frozen=True)
class Draw:
    """The posterior at one draw of the discrepancies' hyperparameters.

    Attributes
    ----------
    mean, covariance
        Of the scaled constants: (k,), (k, k).
    discrepancies : dict
        The process of every measured output, by its number.
    """

    mean: Array
    covariance: Array
    discrepancies: Mapping[int, Discrepancy]

    @cached_property
    def precision(self) -> tuple[Array, float]:
        """The inverse of the covariance (k, k), and the logarithm of its determinant."""
        inverse = np.asarray(np.linalg.inv(self.covariance), dtype=np.float64)
        return inverse, float(np.linalg.slogdet(inverse)[1])

    @classmethod
    def of(cls, discrepancies: Mapping[int, Discrepancy], constants: int) -> "Draw":
        """Return what the measured values say of so many constants, given the discrepancies' hyperparameters."""
        precision, weighted = np.eye(constants), np.zeros(constants)
        for one in discrepancies.values():
            own, estimate = one.information
            precision += own
            weighted += estimate
        covariance = np.linalg.inv(precision)
        return cls(covariance @ weighted, (covariance + covariance.T) / 2, discrepancies)


def moments(parts: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return mean and variance of an even mixture from the means and variances of its parts, of any shape.

    Examples
    --------
    >>> mean, variance = moments([(np.array(1.0), np.array(0.5)), (np.array(3.0), np.array(1.5))])
    >>> float(mean), float(variance)
    (2.0, 2.0)
    """
    means, variances = (np.stack(each) for each in zip(*parts, strict=True))
    return means.mean(axis=0), variances.mean(axis=0) + means.var(axis=0)


def mixture(draws: Sequence[Draw]) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) of the scaled constants over all draws."""
    means = np.stack([one.mean for one in draws])
    away = means - means.mean(axis=0)
    return means.mean(axis=0), np.mean([one.covariance for one in draws], axis=0) + away.T @ away / len(draws)
