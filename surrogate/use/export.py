"""A grid model as plain data, for evaluation elsewhere, such as in a browser."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from surrogate.curves.curvegp import CurveGP
from surrogate.curves.curves import Basis
from surrogate.data.arrays import Array
from surrogate.data.inputs import Input
from surrogate.gp.correction import Correction
from surrogate.gp.factors import ChebyshevFactor
from surrogate.gp.gridgp import GridGP
from surrogate.gp.groupedgp import GroupedGP
from surrogate.gp.model import GaussianProcess
from surrogate.intervals.distribution import NOMINAL
from surrogate.use.packing import array, packed, rounded

FORMAT = 4
# Rounding of fields of curves, in their sizes: what follows from them is still the same to 1e-9.
STEP = 1e-12


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
    if isinstance(model, CurveGP):
        smooth = exported(model.smooth_)
        return None if smooth is None else {**smooth, **_following(model)}
    if isinstance(model, GroupedGP):
        core = exported(model.core_)
        return None if core is None else {**core, **_grouped(model, core["inputs"])}
    if not isinstance(model, GridGP) or not all(isinstance(factor, ChebyshevFactor) for factor in model.factors_):
        return None
    factors = [factor for factor in model.factors_ if isinstance(factor, ChebyshevFactor)]
    return {
        "format": FORMAT,
        "inputs": _inputs(model.inputs_),
        "order": list(model.order_),
        "cores": packed(model.train_.cores, factors, model.order_),
        "factors": [factor.exported() for factor in factors],
        "offset": array(model.offset_),
        "scale": array(model.scale_),
        "correction": None if model.correction_ is None else _correction(model.correction_),
        **_distributed(model),
        **_varying(model, range(len(model.outputs_))),
    }


def _distributed(model: GaussianProcess) -> dict[str, Any]:
    """The outputs, and what takes their variances to intervals."""
    calibration = model.calibration_
    lower, upper = np.broadcast_to(model.distribution.ends(NOMINAL), (2, len(model.outputs_)))  # in standard deviations
    return {
        "outputs": [
            {
                "name": name,
                "units": model.attrs_[name].get("units", ""),
                "long_name": model.attrs_[name].get("long_name", ""),
            }
            for name in model.outputs_
        ],
        "calibration": None
        if calibration is None
        else {name: array(values) for name, values in calibration.arrays().items() if name != "quantile"},
        "interval": {"level": NOMINAL, "lower": array(lower), "upper": array(upper)},
    }


def _varying(model: GridGP, columns: Sequence[int]) -> dict[str, Any]:
    """What the process's own variance of some outputs needs."""
    some = list(columns)
    return {
        "amplitude": array(model.amplitude_[:, some]),
        "variance": array((model.variance_ * model.scale_**2)[some]),
    }


def _following(model: CurveGP) -> dict[str, Any]:
    """Outputs that follow from smooth ones: how, their intervals, and the smooth output whose variance tells theirs."""
    smooth = model.smooth_.core_ if isinstance(model.smooth_, GroupedGP) else model.smooth_
    assert isinstance(smooth, GridGP)  # else nothing of it would have been exported
    links = model.links()
    measures = list(dict.fromkeys(one.measure for one in model.largest.values()))
    largest = [
        {
            "output": model.outputs.index(name),
            "net": one.curves,
            "measure": measures.index(one.measure),
            "place": one.place,
            "size": links.sizes[name],
        }
        for name, one in model.largest.items()
    ]
    return {
        **_distributed(model),
        **_varying(smooth, links.witnesses),
        "curves": {
            "plain": links.plain,
            "largest": largest,
            "measures": [{"linear": one.linear.tolist(), "root": one.root.tolist()} for one in measures],
            "logarithms": model.logarithms,
            "nets": [
                {
                    "across": curves.panels.across,
                    "down": curves.panels.down,
                    "scores": rows,
                    "whole": _whole(basis, np.hypot(smooth.offset_, smooth.scale_)[rows]),
                }
                for curves, basis, rows in zip(model.curves, model.bases_, links.scores, strict=True)
            ],
            "witness": links.witnesses,
            "spread": links.spreads,
        },
    }


def _whole(basis: Basis, scores: Array) -> dict[str, Any]:
    """Mean and vectors of curves, (1 + rank, point, field); ``scores`` are the sizes of these."""
    whole = np.concatenate([basis.mean[None], basis.vectors]).swapaxes(1, 2)
    return rounded(whole, 1 / np.concatenate([[1.0], scores]), STEP * basis.scales)


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
