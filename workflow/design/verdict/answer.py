"""The answer to a design question, as values: its terms, its variables, and the case that decides."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated

import xarray as xr

from workflow.design.verdict.leftout import LeftOut
from workflow.design.verdict.term import Scenario, Term
from workflow.design.verdict.variable import Role, Variable
from workflow.language.statements import Limit, Objective

#: Margin that a variable which does not matter leaves to every limit.
ROOM = 0.01
_PLAIN = 10.0  # times a limit, from which an excess is written without digits behind the point


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

    # By variable: the share of the goal that is gained without this one tolerance, and by half of it
    cost: Mapping[str, float]
    gain: Mapping[str, float]
    values: Scenario  # Factors of the optimum without tolerances
    # Its exact goal, and its categories
    exact: float
    choice: str


@dataclass(frozen=True)
class Answer:
    """Design that answers one target, with its terms, factors and figures."""

    terms: tuple[Term, ...]  # The objectives first, then the limits in the study's order
    variables: tuple[Variable, ...]  # Every factor of the factorial
    ranges: tuple[Range, ...] = ()  # Of every quantity
    # What is beyond what the materials bear, in words with sources, and without, each; that, and what else is to be
    # known
    beyond: str = ""
    exceeded: tuple[str, ...] = ()
    flags: str = ""
    target: str = ""  # Name of the target
    statistic: str = ""  # How uncertain cases count in the objective, in words
    # How the design was polished, and how all was computed
    polish: str = ""
    source: str = ""
    # Of the study's device
    figures: tuple[Figure, ...] = ()
    overload: Overload | None = None
    constants: tuple[Constant, ...] = ()  # Those of which the terms have effects
    left_out: tuple[LeftOut, ...] = ()  # Effects that the model leaves out, the largest first
    # What the tolerances cost; None where there is none, or where the design is not feasible
    tolerated: Tolerated | None = None
    # What was chosen, and the best of every choice
    categories: tuple[Category, ...] = ()
    choices: tuple[Choice, ...] = ()
    # What only pictures need: map, slices, fields of the contact, Pareto front
    pictures: xr.Dataset = field(default_factory=xr.Dataset, compare=False)

    @cached_property
    def objectives(self) -> tuple[Term, ...]:
        """Objectives of the target."""
        return tuple(term for term in self.terms if isinstance(term.statement, Objective))

    @cached_property
    def limits(self) -> tuple[Term, ...]:
        """Limits of the target."""
        return tuple(term for term in self.terms if isinstance(term.statement, Limit))

    def term(self, name: str) -> Term:
        """The term that the study has under this text."""
        return next(term for term in self.terms if term.name == name)

    def variable(self, name: str) -> Variable:
        """The factor of this name."""
        return next(variable for variable in self.variables if variable.name == name)

    @property
    def goal(self) -> str:
        """Goal and limits as the study writes them."""
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
        """Binding or violated limits and range ends, in one line."""
        if not self.feasible:
            return f"infeasible: {self.miss}"
        parts = [f"feasible; binding: {', '.join(limit.name for limit in self.binding) or 'none'}"]
        parts += [f"{variable.name} at the {variable.edge}" for variable in self.at_ends]
        parts += [f"{', '.join(variable.name for variable in self.idle)} of no effect on the goal"] if self.idle else []
        return "; ".join(parts)

    @property
    def outside(self) -> str:
        """Exact values outside their intervals, in words; empty without any."""
        left = [term for term in self.terms if not term.inside]
        return "; ".join(
            f"{term.name}: exact {term.exact:.7g} is outside {term.predicted:.7g} +- {term.half:.2g}" for term in left
        )
