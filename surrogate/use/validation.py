"""Validation of a surrogate on held-out cases: errors, intervals and a baseline."""

from collections.abc import Mapping, Sequence
from functools import reduce
from itertools import combinations
from typing import Any

import numpy as np
import xarray as xr
from sklearn.metrics import r2_score

from approximation import chebyshev
from approximation.arrays import Array, Flags, blocks
from surrogate.data.factorial import complete_factorial
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.points import named_points
from surrogate.face.model import GaussianProcess
from surrogate.intervals.distribution import NOMINAL, Distribution, Normal
from surrogate.transforms.groups import Scales
from surrogate.transforms.transformed import groups_of

DECILES = 10
LEVELS = (0.5, 0.8, 0.9, NOMINAL, 0.99)  # levels whose intervals are judged
DRAWS = 5  # draws of ideal intervals that are averaged
CORNER_CASES = 20  # fewest cases of a corner whose coverage counts
# Quantities that are reported without the calibration too.
_COMPARED = ("coverage", "level_coverage", "worst_decile_coverage", "worst_corner_coverage", "crps", "pit",
             "pit_distance")  # fmt: skip
_MEANINGS = {
    "range": "range of the truth",
    "max_error": "largest error over range",
    "rmse": "root-mean-square error over range",
    "r2": "coefficient of determination",
    "coverage": f"coverage of the {100 * NOMINAL:g} % interval",
    "level_coverage": "coverage of the interval of a level",
    "crps": "mean continuous ranked probability score over range",
    "decile_coverage": "coverage in a decile of an input",
    "worst_decile_coverage": "coverage in the worst decile of any input",
    "worst_corner_coverage": "coverage in the worst corner of any two inputs",
    "pit": "probability integral transform",
    "pit_distance": "largest distance of the probability integral transform's distribution from uniform",
    "error": "signed error over range",
    "baseline_max_error": "largest error of tensor Chebyshev interpolation over range",
    "baseline_rmse": "root-mean-square error of tensor Chebyshev interpolation over range",
}
ELEMENTS = 2**22  # of the largest intermediate array


def validate(model: GaussianProcess, cases: xr.Dataset, training: xr.Dataset | None) -> xr.Dataset:
    """Return errors and coverage of a model on held-out cases and, with training data, errors of the baseline."""
    points, truth = model.cases(cases)
    named, names = named_points(points, model.inputs_), list(model.outputs_)
    true = named.stacked(truth, names)
    if not np.isfinite(true).all():
        raise ValueError(
            f"output {names[int(np.argmin(np.isfinite(true).all(axis=1)))]!r} is not finite in a held-out case"
        )
    mean, std = (part.T for part in model.predict_array(named.X, return_std=True))
    spread = np.ptp(true, axis=1)
    over = np.where(spread > 0, spread, 1.0)[:, None]
    error = (mean - true) / over
    held = np.stack([_inside(true, mean, std, model.distribution, level) for level in LEVELS], axis=1)
    inside = held[:, LEVELS.index(NOMINAL)]
    by_decile = np.stack([_by_decile(column, inside) for column in named.X.T], axis=1)
    transform = pit(true, mean, std, model.distribution)
    table: dict[str, Any] = {
        "range": ("output", spread),
        **_errors(error, ""),
        "r2": ("output", r2_score(true.T, mean.T, multioutput="raw_values")),
        "coverage": ("output", inside.mean(axis=1)),
        "level_coverage": (("output", "level"), held.mean(axis=2)),
        "crps": ("output", (crps(true, mean, std, model.distribution) / over).mean(axis=1)),
        "decile_coverage": (("output", "input", "decile"), by_decile),
        "worst_decile_coverage": ("output", by_decile.min(axis=(1, 2))),
        "worst_corner_coverage": ("output", worst_corner(unit_coordinates(model.inputs_, named.X), inside)),
        "pit": (("output", "case"), transform),
        "pit_distance": ("output", distance(transform)),
        "error": (("output", "case"), error),
    }
    if training is not None:
        table |= _errors((baseline(model, training, named.X) - true) / over, "baseline_")
    if model.calibration_ is not None:
        before = validate(model.uncalibrated(), cases, None)
        table |= {f"raw_{name}": before[name].variable for name in ("max_error", "rmse", *_COMPARED)}
    coords = {
        "output": names,
        "input": list(model.box),
        "decile": np.arange(1, DECILES + 1),
        "level": ("level", list(LEVELS), {"long_name": "nominal share of the cases that an interval holds"}),
    }
    result = xr.Dataset(table, coords=coords)
    for name, array in result.data_vars.items():
        array.attrs["long_name"] = _MEANINGS[str(name).removeprefix("raw_")]
    return result


def crps(true: Array, mean: Array, std: Array, distribution: Distribution | None = None) -> Array:
    """Return the continuous ranked probability score of truth, means and deviations, (p, n) each, in output units."""
    z = _standard(true, mean, std)
    finite = np.where(np.isfinite(z), z, 0.0)
    score = std * (distribution or Normal()).crps(finite)
    return np.asarray(np.where(std > 0, score, np.abs(true - mean)))  # without deviation, the absolute error


def pit(true: Array, mean: Array, std: Array, distribution: Distribution | None = None) -> Array:
    """Return the probability integral transform of truth, means and deviations, (p, n) each; ideally uniform."""
    return (distribution or Normal()).cdf(_standard(true, mean, std))


def _inside(true: Array, mean: Array, std: Array, distribution: Distribution, level: float) -> Flags:
    """Mark the cases whose interval of a level contains the truth, (p, n)."""
    lower, upper = distribution.ends(level)
    return np.asarray((mean + lower[:, None] * std <= true) & (true <= mean + upper[:, None] * std))


def _standard(true: Array, mean: Array, std: Array) -> Array:
    error = true - mean
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(error == 0, 0.0, error / std)


def worst_corner(t: Array, inside: Flags) -> Array:
    """Return the least share of cases inside, (p, n), of all corners of two scaled inputs t, (d, n): (p,)."""
    worst = np.full(len(inside), np.nan)
    for a, b in combinations(np.concatenate([t, -t]), 2):
        corner = (a > 0.8) & (b > 0.8)
        if np.count_nonzero(corner) >= CORNER_CASES:
            worst = np.fmin(worst, inside[:, corner].mean(axis=1))
    return worst


def ideal(model: Mapping[str, Input], cases: Mapping[str, xr.DataArray], outputs: int) -> dict[str, Any]:
    """Return the coverages that ideal intervals show on the cases: the least of many falls short by chance."""
    X = np.stack([np.asarray(cases[name].values, dtype=np.float64) for name in model], axis=1)
    t, random = unit_coordinates(tuple(model.values()), X), np.random.default_rng(0)
    worst = []
    for _ in range(DRAWS):
        u = random.uniform(size=(outputs, len(X)))
        inside, shares = u < NOMINAL, np.stack([(u < level).mean(axis=1) for level in LEVELS])
        deciles = min(float(_by_decile(column, inside).min()) for column in t)
        worst.append([deciles, float(worst_corner(t, inside).min()), *shares.min(axis=1), *shares.max(axis=1)])
    decile, corner, *ends = np.mean(worst, axis=0).tolist()
    low, high = ends[: len(LEVELS)], ends[len(LEVELS) :]
    return {"low": low, "high": high, "worst_decile_coverage": decile, "worst_corner_coverage": corner}


def distance(transform: Array) -> Array:
    """Return the largest distance of empirical distribution functions from the uniform one: (p, n) -> (p,)."""
    ordered, cases = np.sort(transform, axis=1), transform.shape[1]
    steps = np.arange(cases + 1) / cases
    return np.asarray(np.maximum(np.abs(ordered - steps[:-1]), np.abs(ordered - steps[1:])).max(axis=1))


def _errors(error: Array, prefix: str) -> dict[str, Any]:
    return {
        f"{prefix}max_error": ("output", np.abs(error).max(axis=1)),
        f"{prefix}rmse": ("output", np.sqrt((error**2).mean(axis=1))),
    }


def _by_decile(column: Array, inside: Flags) -> Array:
    """Return the coverage in every decile of the cases sorted by a column: (p, n) -> (p, 10)."""
    parts = np.array_split(np.argsort(column, kind="stable"), DECILES)
    return np.stack([inside[:, part].mean(axis=1) if part.size else np.ones(len(inside)) for part in parts], axis=1)


def chebyshev_interpolation(training: xr.Dataset, inputs: Sequence[Input], X: Array, outputs: Sequence[str]) -> Array:
    """Interpolate outputs at physical points X, (n, d), by the tensor-product polynomial through all cases: (p, n)."""
    values = []
    for cases in complete_factorial(training, inputs, outputs).outputs.values():
        series = reduce(chebyshev.coefficients, range(cases.ndim), cases)
        pairs = zip(unit_coordinates(inputs, X), cases.shape, strict=True)
        rows = [chebyshev.polynomials(column, size).T for column, size in pairs]
        values.append(contracted(series[..., None], rows)[:, 0])
    return np.stack(values)


def baseline(model: GaussianProcess, training: xr.Dataset, X: Array) -> Array:
    """Interpolate the training data of a model, over its inputs or its groups' axes, at points X, (n, d): (p, n)."""
    grouping, names = groups_of(model), model.outputs_
    if grouping is None:
        return chebyshev_interpolation(training, model.inputs_, X, names)
    scaled = grouping.reduced(training, names).assign_coords({axis.name: training[axis.name] for axis in grouping.axes})
    learnt = chebyshev_interpolation(scaled, grouping.axes, grouping.axis_values(X), names)
    return Scales(grouping, names).untransform(learnt, X)


def contracted(tensor: Array, rows: Sequence[Array]) -> Array:
    """Contract a tensor (n_1, ..., n_d, p) with one row of every factor, (B, n_f), per point: (B, p)."""
    answer = np.empty((len(rows[0]), tensor.shape[-1]))
    size = max(1, ELEMENTS // int(np.prod(tensor.shape[1:])))
    for block in blocks(len(answer), size):
        state = rows[0][block] @ tensor.reshape(tensor.shape[0], -1)
        for row in rows[1:]:
            state = np.einsum("bi,bij->bj", row[block], state.reshape(len(state), row.shape[1], -1))
        answer[block] = state
    return answer
