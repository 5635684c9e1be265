"""A design question: a target with its choices made, its sources, and the designs under consideration."""

import copy
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from approximation.arrays import Array
from solver.names import ALL_QUANTITIES
from surrogate import Input
from surrogate.search.optimise import Problem
from workflow.dataset import factorial
from workflow.design.question import scenarios
from workflow.design.question.risk import Key, Quantile, RelativeDeviation, RiskMeasure, Term, WorstCase, measure
from workflow.design.question.scenarios import Scenarios
from workflow.design.question.sources import Exact, Factors, Predicted, Source, shape
from workflow.language.constants import CONSTANTS
from workflow.language.expressions import Expression
from workflow.language.statements import Limit, Objective
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

_SCANNED, _SCANNED_FILMS = 1 << 17, 1 << 15  # most evaluations in one scan: 4 and 40 us each


@dataclass(frozen=True)
class Question:
    """A target of a study with its choices made, its sources, and the designs under consideration."""

    study: Study
    target: Target
    predicted: Predicted  # the surrogate, for the question's categories
    exact: Exact  # the exact solver, for the same categories
    held: dict[str, float] = field(default_factory=dict)  # factors at one value: the target's and chosen ones of lists
    scales: dict[str, float] = field(default_factory=dict)  # scale of every limit whose bound is zero, by label
    pieces: dict[int, list[Expression]] = field(default_factory=dict)  # smooth pieces of terms with kinks, by place
    spread: float = 1.0  # range of the first objective over the ranges
    notes: tuple[str, ...] = ()  # remarks on how the question was read
    x: Array = field(default_factory=lambda: np.empty((0, 0)))  # scaled variables, (design, variable)
    variables: dict[str, Array] = field(default_factory=dict)  # physical variables by name, (design,) each, SI

    def at(self, x: Array) -> "Question":
        """Return the question at designs of scaled variables, (design, variable) or (variable,); terms are shared."""
        x = np.atleast_2d(x)
        values = {
            name: np.clip(axis.from_unit(x[:, column]), axis.low, axis.high)
            for column, (name, axis) in enumerate(self.inputs.items())
        }
        return self.at_variables(values, x)

    def at_variables(self, variables: dict[str, Array], x: Array | None = None) -> "Question":
        """Return the question at designs of physical variables, (design,) each, SI, inside the ranges or not."""
        other = copy.copy(self)  # with cached terms and scenarios, which do not depend on designs
        object.__setattr__(other, "x", np.empty((0, 0)) if x is None else x)
        object.__setattr__(other, "variables", variables)
        return other

    @cached_property
    def inputs(self) -> dict[str, Input]:
        """The continuous design variables with their ranges; tolerances stay within the study's ranges."""
        axes = {axis.name: axis for axis in factorial.inputs(self.study)}
        ranges = {name: self.target.range(name, *self.room(name)) for name in self.target.continuous}
        return {name: replace(axes[name], low=low, high=high) for name, (low, high) in ranges.items()}

    def room(self, name: str) -> tuple[float, float]:
        """Return the lowest and highest value of a factor whose tolerance stays within the study's range."""
        axis = self.study.factors[name]
        return self.target.room(name, axis.low, axis.high)

    @cached_property
    def terms(self) -> list[Term]:
        """Objectives first, then the limits in the study's order."""
        terms = [Term(str(goal), goal.expression, goal.sign, self._measure(goal)) for goal in self.target.objectives]
        for limit in self.target.limits:
            bound = limit.value * (self.study.constant(limit.allowable) if limit.allowable else 1.0)
            scale = abs(bound) or self.scales.get(str(limit), 1.0)
            counted = self._measure(limit)
            terms.append(Term(str(limit), limit.expression, limit.sign, counted, bound, scale, limit.unitless))
        return terms

    def _measure(self, statement: Objective | Limit) -> RiskMeasure:
        """Return the risk measure of a statement; that of a deviation has weights for each set of scenarios."""
        if statement.deviation:
            names = self.target.deviating(statement)
            sets = [scenarios.weights(self.target, names, nodes) for nodes in (scenarios.SEARCHED, self._judged_nodes)]
            return RelativeDeviation({len(weights): weights for weights in sets}, names)
        if not self.target.random:
            return WorstCase()
        if isinstance(statement, Objective):
            return measure(self.target.statistic, statement.sign)
        share = statement.probability
        return WorstCase() if share is None else Quantile(share if statement.upper else 1 - share)

    @cached_property
    def objectives(self) -> int:
        """Number of objectives, which come first among the terms."""
        return sum(not term.limited for term in self.terms)

    @cached_property
    def limits(self) -> list[Term]:
        """Terms of the limits."""
        return self.terms[self.objectives :]

    def excess(self, counts: Array) -> Array:
        """Return the relative excess of every limit from values of all terms: (..., terms) -> (..., limit)."""
        columns = [term.oriented(counts[..., self.objectives + k]) for k, term in enumerate(self.limits)]
        return np.stack(columns, -1) if columns else np.empty((*counts.shape[:-1], 0))

    @cached_property
    def searched(self) -> dict[Key, Scenarios]:
        """Scenarios of the search: corners (False), draws (True), and those of a deviation under its factors."""
        return self._scenarios(scenarios.SEARCHED, scenarios.DRAWN)

    @cached_property
    def judged(self) -> dict[Key, Scenarios]:
        """Scenarios of the verdict, many more than those of the search."""
        return self._scenarios(self._judged_nodes, scenarios.DRAWN_TO_JUDGE)

    @property
    def _judged_nodes(self) -> dict[int, int]:
        """Nodes a factor of the verdict's ranges, by the number of factors; films have tables for each."""
        return scenarios.JUDGED_FILMS if self.study.kind.tabled else scenarios.JUDGED

    def _scenarios(self, nodes: dict[int, int], drawn: int) -> dict[Key, Scenarios]:
        """Return all sets of scenarios, each with the terms that count over it."""
        sets: dict[Key, Scenarios] = {False: scenarios.corners(self.target, nodes)}
        for key in dict.fromkeys(term.measure.key for term in self.terms):
            if isinstance(key, tuple):
                sets[key] = scenarios.along(self.target, key, nodes)
            elif key:
                sets[key] = scenarios.draws(self.target, drawn)
        placed = list(enumerate(self.terms))
        return {
            key: replace(chosen, terms={place: term for place, term in placed if term.measure.key == key})
            for key, chosen in sets.items()
        }

    def smooth(self, place: int) -> list[Term]:
        """Return the smooth pieces of a term; all objectives get equally many, repeated if need be."""
        term, objectives = self.terms[place], range(self.objectives)
        pieces = [replace(term, expression=piece) for piece in self.pieces.get(place, [term.expression])]
        together = objectives if place in objectives else [place]
        count = max(len(self.pieces.get(other, [term])) for other in together)
        return [pieces[k % len(pieces)] for k in range(count)]

    @cached_property
    def inequality(self) -> Array:
        """1 for a limit that a design can keep away from, 0 for one of a pair that is an equality; (limit,)."""
        return np.array([float(not any(term.meets(other) for other in self.limits)) for term in self.limits])

    def factors(self, chosen: Scenarios) -> Factors:
        """Return every factor of the factorial, over (designs, scenarios)."""
        values = {name: np.full((1, 1), value) for name, value in self.held.items()}
        values |= {name: levels[None, :] for name, levels in chosen.values.items()}
        values |= {name: levels[:, None] for name, levels in self.variables.items()}
        for name, offsets in chosen.offsets.items():
            absolute, share = self.target.tolerances[name]
            values[name] = values[name] * (1 + share * offsets) + absolute * offsets
        return {name: values[name] for name in self.study.factors}

    def factor(self, name: str, like: Array) -> Array | None:
        """Return a factor over the corner set (verdict or search) whose size matches `like`; None for a name."""
        sets = (self.judged[False], self.searched[False])
        factors = self.factors(next((chosen for chosen in sets if chosen.count == like.shape[-1]), sets[0]))
        if name in factors:
            return factors[name]
        held = self.study.held(name)
        return np.full((1, 1), float(held)) if isinstance(held, float | int) else None

    def values(self, source: Source, chosen: Scenarios, terms: Sequence[Term]) -> list[Array]:
        """Return the expressions of some terms, (designs, groups, draws) each."""
        factors = self.factors(chosen)
        known = self.known(source, factors, [term.expression for term in terms])
        zeros = np.zeros(shape(factors))
        split = (len(zeros), chosen.groups, chosen.draws)
        return [(term.expression.evaluate(known) + zeros).reshape(split) for term in terms]

    def value(self, source: Source, chosen: Scenarios, term: Term) -> Array:
        """Return the expression of one term, (designs, groups, draws)."""
        return self.values(source, chosen, [term])[0]

    def count(self, source: Source, sets: Mapping[Key, Scenarios]) -> Array:
        """Return the value of every term by its risk measure, (designs, terms)."""
        counted: dict[int, Array] = {}
        for chosen in sets.values():
            evaluated = self.values(source, chosen, list(chosen.terms.values())) if chosen.terms else []
            for (place, term), values in zip(chosen.terms.items(), evaluated, strict=True):
                counted[place] = term.counted(values)
        return np.stack([counted[place] for place in range(len(self.terms))], -1)

    def known(self, source: Source, factors: Factors, expressions: Sequence[Expression]) -> dict[str, Array]:
        """Return the values of all names in some expressions, over (points, scenarios) or an axis of length one."""
        names = list(dict.fromkeys(name for expression in expressions for name in expression.names()))
        learned = [name for name in names if name in ALL_QUANTITIES]
        known = source.values(factors, learned) if learned else {}
        for name in (name for name in names if name not in learned):
            known[name] = factors[name] if name in factors else np.full((1, 1), self._fixed(name))
        return known

    def _fixed(self, name: str) -> float:
        if name in CONSTANTS:
            return self.study.constant(name)
        value = self.study.held(name)
        if isinstance(value, str) or value is None:
            raise InputError(f"{name!r} has no value in this study; it cannot stand in an expression")
        return float(value)

    @property
    def scan(self) -> int:
        """Points of a scan: a power of two, fewer where each has many scenarios."""
        size = sum(chosen.count for chosen in self.searched.values())
        most = _SCANNED_FILMS if self.study.kind.tabled else _SCANNED
        return 1 << int(np.clip(np.log2(most / size), 7, 12))

    def problem(self, source: Source, safety: Array | None = None) -> Problem:
        """Return the optimiser's problem: smooth pieces of terms over their scenarios; safety: margins, (limit,)."""
        margins = np.zeros(len(self.terms))
        if safety is not None:
            margins[self.objectives :] = safety
        return Problem(len(self.inputs), partial(self._rows, source, margins), partial(self._slopes, source))

    @cached_property
    def _row_groups(self) -> list[tuple[Scenarios, list[int], list[Term]]]:
        """Scenarios, and the smooth pieces of the terms that count over them after the places of their terms."""
        groups = []
        for chosen in self.searched.values():
            parts = [(place, piece) for place in chosen.terms for piece in self.smooth(place)]
            if parts:
                groups.append((chosen, [place for place, _ in parts], [piece for _, piece in parts]))
        return groups

    def _rows(self, source: Source, margins: Array, x: Array) -> tuple[Array, Array]:
        """Return rows of objectives (n, s) and of limits (n, m) at scaled points (n, d)."""
        designs = self.at(x)
        wanted_rows, limited_rows = self._split(
            (place, term.oriented(term.measure.rows(values), margins[place]))
            for chosen, places, terms in self._row_groups
            for place, term, values in zip(places, terms, designs.values(source, chosen, terms), strict=True)
        )
        return np.concatenate(wanted_rows, -1), np.concatenate([np.empty((len(x), 0)), *limited_rows], -1)

    def _slopes(self, source: Source, x: Array) -> tuple[Array, Array]:
        """Return the derivatives of the rows by the scaled variables at one point (d,): (s, d) and (m, d)."""
        derivatives = self._chain_rule if source.step is None else self._quotients
        wanted_rows, limited_rows = self._split(
            (place, term.sign / term.scale * jacobian)
            for chosen, places, terms in self._row_groups
            for place, term, jacobian in zip(places, terms, derivatives(source, x, chosen, terms), strict=True)
        )
        return np.concatenate(wanted_rows), np.concatenate([np.empty((0, len(x))), *limited_rows])

    def _split(self, rows: Iterable[tuple[int, Array]]) -> tuple[list[Array], list[Array]]:
        """Return the rows of the objectives and those of the limits, in the order of the terms."""
        ordered, count = sorted(rows, key=lambda pair: pair[0]), self.objectives
        return [row for place, row in ordered if place < count], [row for place, row in ordered if place >= count]

    def _chain_rule(self, source: Source, x: Array, chosen: Scenarios, terms: list[Term]) -> list[Array]:
        """Return the Jacobians of the rows by the chain rule: scenarios, then names, then scaled variables."""
        design = self.at(x)
        factors = design.factors(chosen)
        known = design.known(source, factors, [term.expression for term in terms])
        slopes = source.slopes(factors, [name for name in known if name in ALL_QUANTITIES], list(design.variables))
        for name in known.keys() - slopes:
            slopes[name] = np.tile([float(name == variable) for variable in design.variables], (chosen.count, 1))
        physical_per_scaled = np.array(
            [1 / axis.unit_slope(design.variables[name][0]) for name, axis in self.inputs.items()]
        )
        jacobians = []
        for term in terms:
            value, partials = term.expression.partials({name: values[0] for name, values in known.items()})
            slope = np.zeros((chosen.count, len(x)))
            for name, derivative in partials.items():
                slope += np.broadcast_to(derivative, chosen.count)[:, None] * slopes[name] * physical_per_scaled
            values = np.broadcast_to(value, chosen.count).reshape(chosen.groups, chosen.draws)
            jacobians.append(term.measure.jacobian(values) @ slope)
        return jacobians

    def _quotients(self, source: Source, x: Array, chosen: Scenarios, terms: list[Term]) -> list[Array]:
        """Return the Jacobians of the rows by difference quotients, central where the range allows."""
        d, step = len(x), source.step or 0.0
        ends = np.clip(np.concatenate([x + step * np.eye(d), x - step * np.eye(d)]), -1, 1)
        width = np.diag(ends[:d] - ends[d:])[:, None]
        values = self.at(ends).values(source, chosen, terms)
        rows = [term.measure.rows(value) for term, value in zip(terms, values, strict=True)]
        return [((row[:d] - row[d:]) / width).T for row in rows]
