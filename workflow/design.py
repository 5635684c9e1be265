"""Design: the best factors under limits, found on the surrogate, polished and judged on the exact solver."""

from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate import GaussianProcess
from surrogate.optimise import Optimum, improve, maximise
from workflow import judgement, landscape
from workflow.inputs import InputError
from workflow.question import Question, ask
from workflow.sources import Exact, Predicted
from workflow.study import Study
from workflow.target import Target

Array = NDArray[np.float64]

_ROUNDS = 6  # polishes, each with limits tightened by what many more scenarios found beyond them
_AWAY = 1e-10  # relative distance kept from a limit, beyond rounding
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
    found = [_search(ask(study, name, target, source, chosen), source, exact) for chosen in choices(target)]
    question, best = max(found, key=lambda pair: _rank(pair[1]))
    out = xr.merge(
        [judgement.judge(question, best.x, source, exact), landscape.landscape(question, best.x, source)],
        compat="no_conflicts",
    )
    if not bool(out["inside"].all()) and not target.allow_outside_interval:
        raise InputError(f"design: {name}: {judgement.outside(out)}; allow_outside_interval: true would accept it")
    objective = target.objectives[0]
    out.attrs = {
        "title": f"design target {name}",
        "goal": f"{'maximise' if objective.maximise else 'minimise'} {objective}",
        "objective": str(objective),
        "statistic": str(target.statistic),
    }
    return out.assign_coords(target=name)


def choices(target: Target) -> list[dict[str, float]]:
    """Every combination of the values that variables with a list may take."""
    lists = {name: one.choices for name, one in target.variables.items() if one.choices}
    return [dict(zip(lists, values, strict=True)) for values in product(*lists.values())]


def _rank(best: Optimum) -> tuple[bool, float]:
    """Feasible before infeasible; then the objective, or the least violation."""
    return best.feasible, best.objective if best.feasible else -float(best.excess.max(initial=-np.inf))


def _search(question: Question, source: Predicted, exact: Exact) -> tuple[Question, Optimum]:
    """Optimum on the surrogate, then on the exact solver until many more scenarios find no excess."""
    if not question.inputs:
        return question, _only(question, exact)
    size = sum(one.count for one in question.searched.values())
    scan = 1 << int(np.clip(np.log2(_SCANNED / size), 7, 12))
    first = maximise(question.problem(source), scan=scan)
    scale = abs(first.objective) or 1.0
    # the surrogate may be wrong by this much, so the limits keep that distance from it
    doubt = judgement.doubts(question, first.x, source)
    best = improve(question.problem(source, doubt), first.x, scale)
    slack = np.full(len(question.target.limits), _AWAY)
    for _ in range(_ROUNDS):
        best = improve(question.problem(exact, slack), best.x, scale)
        excess = judgement.excesses(question, best.x, exact)
        if not best.feasible or np.all(excess <= 0):
            break
        slack += np.where(excess > 0, 1.02 * excess + 1e-12, 0.0)
    return question, best


def _only(question: Question, exact: Exact) -> Optimum:
    """The one design of a question without continuous variables."""
    objective, excess = (one[0] for one in question.problem(exact).value(np.empty((1, 0))))
    return Optimum(np.empty(0), float(objective.min()), excess, bool(np.all(excess <= 0)))
