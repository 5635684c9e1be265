"""Design: the best factors under limits, found on the surrogate, polished and judged on the exact solver."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.names import EVERY_QUANTITY
from surrogate import GaussianProcess
from surrogate.search.optimise import Optimum, Problem, improve, maximise
from surrogate.search.pareto import Front, scalarised
from workflow.design import assessment, budget, contact_fields, front, landscape
from workflow.design.answers import SOURCE
from workflow.design.question import Question, ask
from workflow.design.sources import Exact, Predicted, Source
from workflow.study.categories import output
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

Array = NDArray[np.float64]

_ROUNDS = 6  # polishes, each with limits shifted by what many more scenarios say
_AWAY = 1e-10  # relative distance kept from a limit, beyond rounding
_NEAR = 1e-6  # relative distance at which a limit binds
_LOST = 0.01  # share of the objective that no polish costs
_SMALL = 1e-3  # share of its range below which an objective is no scale of its own
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
    asked = [_asked(study, name, target, model, choice) for choice in choices(study, target)]
    found = _search(asked)
    best = _first_feasible(sorted(found, key=lambda one: _rank(one.best), reverse=True))
    question, x = best.question, best.best.x
    parts = [assessment.judge(question, x, best.source, best.exact), landscape.landscape(question, x, best.source)]
    if any(one.front is not None for one in found):
        parts.append(_front(found).reindex(factor=parts[0]["factor"]))
    case = {str(name): float(parts[0]["worst"].sel(factor=name)[0]) for name in parts[0]["factor"].values}
    parts.append(contact_fields.fields(question.study, case))
    parts.append(_chosen(target, best, found))
    out = xr.merge(parts, compat="no_conflicts", join="outer")
    if not bool(out["inside"].all()) and not target.allow_outside_interval:
        raise InputError(f"design: {name}: {assessment.outside(out)}; allow_outside_interval: true would accept it")
    goals = [f"{'maximise' if one.maximise else 'minimise'} {one}" for one in target.objectives]
    out.attrs = {
        "title": f"design target {name}",
        "goal": " and ".join(goals),
        "objective": str(target.objectives[0]),
        "statistic": str(target.statistic),
        "polish": best.polish,
        "source": SOURCE,
    }
    return out.assign_coords(target=name)


_NOTHING = Optimum(np.empty(0), -np.inf, np.empty(0), False)


@dataclass(frozen=True)
class _Found:
    """A question with its choices made, and what the search for its answer has come to.

    Attributes
    ----------
    choice
        Values of the variables with a list, and names of the categories.
    question, source, exact
        What is asked for these, on the surrogate and on the exact solver.
    best
        The best design.
    front
        The Pareto front, where there are several objectives.
    measure
        Reference and weights of the one objective that stands for them.
    polish, cases
        How the best design was polished, and in how many cases that are searched for.
    """

    choice: dict[str, float | str]
    question: Question
    source: Predicted
    exact: Exact
    best: Optimum = _NOTHING
    front: Front | None = None
    measure: tuple[Array, Array] | None = None
    polish: str = ""
    cases: int = 0

    def problem(self, source: Source, slack: Array | None = None) -> Problem:
        """The question for the optimiser; several objectives as the compromise that the fronts measure."""
        problem = self.question.problem(source, slack)
        if self.measure is None:
            return problem
        return scalarised(problem, len(self.question.target.objectives), *self.measure)

    def size(self, objective: float) -> float:
        """Scale of the objective at a value; next to zero, a share of its range."""
        spread = self.question.spread if self.measure is None else 1.0
        return max(abs(objective), _SMALL * spread) or 1.0


def choices(study: Study, target: Target) -> list[dict[str, float | str]]:
    """Every combination of the values of variables with a list, and of the names of categories."""
    lists: dict[str, Sequence[float | str]] = {
        name: one.choices for name, one in target.variables.items() if one.choices
    }
    for name, names in study.categories.items():
        if name not in lists:
            lists[name] = names if name in target.variables else [target.at[name]]
    return [dict(zip(lists, values, strict=True)) for values in product(*lists.values())]


def _asked(study: Study, name: str, target: Target, model: GaussianProcess, choice: dict[str, float | str]) -> _Found:
    kinds = {key: str(choice[key]) for key in study.categories}
    held = {key: float(value) for key, value in choice.items() if key not in kinds}
    wanted = [output(one, kinds) for one in target.names() if one in EVERY_QUANTITY]
    own, source = study.narrowed(kinds), Predicted(model.only(wanted) if wanted else model, kinds)
    return _Found(choice, ask(own, name, target, source, held), source, Exact(own))


def _rank(best: Optimum) -> tuple[bool, float]:
    """Feasible before infeasible; then the objective, or the least violation."""
    return best.feasible, best.objective if best.feasible else -float(best.excess.max(initial=-np.inf))


def _search(asked: list[_Found]) -> list[_Found]:
    """Optimum of every choice on the surrogate, at a distance from the limits that its uncertainty asks for."""
    traced: list[Front | None] = [None] * len(asked)
    if len(asked[0].question.target.objectives) > 1:
        traced = [front.trace(one.question, one.source, _scan(one.question)) for one in asked]
    fronts = [one for one in traced if one is not None]
    measure = front.measure(fronts) if fronts else None
    return [_climbed(replace(one, front=own, measure=measure)) for one, own in zip(asked, traced, strict=True)]


def _scan(question: Question) -> int:
    """Points of a scan: a power of two, fewer where each stands for many scenarios."""
    size = sum(one.count for one in question.searched.values())
    return 1 << int(np.clip(np.log2(_SCANNED / size), 7, 12))


def _climbed(found: _Found) -> _Found:
    question, source = found.question, found.source
    if not question.inputs:
        return replace(found, best=_only(found.problem(source)))
    if found.front is not None:
        first = front.best_of(found.front, found.problem(source))
    else:
        first = maximise(found.problem(source), scan=_scan(question))
    doubt = assessment.doubts(question, first.x, source) * question.room
    return replace(found, best=improve(found.problem(source, doubt), first.x, found.size(first.objective)))


def _front(found: list[_Found]) -> xr.Dataset:
    """The exact front of all choices."""
    traced = [(one, one.front) for one in found if one.front]
    share = 1 / len(traced)
    parts = {_words(one): front.solved(one.question, own, one.source, one.exact, share) for one, own in traced}
    return front.together(parts, np.array([one.sign for one in found[0].question.target.objectives]))


def _chosen(target: Target, best: _Found, found: list[_Found]) -> xr.Dataset:
    """The categories of a design, and the best of every choice on the surrogate."""
    out = xr.Dataset()
    kinds = {key: value for key, value in best.choice.items() if isinstance(value, str)}
    if kinds:
        roles = ["variable" if key in target.variables else "given" for key in kinds]
        out = out.assign_coords(category=list(kinds)).assign(
            kind=("category", list(kinds.values())), kind_role=("category", roles)
        )
    if len(found) > 1:
        signs = 1.0 if len(target.objectives) > 1 else target.objectives[0].sign
        out = out.assign_coords(choice=[_words(one) for one in found]).assign(
            choice_objective=("choice", [signs * one.best.objective for one in found]),
            choice_feasible=("choice", [one.best.feasible for one in found]),
        )
    return out


def _words(found: _Found) -> str:
    """A choice in words: names as they are, numbers with theirs."""
    target = found.question.target
    return ", ".join(
        value if isinstance(value, str) else f"{key} = {value:g}"
        for key, value in found.choice.items()
        if key in target.variables
    )


def _first_feasible(ranked: list[_Found]) -> _Found:
    """The best choice that stays feasible on the exact solver, or else the first one, polished."""
    first, spent = None, 0
    for found in ranked:
        polished = _polish(found)
        first, spent = first or polished, spent + polished.cases
        if polished.best.feasible:
            return polished
        if not found.best.feasible or spent > budget.AFFORDABLE:
            break
    return first or ranked[0]


def _polish(found: _Found) -> _Found:
    """The same on the exact solver, until many more scenarios say what the few of the search say.

    What is too costly for the optimiser it takes from the surrogate, shifted to what the exact solver says.
    """
    question, best, source, exact = found.question, found.best, found.source, found.exact
    limits = [term for term in question.terms if term.limited]
    near, away = budget.spared(question, source, exact), budget.away(question, _AWAY)
    slack, last, spent = np.zeros(len(limits)), None, 0
    rounds = _ROUNDS if question.inputs else 0
    for k in range(rounds + 1):
        values, cases = assessment.settled(question, limits, best.x, source, exact)
        judged = np.array([float(term.oriented(value)) for term, value in zip(limits, values, strict=True)])
        searched = assessment.excesses(question, best.x, near)
        bound, spent = searched + slack > -_NEAR, spent + cases
        if last is not None and best.objective < last.objective - _LOST * found.size(last.objective):
            break  # a search that went astray
        kept = judged <= assessment.ROUNDING
        last = best if np.all(kept) else last
        done = not best.feasible or np.all(kept & ((judged > -_NEAR) | ~bound))
        if (k > 0 and done) or k == rounds or spent + cases > budget.AFFORDABLE:
            break
        # what a few scenarios make of a limit differs from what many do: shift it by that
        slack = judged - searched + away * question.room
        best = improve(found.problem(near, slack), best.x, found.size(best.objective))
    best, moved = (replace(best, feasible=False) if last is None else last), last is not found.best and rounds > 0
    return replace(found, best=best, cases=spent, polish=budget.words(question, spent, moved))


def _only(problem: Problem) -> Optimum:
    """The one design of a question without continuous variables."""
    objective, excess = (one[0] for one in problem.value(np.empty((1, 0))))
    return Optimum(np.empty(0), float(objective.min()), excess, bool(np.all(excess <= 0)))
