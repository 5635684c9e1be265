"""Parts of every model that a browser evaluates: inputs, outputs, and the calibration from variances to intervals."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from surrogate.data.inputs import Input
from surrogate.data.packing import Rounded
from surrogate.face.model import GaussianProcess
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.copula import Copula
from surrogate.intervals.distribution import PROBABILITIES


def plain_inputs(inputs: Sequence[Input]) -> list[dict[str, Any]]:
    """Return names, ranges, scales, units and meanings."""
    return [asdict(input_) for input_ in inputs]


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
        **({} if learnt is None or learnt.copula is None else {"together": _together(learnt, learnt.copula)}),
    }


def _together(learnt: Calibration, copula: Copula) -> dict[str, Any]:
    """The held-out rows as ranks (m, 1, p), and what makes scores of them: quantiles at probabilities."""
    rows, outputs = copula.ranks.shape
    ranks = Rounded(copula.ranks[:, None].astype(np.float64), np.ones(rows), np.ones(outputs))
    quantiles = learnt.distribution.quantiles
    return {"ranks": ranks, "probabilities": PROBABILITIES.tolist(), "quantiles": quantiles}
