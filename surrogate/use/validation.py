"""How good a surrogate is on cases that it was not trained on: errors, intervals, and the baseline beside them."""

from copy import copy
from typing import Any

import numpy as np
import xarray as xr
from scipy.stats import norm

from surrogate.data.arrays import Array, Flags
from surrogate.gp.conformal import HALF_WIDTH, NOMINAL
from surrogate.gp.model import GaussianProcess
from surrogate.use.baseline import chebyshev_interpolation

DECILES = 10


def validate(model: GaussianProcess, cases: xr.Dataset, training: xr.Dataset | None) -> xr.Dataset:
    """Compare a model with held-out truth.

    Parameters
    ----------
    model : GaussianProcess
        A fitted model.
    cases : Dataset
        Held-out cases, inputs and true outputs: variables over one or more dimensions.
    training : Dataset or None
        What the model was trained on, for the baseline; None only where tensor Chebyshev interpolation does not apply
        (levels that are not Chebyshev-Gauss, scattered cases).

    Returns
    -------
    Dataset
        Over `output`: `range` (of the truth), `max_error` and `rmse` (over that range), `r2`, `coverage` (of the
        nominal 95 % interval), `crps` (over range), `worst_decile_coverage`, and with training `baseline_max_error` and
        `baseline_rmse`. Over (`output`, `input`, `decile`): `decile_coverage`, deciles of the cases by the value of the
        input. Over (`output`, `case`): `pit`, the predictive distribution's value at the truth, and `error` (signed,
        over range). An output with no range is measured against 1. For a calibrated model `raw_coverage`,
        `raw_worst_decile_coverage`, `raw_crps` and `raw_pit` are those of the same model without its calibration.

    Raises
    ------
    ValueError
        Missing variables, NaN, or a case outside the box.
    """
    points, truth = model.cases(cases)
    predicted = model.predict(points)
    names = list(model.outputs_)
    true = _stack(truth, names, predicted)
    if not np.isfinite(true).all():
        raise ValueError(
            f"output {names[int(np.argmin(np.isfinite(true).all(axis=1)))]!r} is not finite in a held-out case"
        )
    mean = _stack(predicted, names, predicted)
    std = _stack(predicted, [f"{name}_std" for name in names], predicted)
    spread = np.ptp(true, axis=1)
    over = np.where(spread > 0, spread, 1.0)[:, None]
    error = (mean - true) / over
    inside = np.abs(mean - true) <= HALF_WIDTH * std
    columns = xr.broadcast(*[points[name] for name in model.box], predicted[names[0]])[:-1]
    by_decile = np.stack([_by_decile(column.values.ravel(), inside) for column in columns], axis=1)
    table: dict[str, Any] = {
        "range": ("output", spread, {"long_name": "range of the truth"}),
        **_errors(error, ""),
        "r2": ("output", _r2(true, mean), {"long_name": "coefficient of determination"}),
        "coverage": ("output", inside.mean(axis=1), {"long_name": f"coverage of the nominal {NOMINAL:.0%} interval"}),
        "crps": (
            "output",
            (crps(true, mean, std) / over).mean(axis=1),
            {"long_name": "mean continuous ranked probability score over range"},
        ),
        "decile_coverage": (
            ("output", "input", "decile"),
            by_decile,
            {"long_name": "coverage in a decile of an input"},
        ),
        "worst_decile_coverage": (
            "output",
            by_decile.min(axis=(1, 2)),
            {"long_name": "coverage in the worst decile of any input"},
        ),
        "pit": (("output", "case"), pit(true, mean, std), {"long_name": "probability integral transform"}),
        "error": (("output", "case"), error, {"long_name": "signed error over range"}),
    }
    if training is not None:
        interpolated = chebyshev_interpolation(training, list(model.inputs_), points, names)
        table |= _errors((_stack(interpolated, names, predicted) - true) / over, "baseline_")
    if model.calibration_ is not None:
        raw = copy(model)
        raw.calibration_ = None
        before = validate(raw, cases, None)
        table |= {f"raw_{name}": before[name].variable for name in ("coverage", "worst_decile_coverage", "crps", "pit")}
    coords = {"output": names, "input": list(model.box), "decile": np.arange(1, DECILES + 1)}
    return xr.Dataset(table, coords=coords)


def crps(true: Array, mean: Array, std: Array) -> Array:
    """Return the continuous ranked probability score of Gaussian predictions, any shape.

    T. Gneiting and A. E. Raftery, J. Am. Stat. Assoc. 102 (2007) 359, equation 21, with the sign of a loss. A standard
    deviation of zero gives the absolute error.
    """
    z = _standard(true, mean, std)
    finite = np.where(np.isfinite(z), z, 0.0)
    score = std * (finite * (2 * norm.cdf(finite) - 1) + 2 * norm.pdf(finite) - 1 / np.sqrt(np.pi))
    return np.asarray(np.where(std > 0, score, np.abs(true - mean)))


def pit(true: Array, mean: Array, std: Array) -> Array:
    """Return the probability integral transform of Gaussian predictions, any shape; uniform where they are right."""
    return np.asarray(norm.cdf(_standard(true, mean, std)))


def _standard(true: Array, mean: Array, std: Array) -> Array:
    error = true - mean
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(error == 0, 0.0, error / std)


def _errors(error: Array, prefix: str) -> dict[str, Any]:
    what = "of tensor Chebyshev interpolation " if prefix else ""
    return {
        f"{prefix}max_error": ("output", np.abs(error).max(axis=1), {"long_name": f"largest error {what}over range"}),
        f"{prefix}rmse": (
            "output",
            np.sqrt((error**2).mean(axis=1)),
            {"long_name": f"root-mean-square error {what}over range"},
        ),
    }


def _r2(true: Array, mean: Array) -> Array:
    spread = ((true - true.mean(axis=1, keepdims=True)) ** 2).sum(axis=1)
    error = ((true - mean) ** 2).sum(axis=1)
    return np.asarray(np.where(spread > 0, 1 - error / np.where(spread > 0, spread, 1), error == 0), dtype=np.float64)


def _by_decile(column: Array, inside: Flags) -> Array:
    """Coverage in every decile of the cases sorted by a column: (p, n) -> (p, 10)."""
    parts = np.array_split(np.argsort(column, kind="stable"), DECILES)
    return np.stack([inside[:, part].mean(axis=1) if part.size else np.ones(len(inside)) for part in parts], axis=1)


def _stack(dataset: xr.Dataset, names: list[str], like: xr.Dataset) -> Array:
    template = like[next(iter(like.data_vars))]
    arrays = [xr.broadcast(dataset[name], template)[0].transpose(*template.dims) for name in names]
    return np.stack([np.asarray(array.values, dtype=np.float64).ravel() for array in arrays])
