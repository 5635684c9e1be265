"""A grid model as plain data, for evaluation elsewhere, such as in a browser."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from surrogate.data.inputs import Input
from surrogate.gp.correction import Correction
from surrogate.gp.factors import ChebyshevFactor
from surrogate.gp.gridgp import GridGP
from surrogate.gp.groupedgp import GroupedGP
from surrogate.gp.model import GaussianProcess
from surrogate.intervals.distribution import NOMINAL
from surrogate.use.packing import array, packed

FORMAT = 4


def exported(model: GaussianProcess) -> dict[str, Any] | None:
    """Return everything that mean, standard deviation and 95 % interval need, as what JSON can hold.

    Arrays are ``{"shape": [...], "data": base64 of little-endian float64}``, so that no digit is lost; cores are as
    :func:`surrogate.use.packing.packed` has them, which changes a mean by some 1e-10 of a standard deviation.

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
    factors = [factor for factor in model.factors_ if isinstance(factor, ChebyshevFactor)]
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
        "cores": packed(model.train_.cores, factors, model.order_),
        "factors": [factor.exported() for factor in factors],
        "offset": array(model.offset_),
        "scale": array(model.scale_),
        "amplitude": array(model.amplitude_),
        "variance": array(model.variance_ * model.scale_**2),
        "correction": None if model.correction_ is None else _correction(model.correction_),
        "calibration": None
        if calibration is None
        else {name: array(values) for name, values in calibration.arrays().items() if name != "quantile"},
        "interval": {"level": NOMINAL, "lower": array(lower), "upper": array(upper)},
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
        "coefficients": array(correction.coefficients),
    }
