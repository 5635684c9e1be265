"""One design question of a study, as its model: what is wanted, over which factors, under which limits."""

import operator
from functools import lru_cache
from math import prod
from typing import Annotated, Self

import numpy as np
import scipy  # scipy.stats, slow to import, when a distribution is asked for
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, model_validator

from workflow.language import statements, statistics
from workflow.language.constants import CONSTANTS, Meeting
from workflow.language.factors import FACTORS
from workflow.language.given import size
from workflow.study.reading import located
from workflow.study.types import BY_FACTOR, Case, FactorName, Given, InputName, Interval, Number, Strict

CUT = 3.0  # a normal distribution ends this many standard deviations from its mean
MOST_CHOICES = 200
Texts = Annotated[list[str], Field(max_length=4)]

# the model keeps the texts of statements, as its file has them; each is parsed once
_objective = lru_cache(maxsize=512)(statements.objective)
_limit = lru_cache(maxsize=512)(statements.limit)


class Variable(Strict):
    """A design variable: the whole range of its factor, a part of it, or one value of a list."""

    low: Given | None = Field(None, description="lower end; default: that of the factor")
    high: Given | None = Field(None, description="upper end; default: that of the factor")
    choices: list[Number | str] = Field(
        [], description="instead of a range: the values to choose from; names of a category"
    )

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if self.choices and (self.low is not None or self.high is not None):
            raise ValueError("give either low and high, or choices")
        if self.low is not None and self.high is not None and not self.low < self.high:
            raise ValueError(f"low = {self.low:g} must be below high = {self.high:g}")
        return self


class Distribution(Strict):
    """Distribution of an uncertain factor; exactly one of the three is given."""

    uniform: Interval | None = Field(None, description="[low, high]")
    normal: Interval | None = Field(None, description="[mean, standard deviation], cut at 3 standard deviations")
    triangular: list[Given] | None = Field(None, min_length=3, max_length=3, description="[low, mode, high]")

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [name for name in ("uniform", "normal", "triangular") if getattr(self, name) is not None]
        if len(kinds) != 1:
            raise ValueError(f"give one of uniform, normal, triangular, not {' and '.join(kinds) or 'none'}")
        if self.uniform and not self.uniform[0] < self.uniform[1]:
            raise ValueError(f"uniform: {self.uniform[0]:g} must be below {self.uniform[1]:g}")
        if self.normal and not self.normal[1] > 0:
            raise ValueError(f"normal: the standard deviation {self.normal[1]:g} must be positive")
        if self.triangular:
            low, mode, high = self.triangular
            if not (low <= mode <= high and low < high):
                raise ValueError(f"triangular: {low:g}, {mode:g}, {high:g} must ascend")
        return self

    @property
    def support(self) -> tuple[float, float]:
        """Least and largest value."""
        if self.normal:
            mean, std = self.normal
            return mean - CUT * std, mean + CUT * std
        ends = self.uniform or self.triangular or [0.0, 0.0]
        return ends[0], ends[-1]

    def quantile(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the quantiles at shares from 0 to 1, of any shape."""
        low, high = self.support
        if self.normal:
            mean, std = self.normal
            return np.asarray(scipy.stats.truncnorm.ppf(share, -CUT, CUT, mean, std))
        if self.triangular:
            return np.asarray(scipy.stats.triang.ppf(share, (self.triangular[1] - low) / (high - low), low, high - low))
        return np.asarray(low + (high - low) * share)


class Target(Strict):
    """One design question: what is wanted, over which factors, under which limits and uncertainties."""

    title: str = Field(
        "", max_length=80, description="what is asked for, in words; default: from its goal", exclude_if=operator.not_
    )
    maximise: str | Texts = Field([], description="expression, or a list of them: a Pareto front")
    minimise: str | Texts = Field([], description="as maximise")
    over: Annotated[list[InputName], Field(min_length=1)] | Annotated[dict[InputName, Variable], BY_FACTOR] = Field(
        description="design variables, categories among them: names, or names with low and high, or choices"
    )
    at: Case = Field({}, description="factors held at a value")
    worst_case: Annotated[dict[FactorName, Interval], BY_FACTOR] = Field(
        {}, description="factors that may take any value of a range [low, high]"
    )
    uncertain: Annotated[dict[FactorName, Distribution], BY_FACTOR] = Field(
        {}, description="factors with a distribution: uniform, normal or triangular"
    )
    tolerance: dict[FactorName, Number | str] = Field(
        {}, description="how far a variable may be off as built: '5 %' of it, '10 um', or SI"
    )
    robust: str = Field("worst case", description="objective counts as 'worst case', 'mean' or 'mean - K std'")
    subject_to: list[str] = Field(
        [], description='limits "expression <= number [unit] [with probability p]"; deviation(...)'
    )
    allow_outside_interval: bool = Field(
        False, description="go on although an exact value left the interval that the surrogate gave"
    )

    _meeting: Meeting = PrivateAttr(default="line")

    def set_meeting(self, meeting: Meeting) -> Self:
        """Read the target's figures for a kind of contact and amplifier from now on; return the target."""
        self._meeting = meeting
        return self

    @property
    def variables(self) -> dict[str, Variable]:
        """Design variables by name."""
        return dict(self.over) if isinstance(self.over, dict) else {name: Variable() for name in self.over}

    @property
    def tolerances(self) -> dict[str, tuple[float, float]]:
        """Absolute part and share of every tolerance."""
        return {
            name: size(name, tolerance) if isinstance(tolerance, str) else (tolerance, 0.0)
            for name, tolerance in self.tolerance.items()
        }

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Ends of the factors that a design does not choose: worst cases, then supports of distributions."""
        supports = {name: distribution.support for name, distribution in self.uncertain.items()}
        return {name: (low, high) for name, (low, high) in self.worst_case.items()} | supports

    @property
    def random(self) -> list[str]:
        """Factors that are drawn for limits and statistics: the uncertain ones, and those with tolerances."""
        return [*self.uncertain, *self.tolerance]

    def room(self, name: str, low: float, high: float) -> tuple[float, float]:
        """Return the range of a factor whose tolerance stays from `low` to `high`."""
        absolute, share = self.tolerances.get(name, (0.0, 0.0))
        return low / (1 - share) + absolute, high / (1 + share) - absolute

    def range(self, name: str, low: float, high: float) -> tuple[float, float]:
        """Return the range of a design variable, cut to `low` and `high`."""
        variable = self.variables[name]
        return (
            low if variable.low is None else max(low, variable.low),
            high if variable.high is None else min(high, variable.high),
        )

    def deviating(self, statement: statements.Statement) -> tuple[str, ...]:
        """Return the factors over which a statement's deviation is taken: those that it names, or all not chosen."""
        return statement.over or (*self.worst_case, *self.random)

    @property
    def continuous(self) -> list[str]:
        """Design variables with a range."""
        return [name for name, variable in self.variables.items() if name in FACTORS and not variable.choices]

    @property
    def objectives(self) -> list[statements.Objective]:
        """Parsed objectives; two or more make a Pareto front."""
        maximise = [self.maximise] if isinstance(self.maximise, str) else self.maximise
        minimise = [self.minimise] if isinstance(self.minimise, str) else self.minimise
        texts = [*((text, True) for text in maximise), *((text, False) for text in minimise)]
        return [_objective(text, maximise=largest, meeting=self._meeting) for text, largest in texts]

    @property
    def limits(self) -> list[statements.Limit]:
        """Parsed limits in the study's order."""
        return [_limit(text, self._meeting) for text in self.subject_to]

    @property
    def statistic(self) -> statistics.Statistic:
        """Statistic of uncertain cases in the objective."""
        return statistics.statistic(self.robust)

    @model_validator(mode="after")
    def _readable(self) -> Self:
        if not self.objectives:
            raise ValueError("maximise or minimise: missing; one must be given")
        if not self.variables:
            raise ValueError("over: needs at least one factor")
        texts = [str(limit) for limit in self.limits]
        for text in texts:
            if texts.count(text) > 1:
                raise ValueError(f"subject_to: {text!r} is given twice")
        for name, (low, high) in self.worst_case.items():
            if not low <= high:
                raise ValueError(f"worst_case: {name}: {low:g} must not be above {high:g}")
        self._check_tolerance()
        if self.statistic.drawn and not self.random:
            raise ValueError(f"robust: {self.robust!r} needs uncertain factors")
        for limit in self.limits:
            if limit.probability is not None and not self.random:
                raise ValueError(f"subject_to: {limit}: a probability needs uncertain factors, or a tolerance")
        stated: list[statements.Objective | statements.Limit] = [*self.objectives, *self.limits]
        for statement in stated:
            if statement.deviation and not self.deviating(statement):
                raise ValueError(f"{statement.key}: {statement}: a deviation needs worst_case or uncertain factors")
            for name in statement.over:
                if name not in (*self.worst_case, *self.random):
                    raise ValueError(
                        f"{statement.key}: {statement}: {name!r} is none of worst_case, uncertain or tolerance"
                    )
        if self.statistic.drawn and any(objective.deviation for objective in self.objectives):
            raise ValueError(f"robust: {self.robust!r}: a deviation is an objective as it is; must be 'worst case'")
        combinations = prod(len(variable.choices) or 1 for variable in self.variables.values())
        if combinations > MOST_CHOICES:
            raise ValueError(f"over: {combinations} combinations of choices are more than {MOST_CHOICES}")
        return self

    def _check_tolerance(self) -> None:
        for name, tolerance in self.tolerance.items():
            if name not in self.variables:
                raise ValueError(
                    f"tolerance: {name}: is not one of the design variables: {', '.join(self.variables)}; "
                    "what is given and yet uncertain stands in worst_case, as low and high"
                )
            with located(f"tolerance: {name}"):
                _, share = self.tolerances[name]
            if not isinstance(tolerance, str) and not tolerance > 0:
                raise ValueError(f"tolerance: {name}: {tolerance:g} is not a positive number")
            if share >= 1:
                raise ValueError(f"tolerance: {name}: {tolerance}: must be below 100 %")

    def values(self, name: str) -> list[float | str]:
        """Return every value that the question gives to a factor: its ends, choices or fixed value."""
        if name in self.at:
            return [self.at[name]]
        if name in self.worst_case:
            return list(self.worst_case[name])
        if name in self.uncertain:
            return list(self.uncertain[name].support)
        variable = self.variables.get(name, Variable())
        return [*variable.choices, *(end for end in (variable.low, variable.high) if end is not None)]

    def constants(self) -> list[str]:
        """Return the names of constants in objectives and limits, and of allowables that bound limits."""
        bounds = [limit.allowable for limit in self.limits if limit.allowable]
        return list(dict.fromkeys([*(name for name in self.names() if name in CONSTANTS), *bounds]))

    def names(self) -> list[str]:
        """Return the names in objectives and limits."""
        goals, limits = [goal.expression for goal in self.objectives], [limit.expression for limit in self.limits]
        return list(dict.fromkeys(name for expression in goals + limits for name in expression.names()))
