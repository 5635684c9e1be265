"""Cost of a design's tolerances: against the nominal optimum, one by one, and the gain by halving one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from surrogate.search.optimise import improve
from workflow.design.question.question import Question
from workflow.design.search.candidate import Candidate
from workflow.design.verdict import assessment
from workflow.design.verdict.answer import Tolerated
from workflow.language.factors import FACTORS
from workflow.study.target import Target

_TIGHTER = 0.5  # share of a tolerance that is left when it is tightened in words

#: A question for another target, with the choices of a design.
Asked = Callable[[Target], Question]


def nominal(target: Target) -> Target:
    """The target without any tolerance."""
    return target.model_copy(update={"tolerance": {}})


def costs(best: Candidate, without: Candidate, question_for: Asked) -> Tolerated:
    """Cost of the tolerances of the best design against the one without tolerances."""
    target, design = best.question.target, without.design
    whole = _reached(best, question_for(target))
    cost, gain = dict[str, float](), dict[str, float]()
    for name in target.tolerance:
        others = {key: reach for key, reach in target.tolerance.items() if key != name}
        cost[name] = _share(_reached(best, question_for(target.model_copy(update={"tolerance": others}))), whole)
        tighter = {**target.tolerance, name: _tightened(target, name)}
        gain[name] = _share(_reached(best, question_for(target.model_copy(update={"tolerance": tighter}))), whole)
    values = {name: float(column[0]) for name, column in design.variables.items()} | without.question.held
    exact, _ = assessment.exactly(design, design.terms[:1])
    named = ", ".join(kind for kind in without.choice.values() if isinstance(kind, str))
    return Tolerated(cost, gain, values, float(exact[0]), named)


def _tightened(target: Target, name: str) -> str:
    absolute, share = target.tolerances[name]
    return f"{100 * _TIGHTER * share} %" if share else f"{_TIGHTER * absolute} {FACTORS[name].units}".removesuffix(" 1")


def near(best: Candidate, other: Candidate) -> Candidate:
    """The best design of another question near that of one with the same variables, on the surrogate."""
    physical = best.design.variables
    inputs = other.question.inputs
    start = np.array([float(axis.to_unit(physical[name])[0]) for name, axis in inputs.items()])
    problem = other.question.problem(best.question.predicted)
    return replace(other, best=improve(problem, np.clip(start, -1, 1), best.size(best.best.objective)))


def _reached(best: Candidate, question: Question) -> float:
    """The goal near a design under other tolerances, on the surrogate."""
    nearby = near(best, replace(best, question=question)).best
    return nearby.objective if nearby.feasible else np.nan


def _share(other: float, whole: float) -> float:
    return max((other - whole) / abs(whole), 0.0) if np.isfinite(other) else np.nan
