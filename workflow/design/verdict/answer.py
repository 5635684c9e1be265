"""The answer to a design question as values: its terms, its variables, and the case that decides."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Annotated

import numpy as np
import xarray as xr

from workflow.design.question.risk import BINDS
from workflow.design.verdict.leftout import LeftOut
from workflow.language import titles
from workflow.language.numbers import number, shown
from workflow.language.statements import Limit, Objective

#: Margin that a variable without effect on the goal leaves to every limit.
ROOM = 0.01
_PLAIN = 10.0  # excess over a limit from which it is written without decimals
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
        """Return whether the term is a violated limit."""
        return self.margin < -ROUNDING

    @property
    def binds(self) -> bool:
        """Return whether the term is a limit with next to no margin."""
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
        """Unit in which the term's values are shown: % for deviations."""
        return titles.units(self.statement, self.units)

    def shown(self, value: float, digits: int = 3) -> str:
        """Return one of the term's values with the unit."""
        return shown(value, self.shown_units, digits)

    @property
    def at(self) -> str:
        """Bound in words, with its material."""
        assert isinstance(self.statement, Limit)
        share = f"{number(100 * self.statement.value, 3)} % of " if self.statement.value != 1 else ""
        bound = self.bound.replace(" (", "; ").removesuffix(")")  # no brackets within brackets
        return f"{self.shown(self.limit)}{f' ({share}the {bound})' if bound else ''}"

    @property
    def words(self) -> str:
        """Limit in words, with its bound."""
        assert isinstance(self.statement, Limit)
        chance = self.statement.probability
        promised = f" with probability {chance:g}" if chance is not None else ""
        return f"{self.title} of {self.at}{promised}"


class Role(StrEnum):
    """Role of a factor or a category in a design."""

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
        """Return the end of a side and a range."""
        return cls(f"{'upper' if upper else 'lower'} end of the {'studied range' if studied else 'range asked for'}")

    @property
    def outward(self) -> float:
        """1 at an upper end, -1 at a lower one."""
        return 1.0 if self.startswith("upper") else -1.0

    @property
    def words(self) -> str:
        """End in a sentence about its variable."""
        return f"the {self.replace('the studied range', 'its range')}"


@dataclass(frozen=True)
class Sensitivity:
    """Effects of small errors in building one variable."""

    elasticity: Annotated[tuple[float, ...], "relative change of the term for a relative change of the factor"]
    cost: Annotated[float, "share of the objective lost by an error of 1 % in the factor"] = np.nan
    loss: Annotated[float, "what an error of 1 % in the factor takes from the objective, over its unit in units"] = (
        np.nan
    )
    matters: Annotated[bool, "whether an error of 1 % in the factor changes any objective"] = True
    margin_left: Annotated[float, "least margin of all limits after an error of 1 % in the factor"] = np.nan


@dataclass(frozen=True)
class Variable:
    """A factor of the design, chosen or given."""

    name: str
    value: Annotated[float, "factor of the design, over its SI unit"]
    role: Annotated[Role, "what the factor is in the design"]
    sensitivity: Sensitivity
    tolerance: Annotated[str, "how far the factor may be off as built"] = ""
    edge: Annotated[End | None, "which end of its range the factor stands at, if any"] = None

    @property
    def chosen(self) -> bool:
        """Return whether the design chooses the factor."""
        return self.role == Role.VARIABLE

    @property
    def title(self) -> str:
        """The factor in words."""
        return titles.title(self.name)

    @property
    def words(self) -> str:
        """Value with its unit."""
        return titles.value(self.name, self.value)


@dataclass(frozen=True)
class Category:
    """Chosen or given name of a category."""

    category: Annotated[str, "name of a category"]
    kind: Annotated[str, "what was chosen of the category"]
    kind_role: Annotated[Role, "whether the category was chosen or given"]


@dataclass(frozen=True)
class Choice:
    """A choice of categories and listed values in words, with its best objective on the surrogate."""

    choice: Annotated[str, "a choice of categories, in words"]
    choice_objective: Annotated[float, "best objective of a choice, over its unit in units"]
    choice_feasible: Annotated[bool, "whether a choice keeps every limit"]


@dataclass(frozen=True)
class Range:
    """Least and largest exact value of a quantity over the scenarios, over its SI unit."""

    quantity: Annotated[str, "name of a quantity"]
    exact_low: Annotated[float, "least exact quantity over the scenarios, over its SI unit"]
    exact_high: Annotated[float, "largest exact quantity over the scenarios, over its SI unit"]


@dataclass(frozen=True)
class Figure:
    """Least and largest exact value of a device's figure over the scenarios, over its SI unit."""

    figure: Annotated[str, "name of a figure of a device"]
    figure_low: Annotated[float, "least exact value of the figure over the scenarios, over its SI unit"]
    figure_high: Annotated[float, "largest exact value of the figure over the scenarios, over its SI unit"]


@dataclass(frozen=True)
class Constant:
    """An uncertain constant of a material, or a family of them, with its prior standard deviation in words."""

    constant: Annotated[str, "an uncertain constant of a material, or a family of them"]
    prior: Annotated[str, "standard deviation of the constant"]


@dataclass(frozen=True)
class Overload:
    """The load at the first limit over the design's own, and the name of that limit; empty where none stops it."""

    overload: Annotated[float, "load at the first limit over the design's own"]
    overload_term: Annotated[str, "the limit that stops the load; empty where none does up to ten times the load"]


@dataclass(frozen=True)
class Tolerated:
    """Cost of the tolerances."""

    cost: Mapping[str, float]  # by variable: share of the goal that is gained without this tolerance
    gain: Mapping[str, float]  # by variable: share of the goal that is gained by half of this tolerance
    values: Scenario  # factors of the optimum without tolerances
    exact: float  # its exact goal
    choice: str  # its categories


@dataclass(frozen=True)
class Answer:
    """Design that answers one target, with its terms, factors and figures."""

    terms: tuple[Term, ...]  # the objectives first, then the limits in the study's order
    variables: tuple[Variable, ...]  # every factor of the factorial
    ranges: tuple[Range, ...] = ()  # of every quantity
    beyond: str = ""  # exceeded limits of materials and theory, in words with sources
    exceeded: tuple[str, ...] = ()  # the same without sources, each
    flags: str = ""  # the same without sources, and other remarks
    target: str = ""  # name
    statistic: str = ""  # of uncertain cases in the objective, in words
    polish: str = ""  # description of the polish
    source: str = ""  # description of the computation
    figures: tuple[Figure, ...] = ()  # of the study's device
    overload: Overload | None = None
    constants: tuple[Constant, ...] = ()  # whose effects the terms have
    left_out: tuple[LeftOut, ...] = ()  # effects that the model leaves out, the largest first
    tolerated: Tolerated | None = None  # cost of the tolerances; None without any, or if the design is not feasible
    categories: tuple[Category, ...] = ()
    choices: tuple[Choice, ...] = ()  # best design of every choice
    pictures: xr.Dataset = field(default_factory=xr.Dataset, compare=False)  # map, slices, fields, Pareto front

    @cached_property
    def objectives(self) -> tuple[Term, ...]:
        """Objectives of the target."""
        return tuple(term for term in self.terms if isinstance(term.statement, Objective))

    @cached_property
    def limits(self) -> tuple[Term, ...]:
        """Limits of the target."""
        return tuple(term for term in self.terms if isinstance(term.statement, Limit))

    def term(self, name: str) -> Term:
        """Return the term with a text of the study."""
        return next(term for term in self.terms if term.name == name)

    def variable(self, name: str) -> Variable:
        """Return the factor of a name."""
        return next(variable for variable in self.variables if variable.name == name)

    @property
    def goal(self) -> str:
        """Goals as the study writes them."""
        return " and ".join(f"{goal.statement.key} {goal.name}" for goal in self.objectives)

    @property
    def combination(self) -> dict[str, str]:
        """Name of every category."""
        return {category.category: category.kind for category in self.categories}

    @property
    def case(self) -> dict[str, float]:
        """Every factor in the case that decides the first objective, the variables without their tolerances."""
        worst = self.terms[0].worst
        return {
            variable.name: variable.value if variable.chosen else worst[variable.name] for variable in self.variables
        }

    @property
    def feasible(self) -> bool:
        """Return whether the design satisfies every limit."""
        return not self.broken

    @cached_property
    def broken(self) -> tuple[Term, ...]:
        """Violated limits."""
        return tuple(limit for limit in self.limits if limit.broken)

    @cached_property
    def binding(self) -> tuple[Term, ...]:
        """Limits with next to no margin."""
        return tuple(limit for limit in self.limits if limit.binds)

    @cached_property
    def without_effect(self) -> tuple[Variable, ...]:
        """Variables without effect on any objective."""
        return tuple(variable for variable in self.variables if not variable.sensitivity.matters)

    @cached_property
    def at_ends(self) -> tuple[Variable, ...]:
        """Variables at an end of their range that have an effect."""
        return tuple(variable for variable in self.variables if variable.edge and variable not in self.without_effect)

    @property
    def miss(self) -> str:
        """Sentence on the limit with the largest excess."""
        worst = min(self.limits, key=lambda limit: limit.margin)
        missed = f"{-100 * worst.margin:.3g}" if worst.margin > -_PLAIN else f"{-100 * worst.margin:.0f}"
        return f"{worst.name} binds; the least violated design misses it by {missed} %"

    @property
    def status(self) -> str:
        """Binding or violated limits and range ends, in one line."""
        if not self.feasible:
            return f"infeasible: {self.miss}"
        parts = [f"feasible; binding: {', '.join(limit.name for limit in self.binding) or 'none'}"]
        parts += [f"{variable.name} at the {variable.edge}" for variable in self.at_ends]
        names = ", ".join(variable.name for variable in self.without_effect)
        parts += [f"{names} of no effect on the goal"] if names else []
        return "; ".join(parts)

    @property
    def outside(self) -> str:
        """Exact values outside their intervals, in words; empty without any."""
        left = [term for term in self.terms if not term.inside]
        return "; ".join(
            f"{term.name}: exact {term.exact:.7g} is outside {term.predicted:.7g} +- {term.half:.2g}" for term in left
        )
