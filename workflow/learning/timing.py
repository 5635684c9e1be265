"""Both times side by side: the exact solver and the surrogate on the same cases, measured now on this machine."""

from collections.abc import Callable
from time import perf_counter

import numpy as np
import xarray as xr

from solver.names import PEAKS
from surrogate import GaussianProcess
from workflow.dataset import factorial
from workflow.learning import training
from workflow.study.model import Study

#: Cases on which what is searched for over the body is timed.
_SEARCHED = 200


def timing(study: Study, quantities: xr.Dataset, cases: xr.Dataset, model: GaussianProcess) -> dict[str, float]:
    """Seconds.

    Parameters
    ----------
    study, quantities, model
        The study, the factorial that the model was trained on, and the model.
    cases
        Scattered cases over dimension ``case``, at which both are asked.

    Returns
    -------
    dict
        Counts (``cases``, ``queries``, ``outputs``), seconds a case or query (all closed-form quantities at once, all
        outputs at once), and, where the study has them, ``exact_per_searched_case`` of the largest stresses.
    """
    plain = study.model_copy(update={"dataset": study.dataset.model_copy(update={"peaks": False})})
    points = {name: cases[name] for name in study.factors}
    X = np.stack([array.values for array in points.values()], -1)
    one = {name: array[0] for name, array in points.items()}
    grid = dict(factorial.levels(study))
    count, combinations = X.shape[0], len(study.combinations)
    found = {
        "cases": float(study.cases),
        "queries": float(count),
        "outputs": float(len(study.outputs)),
        "exact_per_factorial_case": seconds(lambda: factorial.exact(plain, grid)) / study.cases,
        "exact_per_scattered_case": seconds(lambda: factorial.exact(plain, points)) / (count * combinations),
        "exact_single_case": seconds(lambda: factorial.exact(plain.narrowed(study.combinations[0]), one)),
        "surrogate_fit": seconds(lambda: training.fit(study, quantities)),
        "surrogate_mean_per_query": seconds(lambda: model.predict_array(X)) / count,
        "surrogate_mean_std_per_query": seconds(lambda: model.predict_array(X, return_std=True)) / count,
        "surrogate_single_query": seconds(lambda: model.predict_array(X[:1], return_std=True)),
    }
    if study.dataset.peaks:
        some = {name: array[:_SEARCHED] for name, array in points.items()}
        found["exact_per_searched_case"] = seconds(lambda: factorial.exact(study, some), 1) / (
            len(next(iter(some.values()))) * combinations
        )
    return found


def by_quantity(study: Study, times: dict[str, float]) -> list[dict[str, float | str]]:
    """What an exact answer and a surrogate's, with its interval, cost for every output, and their ratio.

    Asking for one quantity costs as much as asking for all of its kind: the closed-form ones come together, and so do
    those that are searched for over the body.
    """
    query = times["surrogate_mean_std_per_query"]
    rows: list[dict[str, float | str]] = []
    for name in study.outputs:
        exact = times["exact_per_searched_case" if name in PEAKS else "exact_per_scattered_case"]
        rows.append({"name": name, "exact": exact, "surrogate": query, "ratio": exact / query})
    return rows


def seconds(action: Callable[[], object], repeats: int = 3) -> float:
    """The least of a few runs, after one that warms up."""
    action()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        action()
        times.append(perf_counter() - start)
    return min(times)
