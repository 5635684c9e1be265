"""Both times side by side: the exact solver and the surrogate on the same cases, measured now on this machine."""

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
import xarray as xr

from solver.names import ALL_PEAKS
from surrogate import GaussianProcess
from workflow.dataset import draws, factorial
from workflow.learning import training
from workflow.study.model import Study
from workflow.study.refusals import REFUSAL

#: Cases on which what is searched for over the body is timed, and those of films with tables of their own.
_SEARCHED, _FILMS = 200, 8
_IN_SPACE = 3  # cases of contacts in space that are timed: seconds each, and no two share more than the kernel


def timing(study: Study, quantities: xr.Dataset, cases: xr.Dataset, model: GaussianProcess) -> dict[str, float]:
    """Seconds."""
    with_holes = REFUSAL in quantities or REFUSAL in cases
    cases = training.answered(study, cases, model)[1]
    plain = study.model_copy(update={"dataset": study.dataset.model_copy(update={"peaks": False})})
    points = {name: cases[name] for name in study.factors}
    X = np.stack([array.values for array in points.values()], -1)
    count = X.shape[0]
    exact = _in_space if study.kind.space else _films if study.kind.tabled else _half_planes
    times = {
        "cases": float(study.cases),
        "queries": float(count),
        "outputs": float(len(study.outputs)),
        **exact(plain, points, with_holes),
        "surrogate_fit": (_once if study.crossed else seconds)(lambda: training.fit(study, quantities)),
        "surrogate_mean_per_query": seconds(lambda: model.predict_array(X)) / count,
        "surrogate_mean_std_per_query": seconds(lambda: model.predict_array(X, return_std=True)) / count,
        "surrogate_single_query": seconds(lambda: model.predict_array(X[:1], return_std=True)),
    }
    if study.dataset.peaks:
        first_points = {name: array[:_SEARCHED] for name, array in points.items()}
        times["exact_per_searched_case"] = seconds(lambda: factorial.exact(study, first_points), 1) / (
            len(next(iter(first_points.values()))) * len(study.combinations)
        )
    return times


def _half_planes(study: Study, points: dict[str, xr.DataArray], with_holes: bool) -> dict[str, float]:
    """Exact half-plane cases over ``case``, of the factorial or at points if it has holes, and one case alone."""
    first = {name: array[0] for name, array in points.items()}
    count = len(next(iter(points.values()))) * len(study.combinations)
    scattered = seconds(lambda: factorial.exact(study, points)) / count
    return {
        "exact_per_factorial_case": scattered
        if with_holes
        else seconds(lambda: factorial.exact(study, factorial.levels(study))) / study.cases,
        "exact_per_scattered_case": scattered,
        "exact_single_case": seconds(lambda: factorial.exact(study.narrowed(study.combinations[0]), first)),
    }


def _films(study: Study, points: dict[str, xr.DataArray], with_holes: bool) -> dict[str, float]:
    """The same of films, each at tables that nobody has made before: that of the factorial at one place of these.

    Where the solver refuses some cases, at points that it is known to answer.
    """
    if with_holes:
        new = {name: values[:: max(1, values.size // (_FILMS + 2))][: _FILMS + 2] for name, values in points.items()}
    else:
        new = draws.points(study, _FILMS + 2, (study.validation.seed, 6), together=1)
    levels_of = {name: levels for name, levels in factorial.levels(study).items() if name not in study.tabled}
    block: dict[str, Any] = {name: new[name][0] if name in study.tabled else levels_of[name] for name in study.axes}
    if study.groups:
        block = {name: np.atleast_1d(values) for name, values in block.items()}
    scattered = {name: values[1:-1] for name, values in new.items()}
    combinations = len(study.combinations)
    cases = combinations * np.prod([levels.size for levels in levels_of.values()])
    single = study.narrowed(study.combinations[0])
    return {
        "exact_per_factorial_case": _once(lambda: factorial.exact(study, block, holes=np.inf)) / cases,
        "exact_per_scattered_case": _once(lambda: factorial.exact(study, scattered)) / (_FILMS * combinations),
        "exact_single_case": _once(lambda: factorial.exact(single, {name: levels[-1] for name, levels in new.items()})),
    }


def _in_space(study: Study, points: dict[str, xr.DataArray], _with_holes: bool) -> dict[str, float]:
    """The same of contacts in space, which are solved one by one."""
    few = {name: values[:_IN_SPACE] for name, values in points.items()}
    count = len(next(iter(few.values()))) * len(study.combinations)
    alone = _once(lambda: factorial.exact(study, few)) / count
    return dict.fromkeys(("exact_per_factorial_case", "exact_per_scattered_case", "exact_single_case"), alone)


def by_quantity(study: Study, times: dict[str, float]) -> list[dict[str, float | str]]:
    """Return the time of an exact answer and of a surrogate's, with its interval, for every output, and their ratio.

    Asking for one quantity costs as much as asking for all of its kind: the closed-form ones come together, and so do
    those that are searched for over the body.
    """
    query = times["surrogate_mean_std_per_query"]
    rows: list[dict[str, float | str]] = []
    for name in study.outputs:
        exact = times["exact_per_searched_case" if name in ALL_PEAKS else "exact_per_scattered_case"]
        rows.append({"name": name, "exact": exact, "surrogate": query, "ratio": exact / query})
    return rows


def _once(action: Callable[[], object]) -> float:
    """The first run, in which tables are made."""
    start = perf_counter()
    action()
    return perf_counter() - start


def seconds(action: Callable[[], object], repeats: int = 3) -> float:
    """The least time of a few runs, after one that warms up [s]."""
    action()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        action()
        times.append(perf_counter() - start)
    return min(times)
