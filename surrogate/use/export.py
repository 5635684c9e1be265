"""A model as plain data, for evaluation in a browser: rounded means, variances and calibration."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Array
from surrogate.face.model import GaussianProcess
from surrogate.gp.gridgp import GridGP
from surrogate.intervals.distribution import PROBABILITIES
from surrogate.transforms.curves.basis import Basis
from surrogate.transforms.curves.curvegp import CurveGP
from surrogate.transforms.groupedgp import GroupedGP
from surrogate.use.rounding import FRESH, Rounded, grid_of, points_of_box, rounded

FORMAT = 5
ERROR = 1e-6  # of the rounding, over an output's range: below the digits that a page shows
POINTS = 2000  # fresh points on which the rounding is judged, a tenth of those of exported code
STEP = 1e-7  # rounding of fields of curves, over their scales
# Arrays of the calibration that are stored in single precision: logarithms of scales.
_SINGLE = ("trend", "trend_range", "guard", "corner_guard", "outer_guard", "outer_corner_guard", "outer_pooled_guard")


def exported(model: GaussianProcess) -> dict[str, Any] | None:
    """Return a model as JSON-ready data for means, deviations and intervals; None if only Python can evaluate it."""
    smooth = model.smooth_ if isinstance(model, CurveGP) else model
    if not isinstance(smooth, GridGP | GroupedGP):
        return None
    grid = grid_of(smooth)
    absolute = model.allowed(ERROR) if isinstance(model, CurveGP) else {}  # small scores need no digits
    parts = rounded(smooth, smooth.outputs_, ERROR, np.float64, points=POINTS, absolute=absolute)
    rows = [smooth.outputs_.index(name) for name in (model.witnesses if isinstance(model, CurveGP) else model.outputs_)]
    plain: dict[str, Any] = {
        "format": FORMAT,
        "inputs": list(map(asdict, model.inputs_)),
        "order": grid.order_,
        "trains": [_train(part) for part in parts],
        "factors": [
            {"levels": factor.levels, "affine": factor.affine, "decay": factor.decay, "unknown": factor.unknown}
            for factor in grid.factors_
        ],
        "amplitude": grid.amplitude_[:, rows],
        "variance": (grid.variance_ * grid.scale_**2)[rows],
        **_outputs(model, _rooms(model, parts)),
    }
    if isinstance(smooth, GroupedGP):
        groups = {name: array.values.tolist() for name, array in smooth.state().data_vars.items()}
        plain |= {"axes": list(map(asdict, grid.inputs_)), "groups": groups}
    if isinstance(model, CurveGP):
        plain["curves"] = model.described() | {"witness": rows}
        sizes = np.hypot(grid.offset_, grid.scale_)
        for net, basis in zip(plain["curves"]["nets"], model.bases_, strict=True):
            net["whole"] = _fields(basis, sizes[net["scores"]])
    exact: dict[str, Any] = _encoded(plain)
    return exact


def _rooms(model: GaussianProcess, parts: Sequence[Rounded]) -> Array:
    """Return the largest rounding error of every output, (p,), on fresh points."""
    if not isinstance(model, CurveGP):
        return np.array([part.room for part in parts])
    X = points_of_box(model, FRESH, POINTS)
    means = np.concatenate([part.model.all_mean_std(X, False)[0] for part in parts])
    return np.asarray(np.abs(model.followed(means) - model.all_mean_std(X, False)[0]).max(axis=1))


def _train(part: Rounded) -> dict[str, Any]:
    """Return one output's train over Chebyshev polynomials, its cores in one array."""
    cores = part.grid.chebyshev_.cores
    return {
        "modes": [core.shape[1] for core in cores],
        "ranks": [core.shape[2] for core in cores],
        "numbers": np.concatenate([core.ravel() for core in cores]).astype(part.storage),
        "offset": float(part.grid.offset_[0]),
    }


def _outputs(model: GaussianProcess, rooms: Array) -> dict[str, Any]:
    """Return the outputs, their calibration, and the ends of their intervals in standard deviations."""
    learnt, attrs = model.calibration_, model.attrs_
    lower, upper = np.broadcast_to(model.distribution.ends(model.level_), (2, len(model.outputs_)))
    arrays = {} if learnt is None else learnt.arrays()
    arrays |= {name: arrays[name].astype(np.float32) for name in _SINGLE if name in arrays}
    keys, together = ("units", "long_name"), {}
    if learnt is not None and learnt.copula is not None:
        # ranks (m, p) of the held-out rows, and the quantiles at probabilities that turn ranks into scores
        quantiles = {"probabilities": PROBABILITIES.tolist(), "quantiles": learnt.distribution.quantiles}
        together = {"together": {"ranks": learnt.copula.ranks, **quantiles}}
    return {
        "outputs": [{"name": name, **{key: attrs[name].get(key, "") for key in keys}} for name in model.outputs_],
        "calibration": {name: part for name, part in arrays.items() if name != "quantile"} or None,
        "interval": {"level": model.level_, "lower": lower, "upper": upper, "rooms": rooms},
        **together,
    }


def _fields(basis: Basis, sizes: Array) -> dict[str, Any]:
    """Return mean and vectors of curves over the fields' scales in steps of `STEP`; sizes: of the scores, (rank,)."""
    whole = np.concatenate([basis.mean[None], basis.vectors]).swapaxes(1, 2) / basis.scales
    rows = []  # a row of large values is in single precision, with step 1
    for row, size in zip(whole, [1.0, *np.maximum(sizes, np.finfo(np.float64).tiny).tolist()], strict=True):
        counts = np.rint(row * (size / STEP))
        large = bool(np.abs(counts).max() > np.iinfo(np.int16).max)
        values = row.astype(np.float32) if large else counts.astype(np.int16)
        rows.append({"step": 1.0 if large else STEP / size, "values": values.ravel()})
    return {"shape": list(whole.shape), "scales": basis.scales.tolist(), "rows": rows}


def _encoded(plain: Any) -> Any:
    """Return plain values with their arrays as `_array` encodes them."""
    if isinstance(plain, np.ndarray):
        return _array(plain)
    if isinstance(plain, Mapping):
        return {name: _encoded(value) for name, value in plain.items()}
    return [_encoded(value) for value in plain] if isinstance(plain, list | tuple) else plain


def _array(values: NDArray[Any]) -> dict[str, Any]:
    """Return an array as shape, type and base64 of its little-endian bytes; integers are below 32,768."""
    kind = values.dtype.newbyteorder("<").str
    if values.dtype.kind in "iu":
        kind = "<i1" if np.abs(values).max() <= np.iinfo(np.int8).max else "<i2"
    data = base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
    return {"shape": list(values.shape), "type": kind[1:], "data": data}
