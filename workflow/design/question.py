"""A design question in the terms of an optimiser: scaled variables, scenarios, terms with their statistics."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from solver.names import EVERY_QUANTITY, FACTORS
from surrogate import Input
from surrogate.search.optimise import Problem
from workflow.dataset import factorial
from workflow.design import kinks, misread, scenarios
from workflow.design.risk import Every
from workflow.design.scenarios import Scenarios
from workflow.design.sources import Factors, Source, shape
from workflow.design.terms import Term, limited, wanted
from workflow.language.expressions import Call, Expression, Operation, Power
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

Array = NDArray[np.float64]

_PILOT = 512  # points that tell a constant, unbounded or undefined term
_ENDS = 8  # variables of which every combination of ends is among them
_CONSTANT = 1e-9  # relative variation that counts as none


@dataclass(frozen=True)
class Question:
    """A target of a study with its choices made.

    Attributes
    ----------
    study, target
        What is asked.
    held
        Factors at one value: the target's own and those chosen from lists.
    scales
        Scale of every limit whose bound is zero, by label.
    pieces
        Smooth pieces of terms with kinks, by the term's place.
    spread
        Range of the first objective over the ranges.
    notes
        What a reader of the answer should know about how the question was read.
    """

    study: Study
    target: Target
    held: dict[str, float] = field(default_factory=dict)
    scales: dict[str, float] = field(default_factory=dict)
    pieces: dict[int, list[Expression]] = field(default_factory=dict)
    spread: float = 1.0
    notes: tuple[str, ...] = ()

    @cached_property
    def inputs(self) -> dict[str, Input]:
        """The continuous design variables, each with its range."""
        whole = {one.name: one for one in factorial.inputs(self.study)}
        return {
            name: replace(
                whole[name],
                low=whole[name].low if one.low is None else one.low,
                high=whole[name].high if one.high is None else one.high,
            )
            for name, one in self.target.variables.items()
            if name in self.target.continuous
        }

    @cached_property
    def terms(self) -> list[Term]:
        """Objectives first, then the limits in the study's order."""
        deviations = self.target.statistic.deviations
        return [wanted(one, deviations) for one in self.target.objectives] + [
            limited(one, self.scales.get(str(one), 1.0)) for one in self.target.limits
        ]

    @cached_property
    def searched(self) -> dict[bool, Scenarios]:
        """Scenarios of the search: corners under False, draws (where something is drawn) under True."""
        return self._scenarios(scenarios.SEARCHED, scenarios.DRAWN)

    @cached_property
    def judged(self) -> dict[bool, Scenarios]:
        """Many more of them, for the verdict."""
        return self._scenarios(scenarios.JUDGED, scenarios.DRAWN_TO_JUDGE)

    def _scenarios(self, nodes: dict[int, int], drawn: int) -> dict[bool, Scenarios]:
        sets = {False: scenarios.corners(self.target, nodes)}
        return sets | ({True: scenarios.draws(self.target, drawn)} if any(term.drawn for term in self.terms) else {})

    def physical(self, x: Array) -> dict[str, Array]:
        """Design variables at scaled points (n, d), by name."""
        return {
            name: np.clip(one.from_unit(x[:, column]), one.low, one.high)
            for column, (name, one) in enumerate(self.inputs.items())
        }

    def factors(self, x: Array, chosen: Scenarios) -> Factors:
        """Every factor of the factorial at scaled points (n, d), over (points, scenarios)."""
        return self.at(self.physical(x), chosen)

    def at(self, variables: dict[str, Array], chosen: Scenarios) -> Factors:
        """Every factor of the factorial at values of the variables, (n,) each."""
        given = {name: np.full((1, 1), value) for name, value in self.held.items()}
        given |= {name: values[None, :] for name, values in chosen.values.items()}
        given |= {name: values[:, None] for name, values in variables.items()}
        return {name: given[name] for name in self.study.factors}

    def values(self, source: Source, factors: Factors, chosen: Scenarios, terms: Sequence[Term]) -> list[Array]:
        """Expressions of some terms, (points, groups, draws) each."""
        known = self.known(source, factors, [term.expression for term in terms])
        whole = np.zeros(shape(factors))
        split = (len(whole), chosen.groups, chosen.draws)
        return [(term.expression.evaluate(known) + whole).reshape(split) for term in terms]

    def known(self, source: Source, factors: Factors, expressions: Sequence[Expression]) -> dict[str, Array]:
        """Values of all names in some expressions, over (points, scenarios) or an axis of length one."""
        names = list(dict.fromkeys(name for one in expressions for name in one.names()))
        learned = [name for name in names if name in EVERY_QUANTITY]
        known = source.values(factors, learned) if learned else {}
        for name in set(names) - set(learned):
            known[name] = factors[name] if name in factors else np.full((1, 1), self._fixed(name))
        return known

    def _fixed(self, name: str) -> float:
        value = self.study.fixed.get(name, FACTORS[name].default)
        if isinstance(value, str) or value is None:
            raise InputError(f"{name!r} has no value in this study; it cannot stand in an expression")
        return float(value)

    def problem(self, source: Source, slack: Array | None = None) -> Problem:
        """The question for the optimiser; ``slack``, one a limit, is added to the relative excess."""
        extra = np.zeros(len(self.terms)) if slack is None else np.concatenate([self._none, slack])
        parts = [(k, part) for k in range(len(self.terms)) for part in self._parts(k)]
        groups = {drawn: [(k, part) for k, part in parts if part.drawn == drawn] for drawn in self.searched}

        def rows(x: Array) -> list[Array]:
            out: list[list[Array]] = [[] for _ in self.terms]
            for drawn, members in groups.items():
                chosen, terms = self.searched[drawn], [part for _, part in members]
                values = self.values(source, self.factors(x, chosen), chosen, terms) if terms else []
                for (k, term), value in zip(members, values, strict=True):
                    out[k].append(term.oriented(term.statistic.rows(value), extra[k]))
            return [np.concatenate(one, -1) for one in out]

        def value(x: Array) -> tuple[Array, Array]:
            return self._split(rows(x), -1)

        def slope(x: Array) -> tuple[Array, Array]:
            out: list[list[Array]] = [[] for _ in self.terms]
            for drawn, members in groups.items():
                chosen, terms = self.searched[drawn], [part for _, part in members]
                for (k, term), jacobian in zip(members, self._jacobians(source, x, chosen, terms), strict=True):
                    out[k].append(term.sign / term.scale * jacobian)
            return self._split([np.concatenate(one) for one in out], 0)

        return Problem(len(self.inputs), value, slope)

    def _parts(self, k: int) -> list[Term]:
        """A term, or one for each of its pieces; objectives have equally many, some of them again."""
        wanted = range(len(self.target.objectives))
        most = max(len(self.pieces.get(j, [0])) for j in wanted) if k in wanted else len(self.pieces.get(k, [0]))
        own = [replace(self.terms[k], expression=one) for one in self.pieces.get(k, [])] or [self.terms[k]]
        return [own[j % len(own)] for j in range(most)]

    @cached_property
    def room(self) -> Array:
        """1 for a limit that a design can keep away from, 0 for one of a pair that is an equality; (k,)."""
        limits = [term for term in self.terms if term.limited]
        return np.array([float(not any(one.meets(other) for other in limits)) for one in limits])

    @cached_property
    def _none(self) -> Array:
        return np.zeros(len(self.target.objectives))

    def _split(self, rows: list[Array], axis: int) -> tuple[Array, Array]:
        """Objectives' rows and limits' rows, each joined."""
        wanted, limited = rows[: len(self._none)], rows[len(self._none) :]
        empty = np.empty((len(rows[0]), 0) if axis == -1 else (0, len(self.inputs)))
        return np.concatenate(wanted, axis), np.concatenate([empty, *limited], axis)

    def _jacobians(self, source: Source, x: Array, chosen: Scenarios, terms: list[Term]) -> list[Array]:
        """Derivatives of every term's rows by the scaled variables, (rows, d)."""
        if not terms:
            return []
        if source.step is not None:
            return self._quotients(source, x, chosen, terms, source.step)
        factors = self.factors(x[None], chosen)
        known = {name: array[0] for name, array in self.known(source, factors, [t.expression for t in terms]).items()}
        over = list(self.inputs)
        learned = [name for name in known if name in EVERY_QUANTITY]
        slopes = source.slopes(factors, learned, over)
        physical = self.physical(x[None])
        chain = np.array([1 / one.unit_slope(physical[name][0]) for name, one in self.inputs.items()])
        for name in set(known) - set(learned):
            slopes[name] = np.broadcast_to([float(name == one) for one in over], (chosen.count, len(over)))
        out = []
        for term in terms:
            value, partials = term.expression.partials(known)
            whole = np.zeros((chosen.count, len(over)))
            for name, partial in partials.items():
                whole += np.broadcast_to(partial, chosen.count)[:, None] * slopes[name] * chain
            shaped = np.broadcast_to(value, chosen.count).reshape(chosen.groups, chosen.draws)
            out.append(term.statistic.jacobian(shaped) @ whole)
        return out

    def _quotients(self, source: Source, x: Array, chosen: Scenarios, terms: list[Term], step: float) -> list[Array]:
        """Difference quotients of the rows, central where the range allows."""
        d = len(x)
        ends = np.clip(np.concatenate([x + step * np.eye(d), x - step * np.eye(d)]), -1, 1)
        width = np.diag(ends[:d] - ends[d:])
        values = self.values(source, self.factors(ends, chosen), chosen, terms)
        rows = [term.statistic.rows(value) for term, value in zip(terms, values, strict=True)]
        return [((one[:d] - one[d:]) / width[:, None]).T for one in rows]


def ask(study: Study, name: str, target: Target, source: Source, chosen: dict[str, float] | None = None) -> Question:
    """A question that makes sense on a source.

    Raises
    ------
    InputError
        An objective that is constant over the variables, or one that passes a pole or is not defined within them; a
        limit whose number has no unit and, read in SI, is far from every value.
    """
    held = {name: value for name, value in {**target.at, **(chosen or {})}.items() if not isinstance(value, str)}
    question = Question(study, target, held)
    corner = question.searched[False]
    if not question.inputs:
        return question
    d = len(question.inputs)
    ends = np.array(list(product([-1.0, 1.0], repeat=min(d, _ENDS))))
    inside = 2 * qmc.Sobol(d, rng=0).random(_PILOT) - 1
    x = np.concatenate([inside, np.pad(ends, ((0, 0), (0, d - ends.shape[1])))])
    factors = question.factors(x, corner)
    scales: dict[str, float] = {}
    notes: list[str] = []
    pieces: dict[int, list[Expression]] = {}
    spread = 0.0
    for place, term in enumerate(question.terms):
        what = f"design: {name}: {term.label!r}"
        value = question.values(source, factors, corner, [term])[0]
        _check_poles(what, question, term, source, factors, corner)
        if not np.all(np.isfinite(value)):
            raise InputError(f"{what} is not defined everywhere within the ranges of {', '.join(question.inputs)}")
        if not term.limited and np.ptp(value, 0).max() <= _CONSTANT * np.abs(value).max():
            raise InputError(f"{what} is constant: it does not depend on {', '.join(question.inputs)}")
        if place == 0:
            spread = float(np.ptp(value))
        if term.bound == 0:
            scales[term.label] = float(np.abs(value).max()) or 1.0
        known = question.known(source, factors, [term.expression])
        split = kinks.pieces(term.expression, -term.sign if term.limited else term.sign, known)
        if len(split) > 1 and isinstance(term.statistic, Every):
            pieces[place] = split
        if term.unitless:
            notes += misread.notes(what, term, value)
    return replace(question, scales=scales, pieces=pieces, spread=spread, notes=tuple(notes))


def _check_poles(
    what: str, question: Question, term: Term, source: Source, factors: Factors, corner: Scenarios
) -> None:
    for node in term.expression.walk():
        inner = _divisor(node)
        if inner is None or not inner.names():
            continue
        value = question.values(source, factors, corner, [replace(term, expression=inner)])[0]
        if value.min() <= 0 <= value.max():
            raise InputError(f"{what} is unbounded: {' and '.join(inner.names())} in a divisor passes 0 in the ranges")


def _divisor(node: Expression) -> Expression | None:
    """What a node divides by, or takes the logarithm of."""
    if isinstance(node, Operation) and node.symbol == "/":
        return node.right
    if isinstance(node, Power) and node.exponent < 0:
        return node.base
    return node.arguments[0] if isinstance(node, Call) and node.function == "log" else None
