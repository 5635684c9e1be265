"""Training and validation of the surrogate on exact cases, with both times side by side."""

from collections.abc import Callable
from time import perf_counter

import numpy as np
import xarray as xr

from solver.names import EVERY_QUANTITY
from surrogate import GaussianProcess, GridGP, metrics
from workflow import factorial
from workflow.study import Study


def fit(study: Study, quantities: xr.Dataset) -> GridGP:
    """Gaussian process of the study's outputs on its factorial."""
    model = GridGP(kernel=study.surrogate.kernel, inputs=factorial.inputs(study), outputs=study.outputs)
    return model.fit(quantities)


def validate(study: Study, quantities: xr.Dataset, cases: xr.Dataset, model: GaussianProcess) -> xr.Dataset:
    """Errors on random exact cases that the model never saw, beside plain tensor Chebyshev interpolation.

    Parameters
    ----------
    study, quantities, model
        The study, the factorial that the model was trained on, and the model.
    cases
        The sample for validation; neither the training nor the calibration has seen it.

    Returns
    -------
    xarray.Dataset
        ``exact``, ``predicted``, ``std`` over (output, case), the error table over ``output``, the factors over
        ``case``, and the tolerance that the study asks for.
    """
    points = {name: cases[name] for name in study.factors}
    predicted = model.predict(points)
    table = metrics.validate(model, cases, quantities)
    names = study.outputs
    stacked = {
        "exact": cases[names].to_dataarray("output"),
        "predicted": predicted[names].to_dataarray("output"),
        "std": predicted[[f"{name}_std" for name in names]].to_dataarray("output"),
    }
    out = table.assign({name: (("output", "case"), array.values) for name, array in stacked.items()})
    out = out.assign_coords({name: ("case", array.values, array.attrs) for name, array in points.items()})
    out = out.assign_coords(units=("output", [EVERY_QUANTITY[name].units for name in names]))
    return out.assign_attrs(tolerance=study.validation.tolerance)


def timing(study: Study, quantities: xr.Dataset, model: GaussianProcess) -> dict[str, float]:
    """Seconds, measured now on this machine: the exact solver and the surrogate on the same cases."""
    cases = factorial.sample(study, study.validation.cases, (study.validation.seed, 1))
    points = {name: cases[name] for name in study.factors}
    X = np.stack([array.values for array in points.values()], -1)
    one = {name: array[0] for name, array in points.items()}
    grid = dict(factorial.levels(study))
    count = X.shape[0]
    return {
        "cases": float(study.cases),
        "queries": float(count),
        "outputs": float(len(study.outputs)),
        "exact_per_factorial_case": _seconds(lambda: factorial.exact(study, grid)) / study.cases,
        "exact_per_scattered_case": _seconds(lambda: factorial.exact(study, points)) / count,
        "exact_single_case": _seconds(lambda: factorial.exact(study, one)),
        "surrogate_fit": _seconds(lambda: fit(study, quantities)),
        "surrogate_mean_per_query": _seconds(lambda: model.predict_array(X)) / count,
        "surrogate_mean_std_per_query": _seconds(lambda: model.predict_array(X, return_std=True)) / count,
        "surrogate_single_query": _seconds(lambda: model.predict_array(X[:1], return_std=True)),
    }


def _seconds(action: Callable[[], object], repeats: int = 3) -> float:
    """The least of a few runs, after one that warms up."""
    action()
    times = []
    for _ in range(repeats):
        start = perf_counter()
        action()
        times.append(perf_counter() - start)
    return min(times)
