"""Terms of a design question: objectives and limited expressions, with what they count as over the scenarios."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from workflow.design import risk
from workflow.language.expressions import Expression
from workflow.language.statements import Limit, Objective

Array = NDArray[np.float64]

_MEET = 1e-9  # distance of two bounds, over their scale, that leaves one value


@dataclass(frozen=True)
class Term:
    """An objective or a limited expression, with what it counts as over the scenarios.

    Attributes
    ----------
    label
        As the study has it.
    expression
        What is computed.
    sign
        An objective times its sign is maximised; a limit's excess is its sign times what is beyond the bound.
    statistic
        How scenarios count.
    drawn
        Whether the scenarios are draws of the distributions rather than the corners of all ranges.
    bound
        Limit, NaN for an objective.
    scale
        Size of the bound, or of the expression where the bound is zero.
    unitless
        Whether the bound was written without the unit that the expression has.
    """

    label: str
    expression: Expression
    sign: float
    statistic: risk.Statistic
    drawn: bool
    bound: float = np.nan
    scale: float = 1.0
    unitless: bool = False

    @property
    def limited(self) -> bool:
        """Whether it is a limit."""
        return not np.isnan(self.bound)

    @property
    def units(self) -> str:
        """Unit in the interface's notation where a quantity has it, in base units otherwise."""
        if isinstance(self.statistic, risk.Deviation):
            return "1"
        return self.expression.lone() or str(self.expression.unit() or "1")

    def meets(self, other: "Term") -> bool:
        """Whether this limit and another one of the same expression leave one value only: an equality."""
        mine, others = (risk.Every, self.expression), (type(other.statistic), other.expression)
        same = mine == others and isinstance(self.statistic, risk.Every)
        return same and self.sign == -other.sign and abs(self.bound - other.bound) <= _MEET * self.scale

    def worst(self, rows: Array) -> Array:
        """The row that decides, over the last axis: the least objective, the largest use of a limit."""
        return np.asarray(rows.min(-1) if (self.sign > 0) != self.limited else rows.max(-1))

    def oriented(self, rows: Array | float, slack: float = 0.0) -> Array:
        """Rows that are maximised, or those of a limit as relative excess plus ``slack``."""
        if not self.limited:
            return np.asarray(self.sign * rows)
        return np.asarray(self.sign * (rows - self.bound) / self.scale + slack)


def wanted(one: Objective, deviations: float | None) -> Term:
    """The term of an objective; ``deviations`` None counts the worst case."""
    statistic = risk.Every() if deviations is None else risk.Moments(-one.sign * deviations)
    return Term(str(one), one.expression, one.sign, statistic, deviations is not None)


def limited(one: Limit, scale: float) -> Term:
    """The term of a limit, with a scale for a bound of zero."""
    statistic: risk.Statistic = risk.Every()
    if one.deviation:
        statistic = risk.Deviation()
    elif one.probability is not None:
        statistic = risk.Quantile(one.probability if one.upper else 1 - one.probability)
    size = abs(one.value) or scale
    drawn = one.probability is not None
    return Term(str(one), one.expression, one.sign, statistic, drawn, one.value, size, one.unitless)
