"""A grid model as plain data, for evaluation elsewhere, such as in a browser."""

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from surrogate.data.arrays import Array
from surrogate.data.inputs import Input
from surrogate.gp.correction import Correction
from surrogate.gp.distribution import NOMINAL
from surrogate.gp.factors import ChebyshevFactor
from surrogate.gp.gridgp import GridGP
from surrogate.gp.groupedgp import GroupedGP
from surrogate.gp.model import GaussianProcess

FORMAT = 2


def exported(model: GaussianProcess) -> dict[str, Any] | None:
    """Return everything that mean, standard deviation and 95 % interval need, as what JSON can hold.

    Arrays are ``{"shape": [...], "data": base64 of little-endian float64}``, so that no digit is lost.

    Parameters
    ----------
    model : GaussianProcess
        A fitted model.

    Returns
    -------
    dict or None
        None for a model of other kernels than "chebyshev", which only Python evaluates.
    """
    if isinstance(model, GroupedGP):
        core = exported(model.core_)
        return None if core is None else {**core, **_grouped(model, core["inputs"])}
    if not isinstance(model, GridGP) or not all(isinstance(factor, ChebyshevFactor) for factor in model.factors_):
        return None
    calibration = model.calibration_
    lower, upper = np.broadcast_to(model.distribution.ends(NOMINAL), (2, len(model.outputs_)))  # in standard deviations
    return {
        "format": FORMAT,
        "inputs": _inputs(model.inputs_),
        "outputs": [
            {
                "name": name,
                "units": model.attrs_[name].get("units", ""),
                "long_name": model.attrs_[name].get("long_name", ""),
            }
            for name in model.outputs_
        ],
        "order": list(model.order_),
        "cores": [_array(core) for core in model.train_.cores],
        "factors": [factor.exported() for factor in model.factors_ if isinstance(factor, ChebyshevFactor)],
        "offset": _array(model.offset_),
        "scale": _array(model.scale_),
        "amplitude": _array(model.amplitude_),
        "variance": _array(model.variance_ * model.scale_**2),
        "correction": None if model.correction_ is None else _correction(model.correction_),
        "calibration": None
        if calibration is None
        else {name: _array(array) for name, array in calibration.arrays().items() if name != "quantile"},
        "interval": {"level": NOMINAL, "lower": _array(lower), "upper": _array(upper)},
    }


def _inputs(inputs: Sequence[Input]) -> list[dict[str, Any]]:
    names = ("name", "low", "high", "scale", "units", "long_name")
    return [{name: getattr(one, name) for name in names} for one in inputs]


def _grouped(model: GroupedGP, axes: list[dict[str, Any]]) -> dict[str, Any]:
    """The inputs, and what takes them to the axes and the learnt outputs to the model's."""
    state = model.grouping.state(model.outputs_)
    names = ("axis_power", "axis_constant", "scale_power", "added_coefficient", "added_power", "logarithm", "reference")
    return {
        "inputs": _inputs(model.inputs_),
        "axes": axes,
        "groups": {name: state[name].values.tolist() for name in names},
    }


def _correction(correction: Correction) -> dict[str, Any]:
    return {
        "levels": list(correction.levels),
        "degrees": correction.indices.tolist(),
        "coefficients": _array(correction.coefficients),
    }


def _array(values: Array) -> dict[str, Any]:
    little = np.ascontiguousarray(values, dtype="<f8")
    return {"shape": list(little.shape), "data": base64.b64encode(little.tobytes()).decode("ascii")}
