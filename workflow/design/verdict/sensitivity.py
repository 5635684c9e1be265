"""Sensitivity of a design: errors of 1 % in building it, and one standard deviation of material constants."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array
from solver.names import ALL_PEAKS
from workflow.design.question import budget
from workflow.design.question.question import Question
from workflow.design.question.risk import WorstCase
from workflow.design.question.sources import Exact, Source
from workflow.design.question.terms import Term
from workflow.design.verdict import answer
from workflow.design.verdict.term import Scenario
from workflow.design.verdict.variable import Sensitivity
from workflow.language.factors import FACTORS
from workflow.study import uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError

_STEP = 1e-3  # relative step of elasticities
_ERROR = 0.01  # relative error in building a variable
_SHARES = 1 + np.array([-_STEP, _STEP, -_ERROR, _ERROR])
_NOTHING = 1e-9  # share of the goal that counts as no change


def sensitivities(design: Question, exact: Array) -> dict[str, Sensitivity]:
    """Elasticity of every term, and what a 1 % error costs, for every continuous variable that is not zero.

    By differences on what stands for the exact solver.
    """
    source = budget.affordable(design)
    varied = _varied(design, source)
    # of draws the few of the search: what they lack is added to all alike
    sets = {key: design.searched[key] if key is True else chosen for key, chosen in design.judged.items()}
    counts = design.at_variables(varied).count(source, sets)
    counts += exact - counts[0]
    around = counts[1:].reshape(len(varied), len(_SHARES), len(exact))
    largest = np.abs(around).max((0, 1), initial=0.0)
    return {
        name: _effects(design, values[0], values[1 + 4 * k : 5 + 4 * k], counts[0], around[k], largest)
        for k, (name, values) in enumerate(varied.items())
        if values[0] != 0  # which has no 1 % of it
    }


def _varied(design: Question, source: Source) -> dict[str, Array]:
    """Variables at the design, then one after another moved by the shares, (1 + 4 d,) each."""
    count = 1 + len(_SHARES) * len(design.variables)
    varied = {name: np.full(count, nominal) for name, (nominal,) in design.variables.items()}
    for k, (name, values) in enumerate(varied.items()):
        # the surrogate, where it stands in, knows no case beyond its box
        factor = FACTORS[name]
        low, high = (factor.low, factor.high) if isinstance(source, Exact) else design.room(name)
        values[1 + 4 * k : 5 + 4 * k] = np.clip(values[0] * _SHARES, low, high)
    return varied


def _effects(
    question: Question, nominal: float, moved: Array, nominal_counts: Array, around: Array, largest: Array
) -> Sensitivity:
    """Effects of one variable from the terms at its value, (terms,), and at four moved values, (4, terms)."""
    # a share of what is next to zero says nothing
    whole = np.where(np.abs(nominal_counts) > _NOTHING * largest, nominal_counts, np.nan)
    change = (moved[1] - moved[0]) / nominal
    with np.errstate(divide="ignore", invalid="ignore"):
        elasticity = (around[1] - around[0]) / whole / change if change else np.full(len(nominal_counts), np.nan)
    wanted, erred = question.objectives, around[2:]
    loss = max(float((question.terms[0].sign * (nominal_counts[0] - erred[:, 0])).max()), 0.0)
    same = np.abs(erred - nominal_counts) <= _NOTHING * np.maximum(np.abs(nominal_counts), largest)
    margins = [-term.oriented(erred[:, k]) for k, term in enumerate(question.terms) if term.limited]
    return Sensitivity(
        elasticity=tuple(elasticity.tolist()),
        cost=float(loss / abs(whole[0])),
        loss=loss,
        matters=not np.all(same[:, :wanted]),
        margin_left=float(np.min(margins)) if margins else np.nan,
    )


@dataclass(frozen=True)
class Spread:
    """Relative changes of each term by one standard deviation of each constant."""

    constants: tuple[answer.Constant, ...]  # Of the materials
    effects: Array  # Relative changes of the terms, (terms, constants)

    @property
    def whole(self) -> Array:
        """Root of the sum of the squares, (terms,); NaN without a constant."""
        return np.sqrt((self.effects**2).sum(1)) if self.constants else np.full(len(self.effects), np.nan)


def spread(design: Question, worst: Sequence[Scenario]) -> Spread:
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
    places = [k for k, term in enumerate(design.terms) if _tells(design.study, term)]
    terms, cases = [design.terms[k] for k in places], [worst[k] for k in places]
    effects[places] = uncertainty.sensitivities(
        design.study, constants, lambda varied_study: _case_values(design, varied_study, terms, cases)
    )
    return Spread(tuple(answer.Constant(constant.name, constant.prior) for constant in constants), effects)


def _tells(study: Study, term: Term) -> bool:
    """Return whether one case decides a term, and takes less than seconds for every constant."""
    searched = study.kind.tabled and not ALL_PEAKS.keys().isdisjoint(term.expression.names())
    return isinstance(term.measure, WorstCase) and not searched


def _case_values(design: Question, study: Study, terms: Sequence[Term], cases: Sequence[Mapping[str, float]]) -> Array:
    """Each term in its own case, with the constants of a study; (terms,)."""
    distinct = [case for place, case in enumerate(cases) if case not in cases[:place]]  # one often decides several
    factors = {name: np.array([[case[name]] for case in distinct]) for name in (distinct[0] if distinct else {})}
    known = design.known(Exact(study), factors, [term.expression for term in terms])
    places = [distinct.index(case) for case in cases]
    values = [np.broadcast_to(term.expression.evaluate(known), (len(distinct), 1)) for term in terms]
    return np.array([rows[place, 0] for place, rows in zip(places, values, strict=True)])
