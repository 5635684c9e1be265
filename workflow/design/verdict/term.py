"""A judged objective or limit of a design."""

from collections.abc import Mapping
from dataclasses import dataclass

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
    # On the surrogate: value, standard deviation, reach of the 95 % interval (tolerance of the study included)
    predicted: float
    predicted_std: float
    half: float
    exact: float  # On the exact solver
    inside: bool  # Whether the exact value lies inside the interval
    # The bound, and the share of it that is left; NaN for an objective
    limit: float
    margin: float
    units: str  # In the interface's notation where a quantity has it, in base units otherwise
    # Whose the bound is if it names what a material bears, and where that comes from
    bound: str
    source: str
    worst: Scenario  # The case that decides
    effect: tuple[float, ...] = ()  # Relative change by one standard deviation of each of the answer's constants
    spread: float = np.nan  # Root of the sum of the effects' squares; NaN where no one case tells it

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
