"""Terms of a design question: objectives and limited expressions, with what they count as over the scenarios."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Array
from workflow.design.question import risk
from workflow.language.expressions import Expression

#: Margin below which a limit binds.
BINDS = 1e-3
_MEET = 1e-9  # distance of two bounds, over their scale, that leaves one value
_REST = 1e-3  # share of all weight that scenarios may have which are not among those that decide


@dataclass(frozen=True)
class Term:
    """An objective or a limited expression, with what it counts as over the scenarios."""

    label: str  # As the study has it
    expression: Expression  # What is computed
    sign: float  # An objective times its sign is maximised; a limit's excess is its sign times what is beyond the bound
    measure: risk.RiskMeasure  # How scenarios count: the risk measure
    bound: float = np.nan  # Limit, NaN for an objective
    scale: float = 1.0  # Size of the bound, or of the expression where the bound is zero
    unitless: bool = False  # Whether the bound was written without the unit that the expression has

    @property
    def limited(self) -> bool:
        """Return whether the term is a limit."""
        return not np.isnan(self.bound)

    @property
    def units(self) -> str:
        """Unit in the interface's notation where a quantity has it, in base units otherwise."""
        if isinstance(self.measure, risk.RelativeDeviation):
            return "1"
        return self.expression.lone() or str(self.expression.unit() or "1")

    def meets(self, other: "Term") -> bool:
        """Return whether this limit and another one of the same expression leave one value only: an equality."""
        same = self.expression == other.expression and all(
            isinstance(term.measure, risk.WorstCase) for term in (self, other)
        )
        return same and self.sign == -other.sign and abs(self.bound - other.bound) <= _MEET * self.scale

    def worst(self, rows: Array) -> Array:
        """The row that decides, over the last axis: the least objective, the largest use of a limit."""
        return np.asarray(rows.min(-1) if (self.sign > 0) != self.limited else rows.max(-1))

    def counted(self, values: Array) -> Array:
        """Value of the term from values over scenarios: (n, groups, draws) -> (n,)."""
        return self.worst(self.measure.rows(values))

    def weights(self, values: Array) -> Array:
        """Weight of every scenario in the row that decides: (groups, draws) -> (scenarios,)."""
        return np.abs(self.slopes(values))

    def slopes(self, values: Array) -> Array:
        """Derivatives of the row that decides by the scenarios' values: (groups, draws) -> (scenarios,)."""
        rows = self.measure.rows(values[None])[0]
        row = int(np.flatnonzero(rows == self.worst(rows))[0])
        return np.asarray(self.measure.jacobian(values)[row])

    def deciding(self, values: Array) -> NDArray[np.bool_]:
        """The fewest scenarios that make the row that decides: (groups, draws) -> (scenarios,)."""
        weights = self.weights(values)
        order = np.argsort(weights)
        decides = np.ones(weights.size, dtype=bool)
        decides[order[np.cumsum(weights[order]) <= _REST * weights.sum()]] = False
        return decides

    def oriented(self, rows: Array | float, safety: float = 0.0) -> Array:
        """Rows that are maximised, or those of a limit as relative excess."""
        if not self.limited:
            return np.asarray(self.sign * rows)
        return np.asarray(self.sign * (rows - self.bound) / self.scale + safety)
