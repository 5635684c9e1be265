"""What the uncertain constants of the materials make of a design: to first order, by the exact solver."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array
from solver.names import ALL_PEAKS
from workflow.design.question.question import Question
from workflow.design.question.risk import WorstCase
from workflow.design.question.sources import Exact
from workflow.design.question.terms import Term
from workflow.design.verdict import answer
from workflow.design.verdict.term import Scenario
from workflow.study import uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError


@dataclass(frozen=True)
class Spread:
    """What one standard deviation of each constant makes of each term."""

    constants: tuple[answer.Constant, ...]  # Of the materials
    effects: Array  # Relative changes of the terms, (terms, constants)

    @property
    def whole(self) -> Array:
        """Root of the sum of the squares, (terms,); NaN without a constant."""
        return np.sqrt((self.effects**2).sum(1)) if self.constants else np.full(len(self.effects), np.nan)


def over(design: Question, worst: Sequence[Scenario]) -> Spread:
    """First-order spread of the terms of one design by the constants of its materials.

    Each constant, a family of them as :mod:`workflow.study.uncertainty` scales it, is moved by itself in the case that
    decides a term; the design stays as it is. Constants are independent a priori, so that their effects add as squares.
    What a material bears is not moved.
    """
    try:
        constants = uncertainty.uncertain(design.study)
    except InputError:  # a material whose constants follow its composition
        return Spread((), np.empty((len(design.terms), 0)))
    effects = np.full((len(design.terms), len(constants)), np.nan)
    told = [k for k, term in enumerate(design.terms) if _tells(design.study, term)]
    terms, cases = [design.terms[k] for k in told], [worst[k] for k in told]
    effects[told] = uncertainty.sensitivities(design.study, constants, lambda own: _values(design, own, terms, cases))
    return Spread(tuple(answer.Constant(constant.name, constant.prior) for constant in constants), effects)


def _tells(study: Study, term: Term) -> bool:
    """Whether one case tells what a term counts as, in less than seconds for every constant."""
    searched = study.kind.tabled and not ALL_PEAKS.keys().isdisjoint(term.expression.names())
    return isinstance(term.measure, WorstCase) and not searched


def _values(design: Question, study: Study, terms: Sequence[Term], cases: Sequence[Mapping[str, float]]) -> Array:
    """Each term in its own case, with the constants of a study; (terms,)."""
    distinct = [case for place, case in enumerate(cases) if case not in cases[:place]]  # one often decides several
    factors = {name: np.array([[case[name]] for case in distinct]) for name in (distinct[0] if distinct else {})}
    known = design.known(Exact(study), factors, [term.expression for term in terms])
    places = [distinct.index(case) for case in cases]
    values = [np.broadcast_to(term.expression.evaluate(known), (len(distinct), 1)) for term in terms]
    return np.array([rows[place, 0] for place, rows in zip(places, values, strict=True)])
