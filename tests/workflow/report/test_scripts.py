"""The page's scripts in Node: names beside lines, figures, and the surrogate's answers, as Python's."""

import base64
import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from surrogate import CurveGP, GaussianProcess, GroupedGP, Input
from surrogate.use.export import ERROR, exported
from tests.studies import made
from tests.surrogate import curved, grouped
from tests.workflow.report.browser import in_node, needs_node
from workflow.language import grammar
from workflow.language.constants import FIGURES
from workflow.report import whatif
from workflow.report.page import TEMPLATES
from workflow.run.provenance import ROOT

SCRIPT = (ROOT / "workflow/report/templates/explore.js").read_text(encoding="utf-8")
WIDE, HIGH = 174.0, 34.0  # of "voltage over thickness / at most 500 kV/m"
STEPS = np.linspace(0.0, 1.0, 41)


def polyline(x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> list[list[list[float]]]:
    """Segments between points of the picture, whose frame is 64 to 470 by 12 to 318."""
    points = np.stack([np.broadcast_to(x, STEPS.shape), np.broadcast_to(y, STEPS.shape)], 1).tolist()
    return [list(pair) for pair in pairwise(points)]


LINES = {
    "steep": polyline(260 + 20 * STEPS, 12 + 306 * STEPS),
    "flat": polyline(64 + 406 * STEPS, 160 + 10 * STEPS),
    "diagonal": polyline(64 + 406 * STEPS, 318 - 306 * STEPS),
    "bent": polyline(100 + 300 * STEPS, 40 + 250 * (1 - STEPS) ** 3),
}


@needs_node
@pytest.mark.parametrize("others", [(), ("flat",)], ids=str)
def test_a_name_crosses_no_line_and_covers_no_other(others: tuple[str, ...], tmp_path: Path) -> None:
    segments = [segment for name in others for segment in LINES[name]]
    star = {"left": 250.0, "right": 286.0, "top": 147.0, "bottom": 181.0}
    lines = [(line, line + segments) for name, line in LINES.items() if name not in others]
    asks = ",".join(f"namePlace({line}, {WIDE}, {HIGH}, {all_lines}, [{star}])" for line, all_lines in lines)
    for (line, all_lines), place in zip(lines, in_node(SCRIPT, f"[{asks}]", tmp_path), strict=True):
        dense = np.concatenate([np.linspace(ends[0], ends[1], 9) for ends in all_lines])
        left, right, top, bottom = (place[key] for key in ("left", "right", "top", "bottom"))
        assert (right - left, bottom - top) == pytest.approx((WIDE, HIGH))
        assert not np.any((dense[:, 0] > left) & (dense[:, 0] < right) & (dense[:, 1] > top) & (dense[:, 1] < bottom))
        assert left >= star["right"] or right <= star["left"] or top >= star["bottom"] or bottom <= star["top"]
        assert 64 <= left < right <= 470
        assert 12 <= top < bottom <= 318
        starts = np.array([ends[0] for ends in line])
        aside = np.maximum(np.maximum(left - starts[:, 0], starts[:, 0] - right), 0)
        below = np.maximum(np.maximum(top - starts[:, 1], starts[:, 1] - bottom), 0)
        assert np.hypot(aside, below).min() < HIGH  # it is its line's


@needs_node
def test_the_panel_s_csv_quotes_commas_and_formulas(tmp_path: Path) -> None:
    script = (ROOT / "workflow/report/templates/share.js").read_text(encoding="utf-8")
    texts = ["PZT, soft", "=A1", "-x", 'say "so"', "plain", -1]
    cells = in_node(script, f"{json.dumps(texts)}.map(csvCell)", tmp_path)
    assert cells == ['"PZT, soft"', "'=A1", "'-x", '"say ""so"""', "plain", -1]


SCRIPTS = "".join(
    (TEMPLATES / name).read_text(encoding="utf-8") for name in ("surrogate.js", "largest.js", "judging.js")
)

STUDY = """
title: A sensor
fixed: {surroundings: insulated, composite: fibrous, friction: 0.2, base: steel, thickness: 5e-4, radius: 0.05}
factors:
  volume_fraction: {low: 0.4, high: 0.6, levels: 3}
  load: {low: 1e3, high: 1e4, levels: 3}
surrogate: {outputs: [charge_per_force, capacitance]}
device:
  electrode_length: 10 mm
  amplifier: {input_capacitance: 10 pF, cable_capacitance: 100 pF, charge_noise: 1 fC, voltage_noise: 20 uV}
"""


@needs_node
def test_figures_at_the_sliders_are_those_of_python(tmp_path: Path) -> None:
    study = made(STUDY)
    values = {"charge_per_force": -4e-11, "capacitance_per_length": 2e-8, "load": 5e3}
    trees = {figure["name"]: figure["tree"] for figure in whatif.figures(study)}
    script = f"{SCRIPTS}const trees = {json.dumps(trees)}, values = {json.dumps(values)};"
    values_of = "Object.fromEntries(Object.entries(trees).map(([name, tree]) => [name, evaluate(tree, values)]))"
    constants = {name: np.array(value) for name, value in study.device.constants.items()} if study.device else {}
    known = {name: np.array(value) for name, value in values.items()} | constants
    expected = {name: float(grammar.parse(FIGURES[name].formula).evaluate(known)) for name in trees}
    assert in_node(script, values_of, tmp_path) == pytest.approx(expected, rel=1e-12)
    moved = in_node(script, "carried(trees.signal_charge, values, { charge_per_force: 1e-13 })", tmp_path)
    assert moved == pytest.approx(1e-13 * 5e3 * 0.01, rel=1e-9)  # linear in it: load times length times the change


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
