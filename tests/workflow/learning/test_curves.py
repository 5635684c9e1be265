"""Largest stresses of a study by curves over its groups, against the exact search."""

import re

import numpy as np

from surrogate import CurveGP
from tests.studies import made
from workflow.dataset import factorial
from workflow.learning import curves, training

STUDY = """\
title: Two axes stand for four factors
fixed: {composite: fibrous}
factors:
  volume_fraction: {low: 0.4, high: 0.6}
  friction: {low: 0.1, high: 0.3}
  radius: {low: 0.01, high: 0.1, scale: log}
  load: {low: 1e4, high: 1e5, scale: log}
groups:
  volume_fraction: {levels: 5}
  friction: {levels: 6}
dataset: {peaks: [peak_von_mises, peak_von_mises_depth]}
surrogate: {outputs: [peak_von_mises, peak_von_mises_depth, peak_pressure]}
"""


def test_over_groups_sizes_carry_the_scale_and_curves_have_none() -> None:
    study = made(STUDY)
    assert study.regions == ["body"]
    assert "peak_principal_tension" not in study.quantities  # nobody asked for its search
    data = factorial.exact(study, factorial.axes(study), curves=True)
    model = training.fit(study, data)
    assert isinstance(model, CurveGP)
    assert curves.given(study, data)
    fresh = factorial.sample(study, 20, (7, 0))
    table = training.validate(study, data, fresh, model)  # 30 cases, over a decade of loads and one of radii
    assert (table["max_error"] < [5e-4, 2e-3, 5e-4]).all()
    assert np.ptp(fresh["peak_von_mises"].values) > 1e8
    assert (table["baseline_max_error"].sel(output="peak_pressure") < 1e-3).all()


def test_calibration_cases_have_curves_which_correct_the_largest_stresses() -> None:
    text = re.sub(r"  (radius|load):.*\n|groups:\n(  .*\n)*", "", STUDY)
    text = text.replace("composite: fibrous", "radius: 0.05, load: 5e4")
    text = text.replace("high: 0.6}", "high: 0.8, levels: 7}").replace("high: 0.3}", "high: 0.5, levels: 6}")
    study = made(f"{text}validation: {{cases: 100, calibration: 200, tolerance: 1e-5}}")
    held, fresh = (factorial.cases(study, sample) for sample in ("calibration", "validation"))
    assert curves.given(study, held)
    assert not curves.given(study, fresh)
    model = training.fit(study, factorial.exact(study, factorial.axes(study), curves=True))
    points = {name: fresh[name] for name in study.factors}
    before = model.predict(points, return_std=False)["peak_von_mises"]
    after = model.calibrate(curves.training_data(study, held)).predict(points, return_std=False)["peak_von_mises"]
    errors = [np.median(np.abs(predicted - fresh["peak_von_mises"])) for predicted in (before, after)]
    assert errors[1] < 0.3 * errors[0]
