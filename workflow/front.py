"""Pareto fronts of a question: traced on the surrogate, solved again exactly."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.optimise import Optimum, Problem
from surrogate.pareto import Front, front, non_dominated, scalarised
from workflow import costly, judgement
from workflow.question import Question
from workflow.sources import Exact, Predicted

Array = NDArray[np.float64]

_SAFE = 1e-6  # relative distance kept from the limits, beside the surrogate's own doubt
_KEPT = 1e-9  # exact excess that counts as none: the optimiser's own accuracy


def trace(question: Question, source: Predicted, scan: int) -> Front | None:
    """The front on the surrogate, at a distance from the limits that its uncertainty asks for; None: not feasible."""
    problem = question.problem(source, np.full(len(question.target.limits), _SAFE))
    found = front(problem, len(question.target.objectives), scan=scan)
    if found is None:
        return None
    middle = found.x[len(found.x) // 2]
    doubt = _SAFE + judgement.doubts(question, middle, source)
    return front(question.problem(source, doubt), len(question.target.objectives), scan=scan) or found


def compromise(problem: Problem, question: Question, traced: Front) -> Problem:
    """One objective for the recommended design: the least gain over the front's worst, in shares of its ranges."""
    return scalarised(problem, len(question.target.objectives), traced.reference, traced.weights)


def best_of(traced: Front, problem: Problem) -> Optimum:
    """The design of a front that a scalarised problem rates highest."""
    objective, excess = problem.value(traced.x)
    best = int(objective.min(1).argmax())
    return Optimum(traced.x[best], float(objective[best].min()), excess[best], True)


def solved(question: Question, traced: Front, source: Predicted, exact: Exact) -> xr.Dataset:
    """The front solved again exactly; what breaks a limit or is dominated there is left out.

    What is searched for, milliseconds a case, is solved in the scenarios that decide, for fewer designs if need be.

    Returns
    -------
    xarray.Dataset
        Over ``front``, sorted by the first objective: ``front_exact`` and ``front_predicted`` (with ``objective``),
        ``front_value`` (with ``factor``: the variables).
    """
    wanted = len(question.target.objectives)
    sets, near = question.searched, costly.spared(question, source, exact)
    x, some = costly.thinned(question, traced.x, source)
    factors = {drawn: question.factors(x, chosen) for drawn, chosen in sets.items()}
    found, guessed = (judgement.count(question, factors, sets, one) for one in (near, source))
    found = costly.corrected(question, x, found, some, source, exact)
    excess = np.stack(
        [t.oriented(found[:, k]) for k, t in enumerate(question.terms) if t.limited] or [np.zeros(len(found))]
    )
    signs = np.array([term.sign for term in question.terms[:wanted]])
    kept = np.flatnonzero(excess.max(0) <= _KEPT)
    kept = kept[non_dominated(found[kept, :wanted] * signs)]
    kept = kept[np.argsort(found[kept, 0])]
    variables = question.physical(x[kept])
    return xr.Dataset(
        {
            "front_exact": (("front", "objective"), found[kept, :wanted]),
            "front_predicted": (("front", "objective"), guessed[kept, :wanted]),
            "front_value": (("front", "factor"), np.stack(list(variables.values()), -1)),
        },
        coords={"objective": [term.label for term in question.terms[:wanted]], "factor": list(variables)},
    )
