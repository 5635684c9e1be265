"""Answers to design targets: searched on the surrogate, polished and judged exactly; the cost of tolerances."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from approximation.arrays import Array
from solver.names import ALL_QUANTITIES
from surrogate import GaussianProcess
from surrogate.search.optimise import Optimum, Problem, improve
from surrogate.search.pareto import Front, front, non_dominated
from workflow.design.question import costly
from workflow.design.question.pilot import ask
from workflow.design.question.question import Question
from workflow.design.question.sources import Exact, Predicted
from workflow.design.search import contact_fields, polish
from workflow.design.search.polish import Candidate
from workflow.design.verdict import assessment, leftout
from workflow.design.verdict.answer import ROUNDING, Answer, Category, Choice, Role, Tolerated
from workflow.design.verdict.netcdf import SOURCE, SOURCE_OF_FILMS
from workflow.language.factors import FACTORS
from workflow.study.categories import output
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

_SAFETY = 1e-6  # relative safety margin to the limits, beside the surrogate's intervals
_KEPT = 1e-9  # exact excess that counts as none: the optimiser's accuracy
_TIGHTER = 0.5  # share of a tolerance that is left when it is tightened in words
_MAP, _COARSE, _COARSEST = 81, 41, 17  # points a side of the map; fewer where every point has many draws
_MANY = 128  # scenarios a point from which the map is coarse
_SLICE = 121  # points of a slice


def trace(question: Question) -> Front | None:
    """Return the front on the surrogate, with safety margins of its uncertainty; None if no design is feasible."""
    problem = question.problem(question.predicted, _SAFETY * question.inequality)
    if not question.inputs:
        return _point(problem, question.objectives)
    coarse = front(problem, question.objectives, points=3, fill=1, scan=question.scan)
    if coarse is None:
        return None
    doubt = assessment.doubts(question.at(coarse.x[len(coarse.x) // 2]))
    problem = question.problem(question.predicted, (_SAFETY + doubt) * question.inequality)
    return front(problem, question.objectives, scan=question.scan) or coarse


def _point(problem: Problem, objectives: int) -> Front | None:
    """Return the front of a question without continuous variables: its one design, if that is feasible."""
    x = np.empty((1, 0))
    rows, excess = problem.value(x)
    values = rows.reshape(1, objectives, -1).min(-1)
    return Front(x, values, values[0], np.ones(objectives)) if excess.max(initial=-np.inf) <= 0 else None


def normalisation(traced: Sequence[Front]) -> tuple[Array, Array]:
    """Return least value and range of every objective over some fronts, by which a compromise is measured."""
    values = np.concatenate([part.values for part in traced])
    values = values[non_dominated(values)]
    span = np.ptp(values, axis=0)
    return values.min(0), np.where(span > 0, span, 1.0)


def best_of(traced: Front, problem: Problem) -> Optimum:
    """Return the design of a front that a scalarised problem rates highest."""
    objective, excess = problem.value(traced.x)
    best = int(objective.min(1).argmax())
    return Optimum(traced.x[best], float(objective[best].min()), excess[best], True)


def verified(traced: Question, share: float) -> xr.Dataset:
    """Return the front solved exactly, costly cases in deciding scenarios; designs beyond a limit are left out."""
    designs, columns = costly.thinned(traced, share)
    wanted, sets = designs.objectives, designs.searched
    exact, guessed = (designs.count(source, sets) for source in (costly.affordable(designs), designs.predicted))
    exact = costly.corrected(designs, exact, columns)
    feasible = np.flatnonzero(designs.excess(exact).max(1, initial=-np.inf) <= _KEPT)
    variables = designs.at(designs.x[feasible]).variables | {
        name: np.full(feasible.size, value) for name, value in designs.held.items() if name in designs.target.variables
    }
    return xr.Dataset(
        {
            "front_exact": (("front", "objective"), exact[feasible, :wanted]),
            "front_predicted": (("front", "objective"), guessed[feasible, :wanted]),
            "front_value": (("front", "factor"), np.stack(list(variables.values()), -1)),
        },
        coords={"objective": [term.label for term in designs.terms[:wanted]], "factor": list(variables)},
    )


def merged(parts: Mapping[str, xr.Dataset], signs: Array) -> xr.Dataset:
    """Return the front of all choices: the non-dominated designs, sorted by the first objective."""
    whole = xr.concat(
        [part.assign(front_choice=("front", [name] * part.sizes["front"])) for name, part in parts.items()], "front"
    )
    values = whole["front_exact"].transpose("front", "objective").values
    undominated = np.flatnonzero(non_dominated(values * signs))
    return whole.isel(front=undominated[np.argsort(values[undominated, 0])])


def solve_target(study: Study, name: str, model: GaussianProcess) -> Answer:
    """Answer one design target of a study, by name, with the surrogate of its quantities.

    InputError: the objective is unbounded or undefined, or an exact value left the surrogate's interval.
    """
    return answer(study, name, study.design[name], model)


def answer(study: Study, name: str, target: Target, model: GaussianProcess) -> Answer:
    """Answer any target on the study's factors; see `solve_target`."""
    several = len(target.objectives) > 1
    candidates = _candidates(study, name, target, model)
    best = polish.first_feasible(candidates)
    judged = assessment.judge(best.design)
    if judged.outside and not target.allow_outside_interval:
        raise InputError(f"design: {name}: {judged.outside}; allow_outside_interval: true would accept it")
    toleranced = target.tolerance and best.best.feasible and not several
    pictures = [map_and_slices(best.design), contact_fields.fields(best.question.study, judged.case)]
    if any(candidate.front is not None for candidate in candidates):
        pictures.append(_front(candidates).reindex(factor=[variable.name for variable in judged.variables]))
    return replace(
        judged,
        target=name,
        polish=best.polish,
        source=SOURCE_OF_FILMS if study.kind.tabled else SOURCE,
        tolerated=_costs(study, name, target, model, best) if toleranced else None,
        categories=_categories(target, best),
        choices=_choices(best, candidates, 1.0 if several else target.objectives[0].sign),
        pictures=xr.merge(pictures, compat="no_conflicts", join="outer"),
        left_out=_left_out(best.question.study, target, judged),
    )


def _left_out(study: Study, target: Target, judged: Answer) -> tuple[leftout.LeftOut, ...]:
    """Return the effects that the model leaves out: of signals at the smallest force, of stresses at the largest."""
    force = study.kind.loads.force
    case: dict[str, Any] = {**study.fixed, **judged.case}
    cases = [case | {force: end} for end in dict.fromkeys(target.ranges.get(force, (case[force],)))]
    smallest = next((figure.figure_high for figure in judged.figures if figure.figure == "smallest_force"), np.nan)
    band = judged.terms[0].spread
    return leftout.budget(*(leftout.of_study(study, case, smallest, band) for case in cases))


def _candidates(study: Study, name: str, target: Target, model: GaussianProcess) -> list[Candidate]:
    """Return the optimum of every choice on the surrogate, with safety margins of its uncertainty."""
    candidates = [_candidate(study, name, target, model, choice) for choice in combinations(study, target)]
    several = candidates[0].question.objectives > 1
    traced = [trace(candidate.question) if several else None for candidate in candidates]
    fronts = [traced_front for traced_front in traced if traced_front is not None]
    scales = normalisation(fronts) if fronts else None
    return [
        _climbed(replace(candidate, front=traced_front, normalisation=scales))
        for candidate, traced_front in zip(candidates, traced, strict=True)
    ]


def _costs(study: Study, name: str, target: Target, model: GaussianProcess, best: Candidate) -> Tolerated:
    """Return the cost of the tolerances of the best design against the one without tolerances."""
    nominal = target.model_copy(update={"tolerance": {}})
    if costly.asked(best.question):  # near the design: a search of its own would cost as much as the design did
        without = near(best, _candidate(study, name, nominal, model, best.choice))
    else:
        without = polish.first_feasible(_candidates(study, name, nominal, model))
    whole = _reached(best, target.tolerance)
    cost, gain = dict[str, float](), dict[str, float]()
    for key in target.tolerance:
        others = {other: reach for other, reach in target.tolerance.items() if other != key}
        cost[key] = _share(_reached(best, others), whole)
        gain[key] = _share(_reached(best, {**target.tolerance, key: _tightened(target, key)}), whole)
    design = without.design
    values = {key: float(column[0]) for key, column in design.variables.items()} | without.question.held
    exact, _ = assessment.exactly(design, design.terms[:1])
    categories = ", ".join(kind for kind in without.choice.values() if isinstance(kind, str))
    return Tolerated(cost, gain, values, float(exact[0]), categories)


def combinations(study: Study, target: Target) -> list[dict[str, float | str]]:
    """Return every combination of the values of variables with a list, and of the names of categories."""
    lists: dict[str, Sequence[float | str]] = {
        name: variable.choices for name, variable in target.variables.items() if variable.choices
    }
    for name, names in study.categories.items():
        if name not in lists:
            lists[name] = names if name in target.variables else [target.at[name]]
    return [dict(zip(lists, values, strict=True)) for values in product(*lists.values())]


def _candidate(
    study: Study, name: str, target: Target, model: GaussianProcess, choice: dict[str, float | str]
) -> Candidate:
    """Return a choice with its question, before any search."""
    categories = {key: str(choice[key]) for key in study.categories}
    held = {key: float(value) for key, value in choice.items() if key not in categories}
    wanted = [output(quantity, categories) for quantity in target.names() if quantity in ALL_QUANTITIES]
    narrowed, predicted = study.narrowed(categories), Predicted(model.only(wanted) if wanted else model, categories)
    return Candidate(choice, ask(narrowed, name, target, predicted, Exact(narrowed), held))


def _climbed(candidate: Candidate) -> Candidate:
    """Return a candidate with its optimum on the surrogate."""
    question, predicted = candidate.question, candidate.question.predicted
    if not question.inputs:  # one design, which is solved exactly
        only = candidate.counted(costly.affordable(question))
        return replace(only, best=replace(only.best, feasible=bool(np.all(only.best.excess <= ROUNDING))))
    if candidate.front is not None:
        first = replace(candidate, best=best_of(candidate.front, candidate.problem(predicted)))
    else:
        first = candidate.sought(predicted)
    safer = first.improved(predicted, assessment.doubts(first.design) * question.inequality)
    # where no design keeps the surrogate's uncertainty from the limits, the exact solver decides if cases are cheap
    solver_decides = first.best.feasible and not safer.best.feasible and not costly.asked(question)
    return first if solver_decides else safer


def _front(candidates: list[Candidate]) -> xr.Dataset:
    """Return the exact front of all choices."""
    traced = [(candidate, candidate.question.at(candidate.front.x)) for candidate in candidates if candidate.front]
    parts = {candidate.words: verified(designs, 1 / len(traced)) for candidate, designs in traced}
    return merged(parts, np.array([objective.sign for objective in candidates[0].question.target.objectives]))


def _categories(target: Target, best: Candidate) -> tuple[Category, ...]:
    """Return the categories of a design."""
    return tuple(
        Category(name, kind, Role.VARIABLE if name in target.variables else Role.GIVEN)
        for name, kind in best.choice.items()
        if isinstance(kind, str)
    )


def _choices(best: Candidate, candidates: list[Candidate], sign: float) -> tuple[Choice, ...]:
    """Return the best of every choice on the surrogate, where there are several."""
    several = candidates if len(candidates) > 1 else []
    passed = [candidate.choice for candidate in best.passed]
    return tuple(
        Choice(
            candidate.words,
            float(sign * candidate.best.objective),
            bool(candidate.best.feasible) and candidate.choice not in passed,
        )
        for candidate in several
    )


def _tightened(target: Target, name: str) -> str:
    absolute, share = target.tolerances[name]
    return f"{100 * _TIGHTER * share} %" if share else f"{_TIGHTER * absolute} {FACTORS[name].units}".removesuffix(" 1")


def near(best: Candidate, other: Candidate) -> Candidate:
    """Return the best design of another question with the same variables near a design, on the surrogate."""
    physical = best.design.variables
    inputs = other.question.inputs
    start = np.array([float(axis.to_unit(physical[name])[0]) for name, axis in inputs.items()])
    problem = other.question.problem(best.question.predicted)
    return replace(other, best=improve(problem, np.clip(start, -1, 1), best.size(best.best.objective)))


def _reached(best: Candidate, tolerance: Mapping[str, float | str]) -> float:
    """Return the goal near a design under other tolerances, on the surrogate."""
    target = best.question.target.model_copy(update={"tolerance": tolerance})
    nearby = near(best, replace(best, question=replace(best.question, target=target))).best
    return nearby.objective if nearby.feasible else np.nan


def _share(other: float, whole: float) -> float:
    return max((other - whole) / abs(whole), 0.0) if np.isfinite(other) else np.nan


def map_and_slices(design: Question) -> xr.Dataset:
    """Return map and slices of the first objective on the surrogate, through one design."""
    return xr.merge([_map(design), _slices(design)])


def _points(question: Question, fine: int, coarse: int, coarsest: int) -> int:
    """Return the points a side: fewer where each has many scenarios, and fewest on films."""
    if sum(chosen.count for chosen in question.searched.values()) < _MANY:
        return fine
    return coarsest if question.study.kind.tabled else coarse


def _map(design: Question) -> xr.Dataset:
    names = list(design.inputs)[:2]
    if len(names) < 2:
        return xr.Dataset()
    count = _points(design, _MAP, _COARSE, _COARSEST)
    side = np.linspace(-1.0, 1.0, count)
    points = np.tile(design.x, (count * count, 1))
    points[:, 0], points[:, 1] = (grid.ravel() for grid in np.meshgrid(side, side, indexing="ij"))
    objective, excess = _counted(design.at(points))
    coords: dict[str, Any] = {
        f"map_{axis}": (f"map_{axis}", design.inputs[name].from_unit(side), {"factor": name})
        for axis, name in zip("xy", names, strict=True)
    }
    maps = {"map_objective": objective, "map_excess": excess}
    return xr.Dataset(
        {name: (("map_x", "map_y"), values.reshape(count, count)) for name, values in maps.items()}, coords=coords
    )


def _slices(design: Question) -> xr.Dataset:
    steps = _points(design, _SLICE, _SLICE, _COARSE)
    side = np.linspace(-1.0, 1.0, steps)
    corner, first = design.searched[False], design.terms[0]
    parts = []
    for column, (name, axis) in enumerate(design.inputs.items()):
        points = np.tile(design.x, (steps, 1))
        points[:, column] = side
        along = design.at(points)
        objective, excess = _counted(along)
        values = along.value(design.predicted, corner, first).reshape(steps, -1)
        columns = {
            "slice_value": axis.from_unit(side),
            "slice_objective": objective,
            "slice_excess": excess,
            "slice_low": values.min(1),
            "slice_high": values.max(1),
        }
        parts.append(xr.Dataset({key: ("step", array) for key, array in columns.items()}).assign_coords(slice=name))
    return xr.concat(parts, "slice") if parts else xr.Dataset()


def _counted(designs: Question) -> tuple[Array, Array]:
    """Return the first objective by its risk measure, and the largest excess, of every design."""
    objective, excess = designs.problem(designs.predicted).value(designs.x)
    count = objective.shape[1] // designs.objectives
    return designs.terms[0].sign * objective[:, :count].min(1), excess.max(1, initial=-np.inf)
