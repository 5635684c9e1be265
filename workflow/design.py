"""Design: the best factors under limits, found on the surrogate, polished and judged on the exact solver."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate import GaussianProcess
from surrogate.optimise import Optimum, Problem, improve, maximise
from surrogate.pareto import Front
from workflow import contactfields, costly, front, judgement, landscape
from workflow.inputs import InputError
from workflow.question import Question, ask
from workflow.sources import Exact, Predicted, Source
from workflow.study import Study
from workflow.target import Target

Array = NDArray[np.float64]

_ROUNDS = 6  # polishes, each with limits shifted by what many more scenarios say
_AWAY = 1e-10  # relative distance kept from a limit, beyond rounding
_NEAR = 1e-6  # relative distance at which a limit binds
_SCANNED = 1 << 17  # most evaluations of the surrogate in one scan


def solve_target(study: Study, name: str, model: GaussianProcess) -> xr.Dataset:
    """Answer one design target of a study.

    Parameters
    ----------
    study, name
        The study and the name of its target.
    model
        Surrogate of the study's quantities.

    Returns
    -------
    xarray.Dataset
        What `judgement.judge` and `landscape.landscape` give.

    Raises
    ------
    InputError
        An objective that is constant, unbounded or undefined; an exact value outside the surrogate's interval, unless
        the target allows it.
    """
    return answer(study, name, study.design[name], model)


def answer(study: Study, name: str, target: Target, model: GaussianProcess) -> xr.Dataset:
    """Answer any target on the study's factors; see `solve_target`."""
    source, exact = Predicted(model), Exact(study)
    found = [_search(ask(study, name, target, source, chosen), source) for chosen in choices(target)]
    best = _first_feasible(sorted(found, key=lambda one: _rank(one.best), reverse=True), source, exact)
    question, x = best.question, best.best.x
    parts = [judgement.judge(question, x, source, exact), landscape.landscape(question, x, source)]
    if best.front is not None:
        parts.append(front.solved(question, best.front, source, exact).reindex(factor=parts[0]["factor"]))
    case = {str(name): float(parts[0]["worst"].sel(factor=name)[0]) for name in parts[0]["factor"].values}
    parts.append(contactfields.fields(study, case))
    out = xr.merge(parts, compat="no_conflicts", join="outer")
    if not bool(out["inside"].all()) and not target.allow_outside_interval:
        raise InputError(f"design: {name}: {judgement.outside(out)}; allow_outside_interval: true would accept it")
    goals = [f"{'maximise' if one.maximise else 'minimise'} {one}" for one in target.objectives]
    out.attrs = {
        "title": f"design target {name}",
        "goal": " and ".join(goals),
        "objective": str(target.objectives[0]),
        "statistic": str(target.statistic),
        "polish": best.polish,
    }
    return out.assign_coords(target=name)


_NOTHING = Optimum(np.empty(0), -np.inf, np.empty(0), False)


@dataclass(frozen=True)
class _Found:
    """What a search ended with; how it was polished then, and in how many searched cases."""

    question: Question
    best: Optimum
    front: Front | None = None
    polish: str = ""
    cases: int = 0

    def problem(self, source: Source, slack: Array | None = None) -> Problem:
        """The question for the optimiser; several objectives as the compromise that the front measures."""
        problem = self.question.problem(source, slack)
        return problem if self.front is None else front.compromise(problem, self.question, self.front)


def choices(target: Target) -> list[dict[str, float]]:
    """Every combination of the values that variables with a list may take."""
    lists = {name: one.choices for name, one in target.variables.items() if one.choices}
    return [dict(zip(lists, values, strict=True)) for values in product(*lists.values())]


def _rank(best: Optimum) -> tuple[bool, float]:
    """Feasible before infeasible; then the objective, or the least violation."""
    return best.feasible, best.objective if best.feasible else -float(best.excess.max(initial=-np.inf))


def _search(question: Question, source: Predicted) -> _Found:
    """Optimum on the surrogate, at a distance from the limits that its uncertainty asks for."""
    if not question.inputs:
        return _Found(question, _only(question, source))
    size = sum(one.count for one in question.searched.values())
    scan = 1 << int(np.clip(np.log2(_SCANNED / size), 7, 12))
    traced = front.trace(question, source, scan) if len(question.target.objectives) > 1 else None
    found = _Found(question, _NOTHING, traced)
    if traced is not None:
        first = front.best_of(traced, found.problem(source))
    else:
        first = maximise(found.problem(source), scan=scan)
    doubt = judgement.doubts(question, first.x, source)
    return replace(found, best=improve(found.problem(source, doubt), first.x, abs(first.objective) or 1.0))


def _first_feasible(ranked: list[_Found], source: Predicted, exact: Exact) -> _Found:
    """The best of some searches that stays feasible on the exact solver, or else the first, polished."""
    first, spent = None, 0
    for found in ranked:
        polished = _polish(found, source, exact)
        first, spent = first or polished, spent + polished.cases
        if polished.best.feasible:
            return polished
        if not found.best.feasible or spent > costly.AFFORDABLE:
            break
    return first or ranked[0]


def _polish(found: _Found, source: Predicted, exact: Exact) -> _Found:
    """The same on the exact solver, until many more scenarios say what the few of the search say.

    What is too costly for the optimiser it takes from the surrogate, shifted to what the exact solver says.
    """
    question, best = found.question, found.best
    limits = [term for term in question.terms if term.limited]
    near, away = costly.spared(question, source, exact), costly.away(question, _AWAY)
    slack, last, spent = np.zeros(len(limits)), None, 0
    rounds = _ROUNDS if question.inputs else 0
    for k in range(rounds + 1):
        values, cases = judgement.settled(question, limits, best.x, source, exact)
        judged = np.array([float(term.oriented(value)) for term, value in zip(limits, values, strict=True)])
        searched = judgement.excesses(question, best.x, near)
        bound, spent = searched + slack > -_NEAR, spent + cases
        last = best if np.all(judged <= 0) else last
        done = not best.feasible or np.all((judged <= 0) & ((judged > -_NEAR) | ~bound))
        if (k > 0 and done) or k == rounds or spent + cases > costly.AFFORDABLE:
            break
        # what a few scenarios make of a limit differs from what many do: shift it by that
        slack = judged - searched + away
        best = improve(found.problem(near, slack), best.x, abs(best.objective) or 1.0)
    best, moved = (replace(best, feasible=False) if last is None else last), last is not found.best and rounds > 0
    return replace(found, best=best, cases=spent, polish=costly.words(question, spent, moved))


def _only(question: Question, source: Source) -> Optimum:
    """The one design of a question without continuous variables."""
    objective, excess = (one[0] for one in question.problem(source).value(np.empty((1, 0))))
    return Optimum(np.empty(0), float(objective.min()), excess, bool(np.all(excess <= 0)))
