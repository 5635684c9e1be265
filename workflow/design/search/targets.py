"""Design: the best factors under limits, found on the surrogate, polished and judged on the exact solver."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.names import ALL_QUANTITIES
from surrogate import GaussianProcess
from surrogate.search.optimise import Optimum, Problem, maximise
from surrogate.search.pareto import Front
from workflow.design.asking import budget
from workflow.design.asking.designs import Designs
from workflow.design.asking.question import Question, ask
from workflow.design.asking.sources import Exact, Predicted
from workflow.design.search import contact_fields, front, landscape, polish, tolerances
from workflow.design.search.candidate import Candidate
from workflow.design.verdict import assessment
from workflow.design.verdict.answer import Answer, Category, Choice, Tolerated
from workflow.design.verdict.netcdf import SOURCE, SOURCE_OF_FILMS
from workflow.design.verdict.variable import Role
from workflow.study.categories import output
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

Array = NDArray[np.float64]

_SCANNED, _SCANNED_FILMS = 1 << 17, 1 << 15  # most evaluations of the surrogate in one scan: 4 and 40 us each


def solve_target(study: Study, name: str, model: GaussianProcess) -> Answer:
    """Answer one design target of a study.

    Parameters
    ----------
    study, name
        The study and the name of its target.
    model
        Surrogate of the study's quantities.

    Raises
    ------
    InputError
        An objective that is constant, unbounded or undefined; an exact value outside the surrogate's interval, unless
        the target allows it.
    """
    return answer(study, name, study.design[name], model)


def answer(study: Study, name: str, target: Target, model: GaussianProcess) -> Answer:
    """Answer any target on the study's factors; see `solve_target`."""
    found = _found(study, name, target, model)
    several = len(target.objectives) > 1
    best = polish.first_feasible(sorted(found, key=lambda candidate: _rank(candidate.best), reverse=True))
    judged = assessment.judge(best.design)
    if judged.outside and not target.allow_outside_interval:
        raise InputError(f"design: {name}: {judged.outside}; allow_outside_interval: true would accept it")
    toleranced = target.tolerance and best.best.feasible and not several
    pictures = [landscape.landscape(best.design), contact_fields.fields(best.question.study, judged.case)]
    if any(candidate.front is not None for candidate in found):
        pictures.append(_front(found).reindex(factor=[variable.name for variable in judged.variables]))
    return replace(
        judged,
        target=name,
        polish=best.polish,
        source=SOURCE_OF_FILMS if study.on_film else SOURCE,
        tolerated=_costs(study, name, target, model, best) if toleranced else None,
        categories=_categories(target, best),
        choices=_choices(found, 1.0 if several else target.objectives[0].sign),
        pictures=xr.merge(pictures, compat="no_conflicts", join="outer"),
    )


def _found(study: Study, name: str, target: Target, model: GaussianProcess) -> list[Candidate]:
    """The best design of every choice."""
    return _search([_asked(study, name, target, model, choice) for choice in combinations(study, target)])


def _costs(study: Study, name: str, target: Target, model: GaussianProcess, best: Candidate) -> Tolerated:
    """What the tolerances of the best design cost."""
    nominal = tolerances.nominal(target)
    if budget.asked(best.question):  # near the design: a search of its own would cost as much as the design did
        without = tolerances.near(best, _asked(study, name, nominal, model, best.choice))
    else:
        others = _found(study, name, nominal, model)
        without = polish.first_feasible(sorted(others, key=lambda candidate: _rank(candidate.best), reverse=True))

    def asked(other: Target) -> Question:
        return replace(best.question, target=other)

    return tolerances.costs(best, without, asked)


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
) -> Candidate:
    categories = {key: str(choice[key]) for key in study.categories}
    held = {key: float(value) for key, value in choice.items() if key not in categories}
    wanted = [output(quantity, categories) for quantity in target.names() if quantity in ALL_QUANTITIES]
    own, predicted = study.narrowed(categories), Predicted(model.only(wanted) if wanted else model, categories)
    question = ask(own, name, target, predicted, held)
    return Candidate(choice, Designs(question, predicted, Exact(own), np.empty((0, len(question.inputs)))))


def _rank(best: Optimum) -> tuple[bool, float]:
    """Feasible before infeasible; then the objective, or the least violation."""
    return best.feasible, best.objective if best.feasible else -float(best.excess.max(initial=-np.inf))


def _search(asked: list[Candidate]) -> list[Candidate]:
    """Optimum of every choice on the surrogate, with the safety margin that its uncertainty asks for."""
    traced: list[Front | None] = [None] * len(asked)
    if asked[0].question.objectives > 1:
        traced = [front.trace(candidate.asked, _scan(candidate.question)) for candidate in asked]
    fronts = [own for own in traced if own is not None]
    scales = front.normalisation(fronts) if fronts else None
    return [_climbed(replace(one, front=own, normalisation=scales)) for one, own in zip(asked, traced, strict=True)]


def _scan(question: Question) -> int:
    """Points of a scan: a power of two, fewer where each stands for many scenarios."""
    size = sum(chosen.count for chosen in question.searched.values())
    most = _SCANNED_FILMS if question.study.on_film else _SCANNED
    return 1 << int(np.clip(np.log2(most / size), 7, 12))


def _climbed(candidate: Candidate) -> Candidate:
    question, predicted = candidate.question, candidate.asked.predicted
    problem = candidate.problem(predicted)
    if not question.inputs:
        return replace(candidate, best=_only(problem))
    if candidate.front is not None:
        first = replace(candidate, best=front.best_of(candidate.front, problem))
    else:
        first = replace(candidate, best=maximise(problem, scan=_scan(question)))
    return first.improved(predicted, assessment.doubts(first.design) * question.inequality)


def _front(found: list[Candidate]) -> xr.Dataset:
    """The exact front of all choices."""
    traced = [(candidate, candidate.asked.at(candidate.front.x)) for candidate in found if candidate.front]
    parts = {_words(candidate): front.verified(designs, 1 / len(traced)) for candidate, designs in traced}
    return front.merged(parts, np.array([objective.sign for objective in found[0].question.target.objectives]))


def _categories(target: Target, best: Candidate) -> tuple[Category, ...]:
    """The categories of a design."""
    return tuple(
        Category(name, kind, Role.VARIABLE if name in target.variables else Role.GIVEN)
        for name, kind in best.choice.items()
        if isinstance(kind, str)
    )


def _choices(found: list[Candidate], sign: float) -> tuple[Choice, ...]:
    """The best of every choice on the surrogate, where there are several."""
    several = found if len(found) > 1 else []
    return tuple(
        Choice(_words(candidate), float(sign * candidate.best.objective), bool(candidate.best.feasible))
        for candidate in several
    )


def _words(candidate: Candidate) -> str:
    """A choice in words: names as they are, numbers with theirs."""
    target = candidate.question.target
    return ", ".join(
        value if isinstance(value, str) else f"{key} = {value:g}"
        for key, value in candidate.choice.items()
        if key in target.variables
    )


def _only(problem: Problem) -> Optimum:
    """The one design of a question without continuous variables."""
    objective, excess = (rows[0] for rows in problem.value(np.empty((1, 0))))
    return Optimum(np.empty(0), float(objective.min()), excess, bool(np.all(excess <= 0)))
