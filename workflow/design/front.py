"""Pareto fronts of a question: traced on the surrogate, solved again exactly."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.search.optimise import Optimum, Problem
from surrogate.search.pareto import Front, front, non_dominated
from workflow.design import assessment, budget
from workflow.design.question import Question
from workflow.design.sources import Exact, Predicted

Array = NDArray[np.float64]

_SAFE = 1e-6  # relative distance kept from the limits, beside the surrogate's own doubt
_KEPT = 1e-9  # exact excess that counts as none: the optimiser's own accuracy


def trace(question: Question, source: Predicted, scan: int) -> Front | None:
    """The front on the surrogate, at a distance from the limits that its uncertainty asks for; None: not feasible."""
    problem = question.problem(source, _SAFE * question.room)
    if not question.inputs:
        return _point(problem, len(question.target.objectives))
    coarse = front(problem, len(question.target.objectives), points=3, fill=1, scan=scan)
    if coarse is None:
        return None
    doubt = (_SAFE + assessment.doubts(question, coarse.x[len(coarse.x) // 2], source)) * question.room
    return front(question.problem(source, doubt), len(question.target.objectives), scan=scan) or coarse


def _point(problem: Problem, objectives: int) -> Front | None:
    """The front of a question without continuous variables: its one design, if that keeps the limits."""
    x = np.empty((1, 0))
    rows, excess = problem.value(x)
    values = rows.reshape(1, objectives, -1).min(-1)
    return Front(x, values, values[0], np.ones(objectives)) if excess.max(initial=-np.inf) <= 0 else None


def measure(traced: Sequence[Front]) -> tuple[Array, Array]:
    """Least value of every objective over some fronts together, and its range: what a compromise is measured by."""
    values = np.concatenate([one.values for one in traced])
    values = values[non_dominated(values)]
    span = np.ptp(values, axis=0)
    return values.min(0), np.where(span > 0, span, 1.0)


def best_of(traced: Front, problem: Problem) -> Optimum:
    """The design of a front that a scalarised problem rates highest."""
    objective, excess = problem.value(traced.x)
    best = int(objective.min(1).argmax())
    return Optimum(traced.x[best], float(objective[best].min()), excess[best], True)


def solved(question: Question, traced: Front, source: Predicted, exact: Exact, share: float = 1.0) -> xr.Dataset:
    """The front of one choice solved again exactly; what breaks a limit is left out.

    What is searched for, milliseconds a case, is solved in the scenarios that decide, for fewer designs if need be:
    ``share`` says how much of what a question can afford is for this choice.

    Returns
    -------
    xarray.Dataset
        Over ``front``: ``front_exact`` and ``front_predicted`` (with ``objective``), ``front_value`` (with ``factor``:
        the variables).
    """
    wanted = len(question.target.objectives)
    sets, near = question.searched, budget.spared(question, source, exact)
    x, some = budget.thinned(question, traced.x, source, share)
    factors = {drawn: question.factors(x, chosen) for drawn, chosen in sets.items()}
    found, guessed = (assessment.count(question, factors, sets, one) for one in (near, source))
    found = budget.corrected(question, x, found, some, source, exact)
    excess = np.stack(
        [t.oriented(found[:, k]) for k, t in enumerate(question.terms) if t.limited] or [np.zeros(len(found))]
    )
    kept = np.flatnonzero(excess.max(0) <= _KEPT)
    variables = question.physical(x[kept]) | {
        name: np.full(kept.size, value) for name, value in question.held.items() if name in question.target.variables
    }
    return xr.Dataset(
        {
            "front_exact": (("front", "objective"), found[kept, :wanted]),
            "front_predicted": (("front", "objective"), guessed[kept, :wanted]),
            "front_value": (("front", "factor"), np.stack(list(variables.values()), -1)),
        },
        coords={"objective": [term.label for term in question.terms[:wanted]], "factor": list(variables)},
    )


def together(parts: Mapping[str, xr.Dataset], signs: Array) -> xr.Dataset:
    """The front of all choices: what no design of any of them dominates, sorted by the first objective.

    Parameters
    ----------
    parts
        What `solved` gives, by the choice in words.
    signs
        1 for every objective that is maximised, -1 for every other one.

    Returns
    -------
    xarray.Dataset
        The same over all, with ``front_choice``.
    """
    whole = xr.concat(
        [part.assign(front_choice=("front", [name] * part.sizes["front"])) for name, part in parts.items()], "front"
    )
    found = whole["front_exact"].transpose("front", "objective").values
    kept = np.flatnonzero(non_dominated(found * signs))
    return whole.isel(front=kept[np.argsort(found[kept, 0])])
