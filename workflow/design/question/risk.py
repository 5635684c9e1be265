"""Terms of a design question and their risk measures: the value of a term over its scenarios.

Each risk measure maps values of a term over scenarios, (n, groups, draws), to rows (n, r) that an optimiser bounds,
and, for one point, to the Jacobian (r, groups * draws) of the rows by the values.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import scipy  # scipy.special, slow to import, and not every job answers a question
from numpy.typing import NDArray

from approximation.arrays import Array
from workflow.language import statistics
from workflow.language.expressions import Expression

#: Key of a set of scenarios: whether they are draws, or the factors of a deviation.
Key = bool | tuple[str, ...]
#: Margin below which a limit binds.
BINDS = 1e-3
_MEET = 1e-9  # distance of two bounds, over their scale, that leaves one value
_REST = 1e-3  # share of all weight below which scenarios together do not decide


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
    """The worst scenario decides: one row a scenario."""

    key = False

    def rows(self, values: Array) -> Array:
        """Return the values, one row a scenario."""
        return values.reshape(len(values), -1)

    def jacobian(self, values: Array) -> Array:
        """Return the identity."""
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
        """Return the weights, in the order of the values."""
        ranks = values.argsort(-1).argsort(-1)
        return _by_group(_harrell_davis(values.shape[-1], self.share)[ranks])


@dataclass(frozen=True)
class RelativeDeviation(RiskMeasure):
    """Relative deviations of all draws from the mean of their group, upwards and downwards."""

    shares: Mapping[int, Array] = field(default_factory=dict)  # weights of draws, (draws,), by number; empty: equal
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
    """Return block-diagonal (groups, groups * draws) from (groups, draws)."""
    groups, draws = weights.shape
    whole = np.zeros((groups, groups, draws))
    whole[np.arange(groups), np.arange(groups)] = weights
    return whole.reshape(groups, -1)


@dataclass(frozen=True)
class Term:
    """An objective or a limited expression, with its risk measure."""

    label: str  # as the study has it
    expression: Expression
    sign: float  # an objective times its sign is maximised; a limit's excess is its sign times value less bound
    measure: RiskMeasure
    bound: float = np.nan  # limit, NaN for an objective
    scale: float = 1.0  # size of the bound, or of the expression where the bound is zero
    unitless: bool = False  # whether the bound was written without the unit that the expression has

    @property
    def limited(self) -> bool:
        """Return whether the term is a limit."""
        return not np.isnan(self.bound)

    @property
    def units(self) -> str:
        """Unit in the interface's notation where a quantity has it, in base units otherwise."""
        if isinstance(self.measure, RelativeDeviation):
            return "1"
        return self.expression.interface_unit() or str(self.expression.unit() or "1")

    def meets(self, other: "Term") -> bool:
        """Return whether this limit and another one of the same expression leave one value only: an equality."""
        same = self.expression == other.expression and all(
            isinstance(term.measure, WorstCase) for term in (self, other)
        )
        return same and self.sign == -other.sign and abs(self.bound - other.bound) <= _MEET * self.scale

    def worst(self, rows: Array) -> Array:
        """Return the row that decides, over the last axis: the least objective, the largest use of a limit."""
        return np.asarray(rows.min(-1) if (self.sign > 0) != self.limited else rows.max(-1))

    def counted(self, values: Array) -> Array:
        """Return the value of the term from values over scenarios: (n, groups, draws) -> (n,)."""
        return self.worst(self.measure.rows(values))

    def weights(self, values: Array) -> Array:
        """Return the weight of every scenario in the row that decides: (groups, draws) -> (scenarios,)."""
        return np.abs(self.slopes(values))

    def slopes(self, values: Array) -> Array:
        """Return the derivatives of the deciding row by the scenarios' values: (groups, draws) -> (scenarios,)."""
        rows = self.measure.rows(values[None])[0]
        row = int(np.flatnonzero(rows == self.worst(rows))[0])
        return np.asarray(self.measure.jacobian(values)[row])

    def deciding(self, values: Array) -> NDArray[np.bool_]:
        """Return whether each scenario is among the fewest that decide: (groups, draws) -> (scenarios,)."""
        weights = self.weights(values)
        order = np.argsort(weights)
        decides = np.ones(weights.size, dtype=bool)
        decides[order[np.cumsum(weights[order]) <= _REST * weights.sum()]] = False
        return decides

    def oriented(self, rows: Array | float, safety: float = 0.0) -> Array:
        """Return rows of an objective to maximise, or the relative excess of a limit."""
        if not self.limited:
            return np.asarray(self.sign * rows)
        return np.asarray(self.sign * (rows - self.bound) / self.scale + safety)
