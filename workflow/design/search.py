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
from workflow.design import assessment, budget, contact_fields, front, landscape, program
from workflow.design.answers import SOURCE
from workflow.design.designs import Designs
from workflow.design.question import Question, ask
from workflow.design.sources import Exact, Predicted, Source
from workflow.study.categories import output
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

Array = NDArray[np.float64]

_ROUNDS = 6  # polishes, each with limits shifted by what many more scenarios say
_SAFETY = 1e-10  # relative safety margin, beyond rounding
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
        What `assessment.judge` and `landscape.landscape` give.

    Raises
    ------
    InputError
        An objective that is constant, unbounded or undefined; an exact value outside the surrogate's interval, unless
        the target allows it.
    """
    return answer(study, name, study.design[name], model)


def answer(study: Study, name: str, target: Target, model: GaussianProcess) -> xr.Dataset:
    """Answer any target on the study's factors; see `solve_target`."""
    asked = [_asked(study, name, target, model, choice) for choice in combinations(study, target)]
    found = _search(asked)
    best = _first_feasible(sorted(found, key=lambda candidate: _rank(candidate.best), reverse=True))
    parts = [assessment.judge(best.design), landscape.landscape(best.design)]
    if any(candidate.front is not None for candidate in found):
        parts.append(_front(found).reindex(factor=parts[0]["factor"]))
    case = {str(name): float(parts[0]["worst"].sel(factor=name)[0]) for name in parts[0]["factor"].values}
    parts.append(contact_fields.fields(best.question.study, case))
    parts.append(_chosen(target, best, found))
    out = xr.merge(parts, compat="no_conflicts", join="outer")
    if not bool(out["inside"].all()) and not target.allow_outside_interval:
        raise InputError(f"design: {name}: {assessment.outside(out)}; allow_outside_interval: true would accept it")
    goals = [f"{'maximise' if goal.maximise else 'minimise'} {goal}" for goal in target.objectives]
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
class _Candidate:
    """The best design of one choice, as far as the search for it has come.

    Attributes
    ----------
    choice
        Values of the variables with a list, and names of the categories.
    asked
        The question for these, with its sources; no design yet.
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
    asked: Designs
    best: Optimum = _NOTHING
    front: Front | None = None
    measure: tuple[Array, Array] | None = None
    polish: str = ""
    cases: int = 0

    @property
    def question(self) -> Question:
        """What is asked."""
        return self.asked.question

    @property
    def design(self) -> Designs:
        """The best design, with its question and sources."""
        return self.asked.at(self.best.x)

    def problem(self, source: Source, safety: Array | None = None) -> Problem:
        """The question for the optimiser; several objectives as the compromise that the fronts measure."""
        problem = program.problem(self.question, source, safety)
        if self.measure is None:
            return problem
        return scalarised(problem, self.question.objectives, *self.measure)

    def improved(self, source: Source, safety: Array) -> "_Candidate":
        """The best design near this one, with a safety margin to every limit."""
        best = self.best
        return replace(self, best=improve(self.problem(source, safety), best.x, self.size(best.objective)))

    def size(self, objective: float) -> float:
        """Scale of the objective at a value; next to zero, a share of its range."""
        spread = self.question.spread if self.measure is None else 1.0
        return max(abs(objective), _SMALL * spread) or 1.0


def combinations(study: Study, target: Target) -> list[dict[str, float | str]]:
    """Every combination of the values of variables with a list, and of the names of categories."""
    lists: dict[str, Sequence[float | str]] = {
        name: variable.choices for name, variable in target.variables.items() if variable.choices
    }
    for name, names in study.categories.items():
        if name not in lists:
            lists[name] = names if name in target.variables else [target.at[name]]
    return [dict(zip(lists, values, strict=True)) for values in product(*lists.values())]


def _asked(
    study: Study, name: str, target: Target, model: GaussianProcess, choice: dict[str, float | str]
) -> _Candidate:
    categories = {key: str(choice[key]) for key in study.categories}
    held = {key: float(value) for key, value in choice.items() if key not in categories}
    wanted = [output(quantity, categories) for quantity in target.names() if quantity in EVERY_QUANTITY]
    own, predicted = study.narrowed(categories), Predicted(model.only(wanted) if wanted else model, categories)
    question = ask(own, name, target, predicted, held)
    return _Candidate(choice, Designs(question, predicted, Exact(own), np.empty((0, len(question.inputs)))))


def _rank(best: Optimum) -> tuple[bool, float]:
    """Feasible before infeasible; then the objective, or the least violation."""
    return best.feasible, best.objective if best.feasible else -float(best.excess.max(initial=-np.inf))


def _search(asked: list[_Candidate]) -> list[_Candidate]:
    """Optimum of every choice on the surrogate, with the safety margin that its uncertainty asks for."""
    traced: list[Front | None] = [None] * len(asked)
    if asked[0].question.objectives > 1:
        traced = [front.trace(candidate.asked, _scan(candidate.question)) for candidate in asked]
    fronts = [own for own in traced if own is not None]
    measure = front.measure(fronts) if fronts else None
    return [_climbed(replace(one, front=own, measure=measure)) for one, own in zip(asked, traced, strict=True)]


def _scan(question: Question) -> int:
    """Points of a scan: a power of two, fewer where each stands for many scenarios."""
    size = sum(chosen.count for chosen in question.searched.values())
    return 1 << int(np.clip(np.log2(_SCANNED / size), 7, 12))


def _climbed(candidate: _Candidate) -> _Candidate:
    question, predicted = candidate.question, candidate.asked.predicted
    problem = candidate.problem(predicted)
    if not question.inputs:
        return replace(candidate, best=_only(problem))
    if candidate.front is not None:
        first = replace(candidate, best=front.best_of(candidate.front, problem))
    else:
        first = replace(candidate, best=maximise(problem, scan=_scan(question)))
    return first.improved(predicted, assessment.doubts(first.design) * question.inequality)


def _front(found: list[_Candidate]) -> xr.Dataset:
    """The exact front of all choices."""
    traced = [(candidate, candidate.asked.at(candidate.front.x)) for candidate in found if candidate.front]
    parts = {_words(candidate): front.verified(designs, 1 / len(traced)) for candidate, designs in traced}
    return front.merged(parts, np.array([objective.sign for objective in found[0].question.target.objectives]))


def _chosen(target: Target, best: _Candidate, found: list[_Candidate]) -> xr.Dataset:
    """The categories of a design, and the best of every choice on the surrogate."""
    out = xr.Dataset()
    categories = {key: value for key, value in best.choice.items() if isinstance(value, str)}
    if categories:
        roles = ["variable" if key in target.variables else "given" for key in categories]
        out = out.assign_coords(category=list(categories)).assign(
            kind=("category", list(categories.values())), kind_role=("category", roles)
        )
    if len(found) > 1:
        sign = 1.0 if len(target.objectives) > 1 else target.objectives[0].sign
        out = out.assign_coords(choice=[_words(candidate) for candidate in found]).assign(
            choice_objective=("choice", [sign * candidate.best.objective for candidate in found]),
            choice_feasible=("choice", [candidate.best.feasible for candidate in found]),
        )
    return out


def _words(candidate: _Candidate) -> str:
    """A choice in words: names as they are, numbers with theirs."""
    target = candidate.question.target
    return ", ".join(
        value if isinstance(value, str) else f"{key} = {value:g}"
        for key, value in candidate.choice.items()
        if key in target.variables
    )


def _first_feasible(ranked: list[_Candidate]) -> _Candidate:
    """The best choice that stays feasible on the exact solver, or else the first one, polished."""
    first, spent = None, 0
    for candidate in ranked:
        polished = _polish(candidate)
        first, spent = first or polished, spent + polished.cases
        if polished.best.feasible:
            return polished
        if not candidate.best.feasible or spent > budget.AFFORDABLE:
            break
    return first or ranked[0]


@dataclass(frozen=True)
class _Excess:
    """Relative excess of every limit at one design.

    Attributes
    ----------
    judged, searched
        Over the many scenarios of the verdict, exactly, and the few of the search, on what polishes; (k,).
    cases
        Searched cases that this took.
    """

    judged: Array
    searched: Array
    cases: int

    @property
    def kept(self) -> NDArray[np.bool_]:
        """Which limits hold in the verdict."""
        return self.judged <= assessment.ROUNDING

    def agrees(self, safety: Array) -> bool:
        """Whether all limits hold, and those bind in the verdict that bound the search with its safety margins."""
        bound = self.searched + safety > -_NEAR
        return bool(np.all(self.kept & ((self.judged > -_NEAR) | ~bound)))


def _excess(design: Designs, source: Source) -> _Excess:
    limits = [term for term in design.question.terms if term.limited]
    values, cases = assessment.exactly(design, limits)
    judged = [float(term.oriented(value)) for term, value in zip(limits, values, strict=True)]
    return _Excess(np.array(judged), assessment.excesses(design, source), cases)


def _polish(found: _Candidate) -> _Candidate:
    """The same on the exact solver, until many more scenarios say what the few of the search say.

    What is too costly for the optimiser it takes from the surrogate, shifted to what the exact solver says.
    """
    question, source = found.question, budget.affordable(found.asked)
    usual = budget.safety(question, _SAFETY) * question.inequality
    rounds = _ROUNDS if question.inputs else 0
    now, last, safety, spent = found, None, np.zeros(len(question.inequality)), 0
    for k in range(rounds + 1):
        excess = _excess(now.design, source)
        spent += excess.cases
        if last is not None and _lost(last, now):
            break
        last = now if np.all(excess.kept) else last
        done = not now.best.feasible or excess.agrees(safety)
        if (k > 0 and done) or k == rounds or spent + excess.cases > budget.AFFORDABLE:
            break
        # what a few scenarios make of a limit differs from what many do: shift it by that
        safety = excess.judged - excess.searched + usual
        now = now.improved(source, safety)
    best = replace(now.best, feasible=False) if last is None else last.best
    moved = rounds > 0 and last is not found
    return replace(found, best=best, cases=spent, polish=budget.words(question, spent, moved))


def _lost(last: _Candidate, now: _Candidate) -> bool:
    """Whether the objective fell more than a polish costs: a search that went astray."""
    return now.best.objective < last.best.objective - _LOST * last.size(last.best.objective)


def _only(problem: Problem) -> Optimum:
    """The one design of a question without continuous variables."""
    objective, excess = (rows[0] for rows in problem.value(np.empty((1, 0))))
    return Optimum(np.empty(0), float(objective.min()), excess, bool(np.all(excess <= 0)))
