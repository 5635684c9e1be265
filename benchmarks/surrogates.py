"""Surrogates side by side on the quickstart's box: error, time of a fit, time of a query, all in one run."""

import warnings
from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import qmc

from benchmarks.rivals import Rival, installed
from surrogate import GridGP, Input
from surrogate.use.baseline import chebyshev_interpolation
from workflow.dataset import factorial
from workflow.run.provenance import ROOT
from workflow.study.model import Study, load

Array = NDArray[np.float64]

#: Six closed-form quantities, the ones of the table in the documentation.
OUTPUTS = [
    "depth", "voltage", "magnetic_potential", "trailing_tension", "peak_pressure", "electric_edge_intensity_trailing",
]  # fmt: skip
#: Levels of volume fraction, friction, radius, load and charge.
GRIDS = [(12, 4, 5, 6, 2), (24, 8, 6, 8, 2), (36, 7, 10, 12, 2), (40, 10, 8, 10, 2), (16, 16, 16, 16, 16)]
HUGE = (40, 25, 25, 20, 20)
FRESH, QUERIES = 5000, 200_000


def measure(huge: bool = False) -> dict[str, Any]:
    """Rows of the comparison, the names of what is not installed here, and the ratios that the table is for."""
    study = load(ROOT / "config/quickstart.yaml")
    inputs = factorial.inputs(study)
    fresh = factorial.exact(study, _points(inputs, _uniform(len(inputs), FRESH, 17)))
    rows = []
    for counts in [*GRIDS, *([HUGE] if huge else [])]:
        data = _grid(study, inputs, counts)
        rows += _on_grid(data, inputs, counts, fresh)
        del data
    rivals, missing = installed()
    for rival in rivals:
        for size in rival.cases:
            rows.append(_scattered(rival, study, inputs, size, fresh))
            print(f"  {rival.name}, {size} cases: {rows[-1]['fit_seconds']:.1f} s", flush=True)
    return {"outputs": OUTPUTS, "fresh_cases": FRESH, "rows": rows, "left_out": missing, "ratios": ratios(rows)}


def ratios(rows: list[dict[str, Any]]) -> dict[str, float]:
    """How many times faster than scikit-learn on 1,024 cases the Gaussian process on 1,048,576 and 64,000 is."""
    found = {(row["method"], row["cases"]): row for row in rows}
    slow = found[("scikit-learn GP (RBF)", 1024)]
    million, good = (found[("Chebyshev-kernel GP", cases)] for cases in (16**5, 64_000))
    return {
        "fit of 1,048,576 cases over scikit-learn's of 1,024": slow["fit_seconds"] / million["fit_seconds"],
        "mean and interval of a query, 64,000 cases over scikit-learn's 1,024": slow["std_seconds"]
        / good["std_seconds"],
        "queries a second with interval, 64,000 cases": 1 / good["std_seconds"],
    }


def _on_grid(data: xr.Dataset, inputs: list[Input], counts: tuple[int, ...], fresh: xr.Dataset) -> list[dict[str, Any]]:
    points = {one.name: fresh[one.name] for one in inputs}
    cases = int(np.prod(counts))
    at = np.stack([one.from_unit(row) for one, row in zip(inputs, _uniform(len(inputs), QUERIES, 5), strict=True)], 1)
    model, fit = _best(lambda: GridGP(inputs=inputs).fit(data))
    rows = [
        {
            "method": "Chebyshev-kernel GP", "cases": cases, "levels": list(counts), "fit_seconds": fit,
            "error": _errors(model.predict(points, return_std=False), fresh),
            "mean_seconds": _best(lambda: model.predict_array(at))[1] / QUERIES,
            "std_seconds": _best(lambda: model.predict_array(at, return_std=True))[1] / QUERIES,
            "single_seconds": min(_best(lambda: model.predict_array(at[:1], return_std=True))[1] for _ in range(20)),
        }
    ]  # fmt: skip
    if cases > 2_000_000:
        return rows
    kronecker, fit = _best(lambda: GridGP("rbf", inputs).fit(data), 1)
    rows.append(
        {
            "method": "Kronecker RBF GP", "cases": cases, "levels": list(counts), "fit_seconds": fit,
            "error": _errors(kronecker.predict(points, return_std=False), fresh),
            "mean_seconds": _best(lambda: kronecker.predict_array(at[:20_000]))[1] / 20_000,
            "std_seconds": _best(lambda: kronecker.predict_array(at[:20_000], return_std=True))[1] / 20_000,
        }
    )  # fmt: skip
    table, seconds = _best(lambda: chebyshev_interpolation(data, inputs, points), 1)
    rows.append(
        {
            "method": "tensor Chebyshev interpolation", "cases": cases, "levels": list(counts), "fit_seconds": None,
            "error": _errors(table, fresh), "mean_seconds": seconds / FRESH, "std_seconds": None,
        }
    )  # fmt: skip
    return rows


def _scattered(rival: Rival, study: Study, inputs: list[Input], size: int, fresh: xr.Dataset) -> dict[str, Any]:
    t = 2 * qmc.Sobol(len(inputs), rng=0).random(size) - 1
    data = factorial.exact(study, _points(inputs, t.T))
    y = np.stack([data[output].values for output in OUTPUTS], axis=1)
    offset, scale = y.mean(axis=0), y.std(axis=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a bound met, a variance at zero: the rivals' own affair
        predict, seconds = _best(lambda: rival.fit(t, (y - offset) / scale), 1)
        at = np.stack([one.to_unit(fresh[one.name]) for one in inputs], axis=1)
        answer, query = _best(lambda: np.concatenate([np.asarray(predict(part)) for part in np.array_split(at, 5)]), 1)
    found = xr.Dataset({output: ("case", offset[k] + scale[k] * answer[:, k]) for k, output in enumerate(OUTPUTS)})
    return {
        "method": rival.name, "cases": size, "fit_seconds": seconds, "error": _errors(found, fresh),
        "mean_seconds": None if rival.has_std else query / FRESH,
        "std_seconds": query / FRESH if rival.has_std else None,
    }  # fmt: skip


def _grid(study: Study, inputs: list[Input], counts: tuple[int, ...]) -> xr.Dataset:
    """The complete factorial in memory: the solver gives views along what a quantity does not depend on."""
    axes = {one.name: one.levels(n) for one, n in zip(inputs, counts, strict=True)}
    data = factorial.exact(study, axes)[OUTPUTS]
    return data.map(lambda array: array.copy(data=np.ascontiguousarray(array.values)))


def _points(inputs: list[Input], t: Array) -> dict[str, xr.DataArray]:
    return {one.name: xr.DataArray(one.from_unit(row), dims="case") for one, row in zip(inputs, t, strict=True)}


def _uniform(inputs: int, count: int, seed: int) -> Array:
    return np.random.default_rng(seed).uniform(-1, 1, (inputs, count))


def _errors(found: Mapping[Any, Any] | xr.Dataset, fresh: xr.Dataset) -> dict[str, float]:
    """Largest error over range of every output."""
    return {
        name: float(np.abs(found[name].values - fresh[name].values).max() / np.ptp(fresh[name].values))
        for name in OUTPUTS
    }


def _best(action: Callable[[], Any], repeats: int = 3) -> tuple[Any, float]:
    """What an action gives, and the least of its times."""
    answer, times = None, []
    for _ in range(repeats):
        start = perf_counter()
        answer = action()
        times.append(perf_counter() - start)
    return answer, min(times)
