"""Times of the exact solver and of the surrogate on the same cases, measured on this machine."""

from collections.abc import Callable
from timeit import repeat, timeit

import numpy as np
import xarray as xr

from solver.names import ALL_PEAKS
from surrogate import GaussianProcess
from workflow.dataset import draws, factorial
from workflow.learning import training
from workflow.study.model import Study

#: Cases on which what is searched for over the body is timed, those of films with tables of their own, and of contacts
#: in space, seconds each.
_SEARCHED, _FILMS, _IN_SPACE = 200, 8, 3


def timing(study: Study, quantities: xr.Dataset, cases: xr.Dataset, model: GaussianProcess) -> dict[str, float]:
    """Return the seconds of an exact random case, of training and of a query; films include their tables."""
    points = {name: cases[name] for name in study.factors}
    X = np.stack([array.values for array in points.values()], -1)
    plain = study.model_copy(update={"dataset": study.dataset.model_copy(update={"peaks": False})})
    solved = points
    timed: Callable[[Callable[[], object]], float] = seconds
    if study.kind.space:
        solved, timed = {name: values[:_IN_SPACE] for name, values in points.items()}, _once
    elif study.kind.tabled:
        solved, timed = draws.points(study, _FILMS, (study.validation.seed, 6), together=1), _once
    times = {
        "queries": float(len(X)),
        "outputs": float(len(study.outputs)),
        "exact_per_scattered_case": timed(lambda: factorial.exact(plain, solved))
        / (len(next(iter(solved.values()))) * len(study.combinations)),
        "surrogate_fit": (_once if study.crossed else seconds)(lambda: training.fit(study, quantities)),
        "surrogate_mean_per_query": seconds(lambda: model.predict_array(X)) / len(X),
        "surrogate_mean_std_per_query": seconds(lambda: model.predict_array(X, return_std=True)) / len(X),
    }
    if study.dataset.peaks:
        first_points = {name: array[:_SEARCHED] for name, array in points.items()}
        times["exact_per_searched_case"] = seconds(lambda: factorial.exact(study, first_points), 1) / (
            len(next(iter(first_points.values()))) * len(study.combinations)
        )
    return times


def by_quantity(study: Study, times: dict[str, float]) -> list[dict[str, float | str]]:
    """Return the times of an exact answer and of a surrogate's with its interval, and their ratio, for every output."""
    query = times["surrogate_mean_std_per_query"]
    rows: list[dict[str, float | str]] = []
    for name in study.outputs:  # one quantity costs as much as all of its kind
        exact = times["exact_per_searched_case" if name in ALL_PEAKS else "exact_per_scattered_case"]
        rows.append({"name": name, "exact": exact, "surrogate": query, "ratio": exact / query})
    return rows


def _once(action: Callable[[], object]) -> float:
    """Return the time of the first run, in which tables are made [s]."""
    return timeit(action, number=1)


def seconds(action: Callable[[], object], repeats: int = 3) -> float:
    """Return the least time of a few runs, after one that warms up [s]."""
    action()
    return min(repeat(action, number=1, repeat=repeats))
