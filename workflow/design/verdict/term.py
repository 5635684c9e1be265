"""A judged objective or limit of a design."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from workflow.design.question.terms import BINDS
from workflow.language import titles
from workflow.language.numbers import number, shown
from workflow.language.statements import Limit, Objective

#: Every factor of the factorial in one case, in SI.
Scenario = Mapping[str, float]

#: Excess over a limit's scale that counts as none: rounding of the exact solver, which is good to 4e-14.
ROUNDING = 1e-12


@dataclass(frozen=True)
class Term:
    """A judged objective or limit; all numbers are in its unit."""

    statement: Objective | Limit  # The objective or the limit, as the study states it
    predicted: Annotated[float, "predicted term, over its unit in units"]
    predicted_std: Annotated[float, "predicted standard deviation of the term, over its unit in units"]
    half: Annotated[float, "half of the interval of the predicted term, over its unit in units"]
    exact: Annotated[float, "exact term, over its unit in units"]
    inside: Annotated[bool, "whether the exact term lies inside the predicted interval"]
    # NaN for an objective
    limit: Annotated[float, "limit of the term, over its unit in units"]
    margin: Annotated[float, "share of the limit that is left; negative beyond it"]
    units: Annotated[str, "unit of the term"]
    bound: Annotated[str, "what of a material the limit is, if it names that"]
    source: Annotated[str, "where that comes from"]
    worst: Annotated[Scenario, "factor in the scenario that decides the term, over its SI unit"]
    effect: Annotated[tuple[float, ...], "relative change of the term by one standard deviation of the constant"] = ()
    spread: Annotated[
        float, "standard deviation of the term by all uncertain constants, over the term; to first order"
    ] = np.nan

    @property
    def name(self) -> str:
        """Text of the objective or limit as the study writes it."""
        return str(self.statement)

    @property
    def broken(self) -> bool:
        """Return whether it is a violated limit."""
        return self.margin < -ROUNDING

    @property
    def binds(self) -> bool:
        """Return whether it is a limit with next to no margin."""
        return self.margin < BINDS

    @property
    def error(self) -> float:
        """Relative error of the surrogate; NaN where the exact value is zero."""
        return abs(self.predicted / self.exact - 1) if self.exact else np.nan

    @property
    def title(self) -> str:
        """Wanted or bounded expression in words."""
        return titles.stated(self.statement)

    @property
    def shown_units(self) -> str:
        """The unit in which its values are told: deviations are shares."""
        return titles.units(self.statement, self.units)

    def shown(self, value: float, digits: int = 3) -> str:
        """One of its values with the unit."""
        return shown(value, self.shown_units, digits)

    @property
    def at(self) -> str:
        """The bound, and whose it is."""
        assert isinstance(self.statement, Limit)
        share = f"{number(100 * self.statement.value, 3)} % of " if self.statement.value != 1 else ""
        bound = self.bound.replace(" (", "; ").removesuffix(")")  # what is in brackets already, within ours
        return f"{self.shown(self.limit)}{f' ({share}the {bound})' if bound else ''}"

    @property
    def words(self) -> str:
        """The limit with its bound."""
        assert isinstance(self.statement, Limit)
        chance = self.statement.probability
        promised = f" with probability {chance:g}" if chance is not None else ""
        return f"{self.title} of {self.at}{promised}"
