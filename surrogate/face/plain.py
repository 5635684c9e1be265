"""What every model that a browser evaluates has: its inputs, its outputs, and what takes variances to intervals."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess


def plain_inputs(inputs: Sequence[Input]) -> list[dict[str, Any]]:
    """Return names, ranges, scales, units and meanings."""
    keys = ("name", "low", "high", "scale", "units", "long_name")
    return [{key: getattr(own, key) for key in keys} for own in inputs]


def plain_outputs(model: GaussianProcess) -> dict[str, Any]:
    """Return the outputs, what is learnt of their deviations, and the ends of their intervals in deviations."""
    learnt, attrs = model.calibration_, model.attrs_
    lower, upper = np.broadcast_to(model.distribution.ends(model.level_), (2, len(model.outputs_)))
    arrays = {} if learnt is None else learnt.arrays()
    keys = ("units", "long_name")
    return {
        "outputs": [{"name": name, **{key: attrs[name].get(key, "") for key in keys}} for name in model.outputs_],
        "calibration": {name: part for name, part in arrays.items() if name != "quantile"} or None,
        "interval": {"level": model.level_, "lower": lower, "upper": upper},
    }
