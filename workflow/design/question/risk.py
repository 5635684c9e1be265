"""Risk measures: what a term counts as over its scenarios, as rows that an optimiser bounds, with their derivatives.

Each maps values of a term over scenarios, (n, groups, draws), to rows (n, r), and, for one point, to the
Jacobian (r, groups * draws) of the rows by the values.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import scipy  # scipy.special, slow to import, and not every job answers a question

from approximation.arrays import Array
from workflow.language import statistics

#: What tells the sets of scenarios of a question apart: draws or not, or the factors of a deviation.
Key = bool | tuple[str, ...]


class RiskMeasure(ABC):
    """A way to count scenarios."""

    key: Key = True  # the set of scenarios that is counted

    @abstractmethod
    def rows(self, values: Array) -> Array:
        """(n, groups, draws) -> (n, r)."""

    @abstractmethod
    def jacobian(self, values: Array) -> Array:
        """(groups, draws) -> (r, groups * draws)."""


class WorstCase(RiskMeasure):
    """Every scenario a row of its own: the worst of them decides."""

    key = False

    def rows(self, values: Array) -> Array:
        """The values themselves."""
        return values.reshape(len(values), -1)

    def jacobian(self, values: Array) -> Array:
        """The identity."""
        return np.eye(values.size)


@dataclass(frozen=True)
class MeanDeviation(RiskMeasure):
    """Mean plus ``deviations`` (of either sign) standard deviations of the draws, in every group."""

    deviations: float

    def rows(self, values: Array) -> Array:
        """One row a group."""
        return np.asarray(values.mean(-1) + self.deviations * values.std(-1))

    def jacobian(self, values: Array) -> Array:
        """Jacobian of mean and standard deviation; that of the mean where values do not vary."""
        draws = values.shape[-1]
        std = values.std(-1, keepdims=True)
        deviations = np.divide(values - values.mean(-1, keepdims=True), std, out=np.zeros_like(values), where=std > 0)
        return _by_group((1 + self.deviations * deviations) / draws)


@dataclass(frozen=True)
class Quantile(RiskMeasure):
    """Smooth quantile of the draws in every group (F. E. Harrell and C. E. Davis, Biometrika 69 (1982) 635)."""

    share: float

    def rows(self, values: Array) -> Array:
        """One row a group."""
        return np.asarray(np.sort(values, -1) @ _harrell_davis(values.shape[-1], self.share))

    def jacobian(self, values: Array) -> Array:
        """The weights, in the order of the values."""
        ranks = values.argsort(-1).argsort(-1)
        return _by_group(_harrell_davis(values.shape[-1], self.share)[ranks])


@dataclass(frozen=True)
class RelativeDeviation(RiskMeasure):
    """Relative deviations of all draws from the mean of their group, upwards and downwards."""

    # What each draw of a group weighs in its mean, (draws,), by how many there are; equally much where it is empty
    shares: Mapping[int, Array] = field(default_factory=dict)
    key: Key = ()  # the factors over which the deviation is taken

    def _share(self, draws: int) -> Array:
        return self.shares.get(draws, np.full(draws, 1 / draws))

    def rows(self, values: Array) -> Array:
        """Twice as many rows as scenarios."""
        with np.errstate(divide="ignore", invalid="ignore"):  # a mean of zero deviates without bound
            relative = values / (values @ self._share(values.shape[-1]))[..., None] - 1
        return np.concatenate([relative, -relative], -1).reshape(len(values), -1)

    def jacobian(self, values: Array) -> Array:
        """Jacobian by the quotient rule."""
        (groups, draws), share = values.shape, self._share(values.shape[-1])
        mean = (values @ share)[:, None, None]
        upwards = np.eye(draws) / mean - values[:, :, None] * share / mean**2
        whole = np.zeros((groups, 2 * draws, groups, draws))
        whole[np.arange(groups), :, np.arange(groups)] = np.concatenate([upwards, -upwards], 1)
        return whole.reshape(2 * values.size, -1)


def measure(statistic: statistics.Statistic, sign: float) -> RiskMeasure:
    """Return the risk measure of an objective's statistic."""
    if isinstance(statistic, statistics.Worst):
        return WorstCase()
    return MeanDeviation(-sign * statistic.deviations)


@cache
def _harrell_davis(count: int, share: float) -> Array:
    edges = scipy.special.betainc((count + 1) * share, (count + 1) * (1 - share), np.arange(count + 1) / count)
    return np.asarray(np.diff(edges))


def _by_group(weights: Array) -> Array:
    """Block-diagonal (groups, groups * draws) from (groups, draws)."""
    groups, draws = weights.shape
    whole = np.zeros((groups, groups, draws))
    whole[np.arange(groups), np.arange(groups)] = weights
    return whole.reshape(groups, -1)
