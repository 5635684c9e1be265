"""The page's surrogate answers as Python's does, with groups and largest values of curves too."""

import base64
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from surrogate import CurveGP, GaussianProcess, GroupedGP, Input
from surrogate.use.export import ERROR, exported
from tests.surrogate import curved, grouped
from tests.workflow.report.browser import in_node, needs_node
from workflow.report.page import TEMPLATES

SCRIPTS = "".join((TEMPLATES / name).read_text(encoding="utf-8") for name in ("surrogate.js", "largest.js"))
ANSWERS = """({
  ...Object.fromEntries(["mean", "std", "lower", "upper"].map(
    (part) => [part, points.map((t) => [...predict(model, t)[part]])])),
  means: points.map((t) => [...means(model, t)]),
  shares: points.map((t) => fromUnit(share, t[0])),
})"""
SHARE = Input("share", 0.02, 0.9, "logit")


def of_groups() -> GaussianProcess:
    model = GroupedGP(grouped.GROUPING).fit(grouped.factorial(0.2))
    return model.calibrate(grouped.cases(300, 1, 0.2, to_ends=300))


def of_curves_over_groups() -> GaussianProcess:
    return held_out(curved.fitted_over_groups())


def held_out(model: CurveGP) -> GaussianProcess:
    """The model calibrated on cases that are off by some 1e-3: what they are is no matter here."""
    t = np.random.default_rng(3).uniform(-1, 1, (2, 60))
    points = {
        axis.name: xr.DataArray(axis.from_unit(row), dims="case") for axis, row in zip(curved.INPUTS, t, strict=True)
    }
    off = model.predict(points, return_std=False) * (1 + 1e-3 * np.sin(40 * points["a"]))
    return model.calibrate(off.assign(points))


@needs_node
@pytest.mark.parametrize("fitted_model", [of_groups, of_curves_over_groups])
def test_the_script_says_the_same(fitted_model: Callable[[], GaussianProcess], tmp_path: Path) -> None:
    model = fitted_model()
    t = np.random.default_rng(2).uniform(-1, 1, (40, len(model.inputs_)))
    t[0], t[1] = 1.0, -1.0
    X = np.stack([axis.from_unit(row) for axis, row in zip(model.inputs_, t.T, strict=True)], axis=1)
    mean, std = model.predict_array(X, return_std=True)
    data = {"model": exported(model), "points": t.tolist()}
    data["share"] = {"name": "share", "low": 0.02, "high": 0.9, "scale": "logit"}
    script = f"{SCRIPTS}const data = {json.dumps(data)}, {{ points, share }} = data, model = loadSurrogate(data.model);"
    seen = in_node(script, ANSWERS, tmp_path)
    lower, upper = model.interval_array(X)
    interval = data["model"]["interval"]
    rooms = np.frombuffer(base64.b64decode(interval["rooms"]["data"]))
    size = np.ptp(mean, axis=0)
    assert (rooms <= (3 if isinstance(model, CurveGP) else 1) * ERROR * size).all()  # errors of scores add up
    np.testing.assert_array_equal(seen["mean"], seen["means"])
    off = np.abs(seen["mean"] - mean)
    assert (off <= 2 * rooms).all()  # they are the largest errors on 2,000 points
    np.testing.assert_allclose(seen["std"], std, rtol=2e-5)  # calibrated in single precision
    np.testing.assert_allclose(np.array(seen["lower"]) + rooms, lower, rtol=0, atol=3 * rooms.max() + 2e-5 * std.max())
    np.testing.assert_allclose(np.array(seen["upper"]) - rooms, upper, rtol=0, atol=3 * rooms.max() + 2e-5 * std.max())
    np.testing.assert_allclose(seen["shares"], SHARE.from_unit(t[:, 0]), rtol=1e-13)
