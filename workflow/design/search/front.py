"""Pareto fronts of a question: traced on the surrogate, solved again exactly."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate.search.optimise import Optimum, Problem
from surrogate.search.pareto import Front, front, non_dominated
from workflow.design.question import costly
from workflow.design.question.question import Question
from workflow.design.verdict import assessment

_SAFETY = 1e-6  # relative safety margin to the limits, beside the surrogate's own doubt
_KEPT = 1e-9  # exact excess that counts as none: the optimiser's own accuracy


def trace(question: Question) -> Front | None:
    """The front on the surrogate, with the safety margin that its uncertainty asks for; None: not feasible."""
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
    """The front of a question without continuous variables: its one design, if that keeps the limits."""
    x = np.empty((1, 0))
    rows, excess = problem.value(x)
    values = rows.reshape(1, objectives, -1).min(-1)
    return Front(x, values, values[0], np.ones(objectives)) if excess.max(initial=-np.inf) <= 0 else None


def normalisation(traced: Sequence[Front]) -> tuple[Array, Array]:
    """Least value of every objective over some fronts together, and its range: what a compromise is measured by."""
    values = np.concatenate([part.values for part in traced])
    values = values[non_dominated(values)]
    span = np.ptp(values, axis=0)
    return values.min(0), np.where(span > 0, span, 1.0)


def best_of(traced: Front, problem: Problem) -> Optimum:
    """The design of a front that a scalarised problem rates highest."""
    objective, excess = problem.value(traced.x)
    best = int(objective.min(1).argmax())
    return Optimum(traced.x[best], float(objective[best].min()), excess[best], True)


def verified(traced: Question, share: float = 1.0) -> xr.Dataset:
    """Return the front solved exactly, costly cases in deciding scenarios; designs beyond a limit are left out."""
    designs, columns = costly.thinned(traced, share)
    wanted, sets = designs.objectives, designs.searched
    exact, guessed = (designs.count(source, sets) for source in (costly.affordable(designs), designs.predicted))
    exact = costly.corrected(designs, exact, columns)
    excess = np.stack(
        [term.oriented(exact[:, k]) for k, term in enumerate(designs.terms) if term.limited] or [np.zeros(len(exact))]
    )
    feasible = np.flatnonzero(excess.max(0) <= _KEPT)
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
    """The front of all choices: what no design of any of them dominates, sorted by the first objective."""
    whole = xr.concat(
        [part.assign(front_choice=("front", [name] * part.sizes["front"])) for name, part in parts.items()], "front"
    )
    values = whole["front_exact"].transpose("front", "objective").values
    undominated = np.flatnonzero(non_dominated(values * signs))
    return whole.isel(front=undominated[np.argsort(values[undominated, 0])])
