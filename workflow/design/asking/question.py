"""A design question with its choices made: scaled variables, scenarios, and terms with what they count as."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np

from approximation.arrays import Array
from approximation.sobol import sobol_points
from solver.names import ALL_QUANTITIES
from surrogate import Input
from workflow.dataset import factorial
from workflow.design.asking import kinks, scenarios, unitless
from workflow.design.asking.risk import RelativeDeviation, WorstCase
from workflow.design.asking.scenarios import Scenarios
from workflow.design.asking.sources import Factors, Source, shape
from workflow.design.asking.terms import Deviation, Key, Term, limited, wanted
from workflow.language.constants import CONSTANTS
from workflow.language.expressions import Call, Expression, Operation, Power
from workflow.language.statements import Statement
from workflow.language.statistics import Worst
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

_PILOT = 512  # points that tell a constant, unbounded or undefined term
_EVALUATED = 1 << 13  # evaluations of a term by the pilot
_ENDS = 8  # variables of which every combination of ends is among them
_CONSTANT = 1e-9  # relative variation that counts as none


@dataclass(frozen=True)
class Question:
    """A target of a study with its choices made."""

    # What is asked
    study: Study
    target: Target
    # Factors at one value: the target's own and those chosen from lists
    held: dict[str, float] = field(default_factory=dict)
    scales: dict[str, float] = field(default_factory=dict)  # Scale of every limit whose bound is zero, by label
    # Smooth pieces of terms with kinks, by the term's place
    pieces: dict[int, list[Expression]] = field(default_factory=dict)
    spread: float = 1.0  # Range of the first objective over the ranges
    notes: tuple[str, ...] = ()  # What a reader of the answer should know about how the question was read

    @cached_property
    def inputs(self) -> dict[str, Input]:
        """The continuous design variables, each with its range; their tolerances stay within the study's."""
        whole = {axis.name: axis for axis in factorial.inputs(self.study)}
        ranges = {name: self.target.range(name, *self.room(name)) for name in self.target.continuous}
        return {name: replace(whole[name], low=low, high=high) for name, (low, high) in ranges.items()}

    def room(self, name: str) -> tuple[float, float]:
        """Lowest and highest value of a factor whose tolerance stays within the study's range."""
        axis = self.study.factors[name]
        return self.target.room(name, axis.low, axis.high)

    @cached_property
    def terms(self) -> list[Term]:
        """Objectives first, then the limits in the study's order."""
        target = self.target
        statistic = target.statistic if target.random else Worst()
        drawn = bool(target.random)
        return [wanted(objective, statistic, self._deviation(objective)) for objective in target.objectives] + [
            limited(
                limit,
                self.scales.get(str(limit), 1.0),
                limit.value * (self.study.constant(limit.allowable) if limit.allowable else 1.0),
                self._deviation(limit),
                drawn=drawn,
            )
            for limit in target.limits
        ]

    def _deviation(self, statement: Statement) -> Deviation | None:
        """Over what a statement's deviation is taken, with the weights of its means."""
        if not statement.deviation:
            return None
        names = self.target.deviating(statement)
        sets = [scenarios.weights(self.target, names, nodes) for nodes in (scenarios.SEARCHED, scenarios.JUDGED)]
        return Deviation(names, RelativeDeviation({len(share): share for share in sets}))

    @cached_property
    def objectives(self) -> int:
        """How many of the terms, the first, are objectives."""
        return sum(not term.limited for term in self.terms)

    @cached_property
    def searched(self) -> dict[Key, Scenarios]:
        """Scenarios of the search: corners under False, draws (where something is drawn) under True.

        Those of a deviation stand under the factors over which it is taken.
        """
        return self._scenarios(scenarios.SEARCHED, scenarios.DRAWN)

    @cached_property
    def judged(self) -> dict[Key, Scenarios]:
        """Many more of them, for the verdict."""
        return self._scenarios(scenarios.JUDGED, scenarios.DRAWN_TO_JUDGE)

    def _scenarios(self, nodes: dict[int, int], drawn: int) -> dict[Key, Scenarios]:
        """All sets, each with the terms that count over it."""
        sets: dict[Key, Scenarios] = {False: scenarios.corners(self.target, nodes)}
        for key in dict.fromkeys(term.key for term in self.terms):
            if isinstance(key, tuple):
                sets[key] = scenarios.along(self.target, key, nodes)
            elif key:
                sets[key] = scenarios.draws(self.target, drawn)
        placed = list(enumerate(self.terms))
        return {
            key: replace(chosen, terms={place: term for place, term in placed if term.key == key})
            for key, chosen in sets.items()
        }

    def smooth(self, place: int) -> list[Term]:
        """A term, or one for each of its pieces; objectives have equally many, some of them again."""
        term, objectives = self.terms[place], range(self.objectives)
        own = [replace(term, expression=piece) for piece in self.pieces.get(place, [term.expression])]
        together = objectives if place in objectives else [place]
        most = max(len(self.pieces.get(other, [term])) for other in together)
        return [own[k % len(own)] for k in range(most)]

    @cached_property
    def inequality(self) -> Array:
        """1 for a limit that a design can keep away from, 0 for one of a pair that is an equality; (k,)."""
        limits = [term for term in self.terms if term.limited]
        return np.array([float(not any(term.meets(other) for other in limits)) for term in limits])

    def physical(self, x: Array) -> dict[str, Array]:
        """Design variables at scaled points (n, d), (n,) each by name."""
        return {
            name: np.clip(axis.from_unit(x[:, column]), axis.low, axis.high)
            for column, (name, axis) in enumerate(self.inputs.items())
        }

    def factors(self, variables: dict[str, Array], chosen: Scenarios) -> Factors:
        """Every factor of the factorial, over (points, scenarios).

        variables: dict of str to ndarray, shape (n,), SI.
        """
        given = {name: np.full((1, 1), value) for name, value in self.held.items()}
        given |= {name: values[None, :] for name, values in chosen.values.items()}
        given |= {name: values[:, None] for name, values in variables.items()}
        for name, offsets in chosen.offsets.items():
            absolute, share = self.target.tolerances[name]
            given[name] = given[name] * (1 + share * offsets) + absolute * offsets
        return {name: given[name] for name in self.study.factors}

    def values(
        self, source: Source, variables: dict[str, Array], chosen: Scenarios, terms: Sequence[Term]
    ) -> list[Array]:
        """Expressions of some terms, (points, groups, draws) each.

        variables: dict of str to ndarray, shape (points,), SI.
        """
        factors = self.factors(variables, chosen)
        known = self.known(source, factors, [term.expression for term in terms])
        whole = np.zeros(shape(factors))
        split = (len(whole), chosen.groups, chosen.draws)
        return [(term.expression.evaluate(known) + whole).reshape(split) for term in terms]

    def count(self, source: Source, variables: dict[str, Array], sets: Mapping[Key, Scenarios]) -> Array:
        """What every term counts as, (points, terms).

        variables: dict of str to ndarray, shape (points,), SI.
        """
        counted: dict[int, Array] = {}
        for chosen in sets.values():
            evaluated = self.values(source, variables, chosen, list(chosen.terms.values())) if chosen.terms else []
            for (place, term), values in zip(chosen.terms.items(), evaluated, strict=True):
                counted[place] = term.counted(values)
        return np.stack([counted[place] for place in range(len(self.terms))], -1)

    def known(self, source: Source, factors: Factors, expressions: Sequence[Expression]) -> dict[str, Array]:
        """Values of all names in some expressions, over (points, scenarios) or an axis of length one."""
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


def ask(study: Study, name: str, target: Target, source: Source, chosen: dict[str, float] | None = None) -> Question:
    """A question that makes sense on a source."""
    held = {name: value for name, value in {**target.at, **(chosen or {})}.items() if not isinstance(value, str)}
    question = Question(study, target, held)
    if not question.inputs:
        return question
    corner = question.searched[False]
    variables = _answered(name, question, source, question.physical(_pilot(len(question.inputs), corner.count)))
    factors = question.factors(variables, corner)
    scales: dict[str, float] = {}
    notes: list[str] = []
    pieces: dict[int, list[Expression]] = {}
    spread = 0.0
    for place, term in enumerate(question.terms):
        what = f"design: {name}: {term.label!r}"
        values = question.values(source, variables, question.searched[term.key], [term])[0]
        for divisor in _divisors(term.expression):
            passed = question.values(source, variables, corner, [replace(term, expression=divisor)])[0]
            _check_pole(what, divisor, passed)
        _check_values(what, question, term, term.measure.rows(values) if term.along else values)
        if place == 0:
            spread = float(np.ptp(values))
        if term.bound == 0:
            scales[term.label] = float(np.abs(values).max()) or 1.0
        if isinstance(term.measure, WorstCase):
            known = question.known(source, factors, [term.expression])
            split = kinks.pieces(term.expression, -term.sign if term.limited else term.sign, known)
            pieces |= {place: split} if len(split) > 1 else {}
        if term.unitless:
            notes += unitless.notes(what, term, values)
    return replace(question, scales=scales, pieces=pieces, spread=spread, notes=tuple(notes))


def _answered(name: str, question: Question, source: Source, variables: dict[str, Array]) -> dict[str, Array]:
    """Those of some designs none of whose corners lies beyond the edge of the cases that the solver answers."""
    if source.edge is None:
        return variables
    factors = question.factors(variables, question.searched[False])
    inside = np.all(source.edge.excess(factors) <= 0, axis=1)
    if not inside.any():
        raise InputError(
            f"design: {name}: every design is beyond the edge of the cases that have answers: "
            f"{source.edge.reason(factors)}"
        )
    return {variable: values[inside] for variable, values in variables.items()}


def _check_pole(what: str, divisor: Expression, values: Array) -> None:
    if values.min() <= 0 <= values.max():
        raise InputError(f"{what} is unbounded: {' and '.join(divisor.names())} in a divisor passes 0 in the ranges")


def _check_values(what: str, question: Question, term: Term, values: Array) -> None:
    if not np.all(np.isfinite(values)):
        raise InputError(f"{what} is not defined everywhere within the ranges of {', '.join(question.inputs)}")
    if not term.limited and np.ptp(values, 0).max() <= _CONSTANT * np.abs(values).max():
        raise InputError(f"{what} is constant: it does not depend on {', '.join(question.inputs)}")


def _pilot(d: int, scenarios: int) -> Array:
    """Scaled points that tell what a term is like: inside, and at combinations of the ranges' ends.

    Fewer where each stands for many scenarios.
    """
    ends = np.array(list(product([-1.0, 1.0], repeat=min(d, _ENDS))))
    count = 1 << int(np.clip(np.log2(_EVALUATED / scenarios), 5, np.log2(_PILOT)))
    inside = 2 * sobol_points(count, d) - 1
    return np.concatenate([inside, np.pad(ends, ((0, 0), (0, d - ends.shape[1])))])


def _divisors(expression: Expression) -> list[Expression]:
    """What an expression divides by, or takes the logarithm of, wherever that holds a name."""
    inner: list[Expression] = []
    for node in expression.walk():
        if isinstance(node, Operation) and node.symbol == "/":
            inner.append(node.right)
        elif isinstance(node, Power) and node.exponent < 0:
            inner.append(node.base)
        elif isinstance(node, Call) and node.function == "log":
            inner.append(node.arguments[0])
    return [node for node in inner if node.names()]
