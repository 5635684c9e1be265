"""The answer to a design question, as values: its terms, its variables, and the case that decides."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

import numpy as np
import xarray as xr

from workflow.design.asking.terms import BINDS
from workflow.language import titles
from workflow.language.numbers import number, shown
from workflow.language.statements import Limit, Objective

#: Every factor of the factorial in one case, in SI.
Scenario = Mapping[str, float]

#: Excess over a limit's scale that counts as none: rounding of the exact solver, which is good to 4e-14.
ROUNDING = 1e-12
#: Margin that a variable which does not matter leaves to every limit.
ROOM = 0.01
_PLAIN = 10.0  # times a limit, from which an excess is written without digits behind the point


class Role(StrEnum):
    """What a factor or a category is in a design."""

    VARIABLE = "variable"
    WORST_CASE = "worst case"
    UNCERTAIN = "uncertain"
    GIVEN = "given"


class End(StrEnum):
    """An end of a range: of the studied one, or of the part of it that was asked for."""

    UPPER = "upper end of the studied range"
    LOWER = "lower end of the studied range"
    UPPER_ASKED = "upper end of the range asked for"
    LOWER_ASKED = "lower end of the range asked for"

    @classmethod
    def of(cls, *, upper: bool, studied: bool) -> "End":
        """The end of that side and range."""
        if upper:
            return cls.UPPER if studied else cls.UPPER_ASKED
        return cls.LOWER if studied else cls.LOWER_ASKED

    @property
    def outward(self) -> float:
        """1 at an upper end, -1 at a lower one."""
        return 1.0 if self in (End.UPPER, End.UPPER_ASKED) else -1.0

    @property
    def words(self) -> str:
        """The end in a sentence about its variable."""
        asked = " as asked for" if self in (End.UPPER_ASKED, End.LOWER_ASKED) else ""
        return f"its {'upper' if self.outward > 0 else 'lower'} end{asked}"


@dataclass(frozen=True)
class Term:
    """What an objective or a limit comes to, all numbers over its unit.

    Attributes
    ----------
    statement
        The objective or the limit, as the study states it.
    predicted, predicted_std, half
        On the surrogate: value, standard deviation, reach of the 95 % interval (tolerance of the study included).
    exact
        On the exact solver.
    inside
        Whether the exact value lies inside the interval.
    limit, margin
        The bound, and the share of it that is left; NaN for an objective.
    units
        In the interface's notation where a quantity has it, in base units otherwise.
    bound, source
        Whose the bound is if it names what a material bears, and where that comes from.
    worst
        The case that decides.
    effect
        Relative change by one standard deviation of each of the answer's constants.
    spread
        Root of the sum of the effects' squares; NaN where no one case tells it.
    """

    statement: Objective | Limit
    predicted: float
    predicted_std: float
    half: float
    exact: float
    inside: bool
    limit: float
    margin: float
    units: str
    bound: str
    source: str
    worst: Scenario
    effect: tuple[float, ...] = ()
    spread: float = np.nan

    @property
    def name(self) -> str:
        """As the study has it."""
        return str(self.statement)

    @property
    def broken(self) -> bool:
        """Whether it is a limit that is not kept."""
        return self.margin < -ROUNDING

    @property
    def binds(self) -> bool:
        """Whether it is a limit with next to no margin."""
        return self.margin < BINDS

    @property
    def error(self) -> float:
        """Relative error of the surrogate; NaN where the exact value is zero."""
        return abs(self.predicted / self.exact - 1) if self.exact else np.nan

    @property
    def title(self) -> str:
        """What is wanted or bounded, in words."""
        return titles.stated(self.statement)

    @property
    def shown_units(self) -> str:
        """The unit in which its values are told: deviations are shares."""
        return titles.units(self.statement, self.units)

    def shown(self, value: float, digits: int = 4) -> str:
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


@dataclass(frozen=True)
class Sensitivity:
    """What small errors in building one variable make of a design.

    Attributes
    ----------
    elasticity
        Relative change of every term for a relative change of the variable; NaN where that is not known.
    cost, loss
        What an error of 1 % takes from the first objective: as a share of it (NaN where it is next to zero), and over
        its unit.
    matters
        Whether that error changes any objective.
    margin_left
        Least margin of all limits after it.
    """

    elasticity: tuple[float, ...]
    cost: float = np.nan
    loss: float = np.nan
    matters: bool = True
    margin_left: float = np.nan


@dataclass(frozen=True)
class Variable:
    """A factor of the design, chosen or given.

    Attributes
    ----------
    name
        Of the factor.
    value
        In SI; of a design variable without its tolerance, else in the case that decides the first objective.
    role
        What the factor is in the design.
    sensitivity
        What small errors in it make of the design.
    tolerance
        How far it may be off as built, as the study writes it; empty where there is no tolerance.
    edge
        The end of its range at which it stands, if any.
    """

    name: str
    value: float
    role: Role
    sensitivity: Sensitivity
    tolerance: str = ""
    edge: End | None = None

    @property
    def chosen(self) -> bool:
        """Whether the design chooses it."""
        return self.role == Role.VARIABLE

    @property
    def title(self) -> str:
        """The factor in words."""
        return titles.title(self.name)

    @property
    def words(self) -> str:
        """Its value with the unit."""
        return titles.value(self.name, self.value)


@dataclass(frozen=True)
class Category:
    """What was chosen of a category, or given."""

    category: str
    kind: str
    kind_role: Role


@dataclass(frozen=True)
class Choice:
    """A choice of categories and listed values in words, with its best objective on the surrogate."""

    choice: str
    choice_objective: float
    choice_feasible: bool


@dataclass(frozen=True)
class Range:
    """Least and largest exact value of a quantity over the scenarios, over its SI unit."""

    quantity: str
    exact_low: float
    exact_high: float


@dataclass(frozen=True)
class Figure:
    """Least and largest exact value of a device's figure over the scenarios, over its SI unit."""

    figure: str
    figure_low: float
    figure_high: float


@dataclass(frozen=True)
class Constant:
    """An uncertain constant of a material, or a family of them, with its prior standard deviation in words."""

    constant: str
    prior: str


@dataclass(frozen=True)
class Overload:
    """The load at the first limit over the design's own, and the name of that limit; empty where none stops it."""

    overload: float
    overload_term: str


@dataclass(frozen=True)
class Tolerated:
    """What the tolerances cost.

    Attributes
    ----------
    cost, gain
        By variable: the share of the goal that is gained without this one tolerance, and by half of it.
    values
        Factors of the optimum without tolerances.
    exact, choice
        Its exact goal, and its categories.
    """

    cost: Mapping[str, float]
    gain: Mapping[str, float]
    values: Scenario
    exact: float
    choice: str


@dataclass(frozen=True)
class Answer:
    """What is known of the design that answers one target.

    Attributes
    ----------
    terms
        The objectives first, then the limits in the study's order.
    variables
        Every factor of the factorial.
    ranges
        Of every quantity.
    beyond, flags
        What is beyond what the materials bear, in words with sources; that, and what else is to be known.
    target
        Name of the target.
    statistic
        How uncertain cases count in the objective, in words.
    polish, source
        How the design was polished, and how all was computed.
    figures, overload
        Of the study's device.
    constants
        Those of which the terms have effects.
    tolerated
        What the tolerances cost; None where there is none, or where the design is not feasible.
    categories, choices
        What was chosen, and the best of every choice.
    pictures
        What only pictures need: map, slices, fields of the contact, Pareto front.
    """

    terms: tuple[Term, ...]
    variables: tuple[Variable, ...]
    ranges: tuple[Range, ...] = ()
    beyond: str = ""
    flags: str = ""
    target: str = ""
    statistic: str = ""
    polish: str = ""
    source: str = ""
    figures: tuple[Figure, ...] = ()
    overload: Overload | None = None
    constants: tuple[Constant, ...] = ()
    tolerated: Tolerated | None = None
    categories: tuple[Category, ...] = ()
    choices: tuple[Choice, ...] = ()
    pictures: xr.Dataset = field(default_factory=xr.Dataset, compare=False)

    @cached_property
    def objectives(self) -> tuple[Term, ...]:
        """What is wanted."""
        return tuple(term for term in self.terms if isinstance(term.statement, Objective))

    @cached_property
    def limits(self) -> tuple[Term, ...]:
        """What is limited."""
        return tuple(term for term in self.terms if isinstance(term.statement, Limit))

    def term(self, name: str) -> Term:
        """The term that the study has under this text."""
        return next(term for term in self.terms if term.name == name)

    def variable(self, name: str) -> Variable:
        """The factor of this name."""
        return next(variable for variable in self.variables if variable.name == name)

    @property
    def goal(self) -> str:
        """What is asked for, as the study writes it."""
        stated = [term.statement for term in self.objectives]
        return " and ".join(
            f"{'maximise' if isinstance(one, Objective) and one.maximise else 'minimise'} {one}" for one in stated
        )

    @property
    def kinds(self) -> dict[str, str]:
        """What stands for every category."""
        return {category.category: category.kind for category in self.categories}

    @property
    def case(self) -> dict[str, float]:
        """Every factor in the case that decides the first objective, the variables without their tolerances."""
        worst = self.terms[0].worst
        return {one.name: one.value if one.chosen else worst[one.name] for one in self.variables}

    @property
    def feasible(self) -> bool:
        """Whether the design keeps every limit."""
        return not self.broken

    @cached_property
    def broken(self) -> tuple[Term, ...]:
        """Limits that are not kept."""
        return tuple(limit for limit in self.limits if limit.broken)

    @cached_property
    def binding(self) -> tuple[Term, ...]:
        """Limits with next to no margin."""
        return tuple(limit for limit in self.limits if limit.binds)

    @cached_property
    def idle(self) -> tuple[Variable, ...]:
        """Variables that do not matter to any objective."""
        return tuple(variable for variable in self.variables if not variable.sensitivity.matters)

    @cached_property
    def at_ends(self) -> tuple[Variable, ...]:
        """Variables that stand at an end of their range, and matter."""
        return tuple(variable for variable in self.variables if variable.edge and variable not in self.idle)

    @property
    def miss(self) -> str:
        """The limit that is missed by most, and by how much."""
        worst = min(self.limits, key=lambda limit: limit.margin)
        missed = f"{-100 * worst.margin:.3g}" if worst.margin > -_PLAIN else f"{-100 * worst.margin:.0f}"
        return f"{worst.name} binds; the least violated design misses it by {missed} %"

    @property
    def status(self) -> str:
        """What binds or is violated, in one line."""
        if not self.feasible:
            return f"infeasible: {self.miss}"
        parts = [f"feasible; binding: {', '.join(limit.name for limit in self.binding) or 'none'}"]
        parts += [f"{variable.name} at the {variable.edge}" for variable in self.at_ends]
        parts += [f"{', '.join(variable.name for variable in self.idle)} of no effect on the goal"] if self.idle else []
        return "; ".join(parts)

    @property
    def outside(self) -> str:
        """Which exact values left their intervals, in words; empty where none did."""
        left = [term for term in self.terms if not term.inside]
        return "; ".join(
            f"{one.name}: exact {one.exact:.7g} is outside {one.predicted:.7g} +- {one.half:.2g}" for one in left
        )
