"""Largest stresses of a study by curves over its groups, against the exact search."""

import re

import numpy as np
import pytest

from solver import solve
from surrogate import CurveGP
from tests.studies import made
from workflow.dataset import factorial
from workflow.design.search import targets
from workflow.learning import curves, training, wider_box
from workflow.study.model import Study
from workflow.study.reading import InputError
from workflow.study.target import Target

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


NARROW = """\
title: A small study
fixed: {composite: fibrous, load: 1e4, friction: 0.2}
factors:
  volume_fraction: {low: 0.5, high: 0.6, levels: 5}
  radius: {low: 0.05, high: 0.1, levels: 3, scale: log}
validation: {cases: 20, calibration: 100, tolerance: 1e-3}
"""

GROUPED = """\
title: A small study in groups
fixed: {composite: fibrous, charge: 0.0, magnetic_charge: 0.0}
factors:
  volume_fraction: {low: 0.5, high: 0.6}
  friction: {low: 0.1, high: 0.3}
  radius: {low: 0.05, high: 0.1, scale: log}
  load: {low: 5e3, high: 1e4, scale: log}
groups:
  volume_fraction: {levels: 5, scale: logit}
  friction: {levels: 3}
  load * radius: {levels: 4}
surrogate: {outputs: [voltage_per_load, trailing_tension]}
validation: {cases: 20, calibration: 200, tolerance: 1e-3}
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(NARROW)


def test_a_wider_question_is_answered_exactly(study: Study) -> None:
    target = Target.model_validate(
        {"maximise": "abs(voltage_per_load)", "over": {"volume_fraction": {"high": 0.8}, "radius": {"high": 0.2}},
         "subject_to": ["trailing_tension <= 40 MPa"]}
    )  # fmt: skip
    wider = wider_box.beyond(study, target)
    assert wider == {"volume_fraction": (0.5, 0.8), "radius": (0.05, 0.2)}
    within = Target.model_validate({"maximise": "peak_pressure", "over": ["radius"], "at": {"volume_fraction": 0.5}})
    assert wider_box.beyond(study, within) == {}
    none = Target.model_validate({"maximise": "peak_pressure", "over": {"radius": {"low": 0.0}, "volume_fraction": {}}})
    with pytest.raises(InputError, match="must be positive on a log scale"):
        wider_box.made(study, none, wider_box.beyond(study, none))
    words = "factors: volume_fraction: high: 0.8 (now 0.6); factors: radius: high: 0.2 (now 0.1 m)"
    assert wider_box.lines(study, wider) == f"{study.path}: {words}"
    wider_study = wider_box.made(study, target, wider)
    assert (wider_study.factors["volume_fraction"].levels, wider_study.factors["radius"].levels) == (15, 6)
    assert wider_study.outputs == ["trailing_tension", "voltage_per_load"]
    answer = targets.answer(wider_study, "mine", target, wider_box.fitted(wider_study))
    over = {"volume_fraction": np.linspace(0.5, 0.8, 301), "radius": np.geomspace(0.05, 0.2, 301)}
    exact = solve({**over, "composite": "fibrous", "load": 1e4, "friction": 0.2})
    dense = abs(exact["voltage_per_load"]).where(exact["trailing_tension"] <= 40e6).max()
    assert answer.terms[0].exact >= float(dense) * (1 - 1e-6)
    assert answer.feasible


def test_groups_widen_with_their_factors() -> None:
    study = made(GROUPED)
    content = {
        "maximise": "abs(voltage_per_load)",
        "over": {"volume_fraction": {"high": 0.8}, "radius": {"high": 0.4}},
        "at": {"load": 1e4},
        "worst_case": {"friction": [0.1, 0.3]},
        "subject_to": ["trailing_tension <= 40 MPa"],
    }
    target = Target.model_validate(content)
    wider_study = wider_box.made(study, target, wider_box.beyond(study, target))
    # the logit of 0.8 is 3.4 times as far from that of 0.5 as 0.6's; load times radius spans a factor of 16, not of 4
    assert {text: group.levels for text, group in wider_study.groups.items()} == {
        "volume_fraction": 18, "friction": 3, "load * radius": 8,
    }  # fmt: skip
    beyond_one = {"over": {"volume_fraction": {"high": 1.0}, "radius": {}}}
    for changed, words in (
        (beyond_one, "volume_fraction: scale: logit needs a range between 0"),
        ({"worst_case": {"friction": [-1e6, 0.3]}}, "friction"),
    ):
        beyond = Target.model_validate(content | changed)
        with pytest.raises(InputError, match=words) as error:
            wider_box.made(study, beyond, wider_box.beyond(study, beyond))
        assert "\n" not in str(error.value)
