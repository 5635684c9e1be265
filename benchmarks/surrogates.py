"""Surrogates and the exact solver side by side on the quickstart's box: error, interval, time of a fit and of a query.

Everybody is treated alike. A fit is timed with all that it needs: scaling, transforms, and the calibration where there
is one, whose cases count as cases. Every time is the least of three after one that warms up; what takes long runs once.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from approximation.arrays import Array, blocks
from approximation.chebyshev import gauss_points
from approximation.sobol import sobol_points
from benchmarks import least, timed
from benchmarks.rivals import GRID_RIVALS, REACH, Predict, installed, standardised
from surrogate import GaussianProcess, GridGP, Input
from surrogate.data.inputs import unit_coordinates
from surrogate.use.validation import crps, validate
from workflow.dataset import factorial
from workflow.run.provenance import ROOT
from workflow.study.model import Study, load

#: Six closed-form quantities, the ones of the table in the documentation.
OUTPUTS = [
    "depth", "voltage", "magnetic_potential", "trailing_tension", "peak_pressure", "electric_edge_intensity_trailing",
]  # fmt: skip
#: Levels of volume fraction, friction, radius, load and charge; scattered methods get 1,024 and 4,096 cases too.
GRIDS = [
    (8, 4, 4, 4, 2), (16, 8, 4, 4, 2), (24, 8, 6, 8, 2), (36, 7, 10, 12, 2), (40, 10, 8, 10, 2), (16, 16, 16, 16, 16),
]  # fmt: skip
#: Above so many cases methods are left out that read the whole grid at every query, or search it at every fit.
LARGEST = 100_000
FRESH, CALIBRATION = 5000, 3000
#: Errors over range, of the worst output, for the table of equal accuracy.
ACCURACIES = (1e-1, 1e-2, 1e-4, 1e-6)
#: Seconds above which a measurement is not repeated, and points that a rival answers at once.
LONG, BLOCK = 5.0, 1000


@dataclass(frozen=True)
class Entry:
    """One method on one set of cases."""

    method: str
    cases: int
    fit: Callable[[], Any] | None  # Gives the model; None for the exact solver
    # From model, points (n, d) in physical units and whether a standard deviation is wanted to mean and, where there
    # is one, standard deviation, (n, outputs)
    ask: Callable[[Any, Array, bool], tuple[Array, Array | None]]
    # Coverage of the 95 % interval and CRPS over range of every output, by the model's own distribution; without, by
    # the normal one of mean and standard deviation
    judge: Callable[[Any], tuple[Array, Array]] | None = None


def measure() -> dict[str, Any]:
    """Rows of the comparison, at equal accuracy too, what is not installed here, and the ratios of the whole."""
    study = load(ROOT / "config/quickstart.yaml")
    inputs = factorial.inputs(study)
    fresh, held = (_cases(study, inputs, count, seed) for count, seed in ((FRESH, 17), (CALIBRATION, 5)))
    rows = [_row(_exact(study, inputs), inputs, fresh)]
    for counts in GRIDS:
        data = _grid(study, inputs, counts)
        for entry in [*_ours(data, inputs, counts, held, fresh), *_grid_rivals(data, inputs, counts)]:
            rows.append(_row(entry, inputs, fresh))
        del data
    rivals, missing = installed()
    for rival in rivals:
        for size in rival.cases:
            rows.append(_row(_scattered(rival.name, rival.fit, study, inputs, size), inputs, fresh))
    return {
        "outputs": OUTPUTS, "fresh_cases": FRESH, "rows": rows, "equal_accuracy": equal_accuracy(rows),
        "left_out": missing, "ratios": ratios(rows),
    }  # fmt: skip


def ratios(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Speed of the Gaussian process on 1,048,576 and 64,000 cases over that of scikit-learn on 1,024."""
    by_method = {(row["method"], row["cases"]): row for row in rows}
    slow = by_method[("scikit-learn GP (RBF)", 1024)]
    million, good = (by_method[("Chebyshev-kernel GP", cases)] for cases in (16**5, 64_000))
    return {
        "fit of 1,048,576 cases over scikit-learn's of 1,024": slow["fit_seconds"] / million["fit_seconds"],
        "mean and interval of a query, 64,000 cases over scikit-learn's 1,024": slow["std_seconds"]
        / good["std_seconds"],
        "queries a second with interval, 64,000 cases": 1 / good["std_seconds"],
        "one exact case alone over one query alone, mean and interval, 64,000 cases": rows[0]["single_seconds"]
        / good["single_seconds"],
    }


def equal_accuracy(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return, for every accuracy and method, the row of the fewest cases that reaches it in every output."""
    counts = []
    for accuracy in ACCURACIES:
        best: dict[str, dict[str, Any]] = {}
        for row in sorted(rows, key=lambda row: row["cases"]):
            if row["fit_seconds"] is not None and max(row["error"].values()) <= accuracy:
                best.setdefault(row["method"], row)
        counts += [{"accuracy": accuracy, **row} for row in sorted(best.values(), key=lambda row: row["fit_seconds"])]
    return counts


def _exact(study: Study, inputs: list[Input]) -> Entry:
    def ask(_: None, X: Array, with_std: bool) -> tuple[Array, None]:
        points = {axis.name: xr.DataArray(column, dims="case") for axis, column in zip(inputs, X.T, strict=True)}
        return _stacked(factorial.exact(study, points)), None

    return Entry("exact solver", 0, None, ask)


def _ours(
    data: xr.Dataset, inputs: list[Input], counts: tuple[int, ...], held: xr.Dataset, fresh: xr.Dataset
) -> list[Entry]:
    def ask(model: GaussianProcess, X: Array, with_std: bool) -> tuple[Array, Array | None]:
        return model.predict_array(X, return_std=True) if with_std else (model.predict_array(X), None)

    def judge(model: GaussianProcess) -> tuple[Array, Array]:
        table = validate(model, fresh, None)
        return table["coverage"].values, table["crps"].values

    cases = int(np.prod(counts))
    return [
        Entry("Chebyshev-kernel GP", cases, lambda: GridGP(inputs=inputs).fit(data), ask, judge),
        Entry(
            "Chebyshev-kernel GP, calibrated", cases + CALIBRATION,
            lambda: GridGP(inputs=inputs).fit(data).calibrate(held), ask, judge,
        ),
    ]  # fmt: skip


def _grid_rivals(data: xr.Dataset, inputs: list[Input], counts: tuple[int, ...]) -> list[Entry]:
    cases, levels = int(np.prod(counts)), [gauss_points(count) for count in counts]
    if cases > LARGEST:
        return []
    # the data in one array are what these methods are given, as a data set is what ours are
    values = np.stack(
        [data[name].broadcast_like(data).transpose(*(i.name for i in inputs)).values for name in OUTPUTS], -1
    )
    return [
        Entry(name, cases, lambda fit=fit: standardised(values, lambda y: fit(levels, y)), _asker(inputs))  # type: ignore[misc]  # bound now
        for name, fit in GRID_RIVALS.items()
    ]


def _scattered(
    name: str, fit: Callable[[Array, Array], Predict], study: Study, inputs: list[Input], size: int
) -> Entry:
    t = 2 * sobol_points(size, len(inputs)) - 1
    values = _stacked(factorial.exact(study, _points(inputs, t.T)))
    return Entry(name, size, lambda: standardised(values, lambda y: fit(t, y)), _asker(inputs))


def _asker(inputs: list[Input]) -> Callable[[Predict, Array, bool], tuple[Array, Array | None]]:
    def ask(predict: Predict, X: Array, with_std: bool) -> tuple[Array, Array | None]:
        t = unit_coordinates(inputs, X).T
        parts = [predict(t[block], with_std) for block in blocks(len(t), BLOCK)]
        stds = [std for _, std in parts if std is not None]
        return np.concatenate([mean for mean, _ in parts]), np.concatenate(stds) if stds else None

    return ask


def _row(entry: Entry, inputs: list[Input], fresh: xr.Dataset) -> dict[str, Any]:
    X, truth = np.stack([fresh[input_.name].values for input_ in inputs], axis=1), _stacked(fresh)
    over = np.ptp(truth, axis=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a bound met, a variance at zero: the rivals' own affair
        model, fit = _best(entry.fit) if entry.fit else (None, None)
        mean, std = entry.ask(model, X, True)
        seconds = {"mean_seconds": _best(lambda: entry.ask(model, X, False))[1] / len(X), "std_seconds": None}
        if std is not None:
            seconds["std_seconds"] = _best(lambda: entry.ask(model, X, True))[1] / len(X)
        single = min(_best(lambda: entry.ask(model, X[:1], True))[1] for _ in range(10))
    error = np.abs(mean - truth).max(axis=0) / over
    row = {
        "method": entry.method, "cases": entry.cases, "fit_seconds": fit, **seconds, "single_seconds": single,
        "error": _by_output(error), "coverage": None, "crps": None,
    }  # fmt: skip
    if std is not None:
        scores = np.abs(mean - truth) <= REACH * std, crps(truth, mean, std) / over
        coverage, score = entry.judge(model) if entry.judge else (scores[0].mean(axis=0), scores[1].mean(axis=0))
        row |= {"coverage": _by_output(coverage), "crps": _by_output(score)}
    print(f"  {summary(row)}", flush=True)
    return row


def summary(row: dict[str, Any]) -> str:
    """A row of the comparison as a line: worst output of each measure, times in seconds and microseconds."""
    queries = [("a query's mean", "mean_seconds"), ("with interval", "std_seconds"), ("one alone", "single_seconds")]
    parts = [] if row["fit_seconds"] is None else [f"fit {row['fit_seconds']:.3g} s"]
    parts += [f"{what} {1e6 * row[key]:.3g} us" for what, key in queries if row[key] is not None]
    parts.append(f"largest error {max(row['error'].values()):.2g}")
    if row["coverage"] is not None:
        parts.append(f"coverage {min(row['coverage'].values()):.3f} to {max(row['coverage'].values()):.3f}")
        parts.append(f"CRPS {max(row['crps'].values()):.2g}")
    return f"{row['method']}, {row['cases']} cases: {', '.join(parts)}"


def _grid(study: Study, inputs: list[Input], counts: tuple[int, ...]) -> xr.Dataset:
    """The complete factorial in memory: the solver gives views along what a quantity does not depend on."""
    axes = {axis.name: axis.levels(n) for axis, n in zip(inputs, counts, strict=True)}
    data = factorial.exact(study, axes)[OUTPUTS]
    return data.map(lambda array: array.copy(data=np.ascontiguousarray(array.values)))


def _cases(study: Study, inputs: list[Input], count: int, seed: int) -> xr.Dataset:
    """Return inputs, uniform in the scaled coordinates, and exact outputs over ``case``."""
    points = _points(inputs, np.random.default_rng(seed).uniform(-1, 1, (len(inputs), count)))
    return factorial.exact(study, points)[OUTPUTS].reset_coords(drop=True).assign(points)


def _points(inputs: list[Input], t: Array) -> dict[str, xr.DataArray]:
    return {axis.name: xr.DataArray(axis.from_unit(row), dims="case") for axis, row in zip(inputs, t, strict=True)}


def _stacked(data: xr.Dataset) -> Array:
    return np.stack([data[name].values for name in OUTPUTS], axis=-1)


def _by_output(values: Array) -> dict[str, float]:
    return dict(zip(OUTPUTS, values.tolist(), strict=True))


def _best(action: Callable[[], Any]) -> tuple[Any, float]:
    """Return an action's result and its cost: the least of three after a warm-up, or the first if it takes long."""
    answer, cost = timed(action)
    return answer, cost.seconds if cost.seconds > LONG else least(action).seconds
