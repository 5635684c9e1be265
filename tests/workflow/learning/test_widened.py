"""Questions beyond the ranges of a study: made anew, as good as the exact solver, and the lines to change are named."""

from pathlib import Path

import numpy as np
import pytest

from solver import solve
from workflow.design import search
from workflow.learning import widened
from workflow.study.model import Study, load
from workflow.study.reading import InputError
from workflow.study.target import Target

STUDY = """\
title: A small study
fixed: {composite: fibrous, load: 1e4, friction: 0.2}
factors:
  volume_fraction: {low: 0.5, high: 0.6, levels: 5}
  radius: {low: 0.05, high: 0.1, levels: 3, scale: log}
validation: {cases: 20, calibration: 100, tolerance: 1e-3}
"""


@pytest.fixture
def study(tmp_path: Path) -> Study:
    path = tmp_path / "small.yaml"
    path.write_text(STUDY, encoding="utf-8")
    return load(path)


def test_a_wider_question_is_answered_exactly(study: Study) -> None:
    target = Target.model_validate(
        {"maximise": "abs(voltage_sensitivity)", "over": {"volume_fraction": {"high": 0.8}, "radius": {"high": 0.2}},
         "subject_to": ["trailing_tension <= 40 MPa"]}
    )  # fmt: skip
    wider = widened.beyond(study, target)
    assert wider == {"volume_fraction": (0.5, 0.8), "radius": (0.05, 0.2)}
    told = "factors: volume_fraction: high: 0.8 (now 0.6 1); factors: radius: high: 0.2 (now 0.1 m)"
    assert widened.lines(study, wider) == f"{study.path}: {told}"
    own = widened.made(study, target, wider)
    assert (own.factors["volume_fraction"].levels, own.factors["radius"].levels) == (15, 6)
    assert own.outputs == ["trailing_tension", "voltage_sensitivity"]
    found = search.answer(own, "mine", target, widened.learned(own))
    over = {"volume_fraction": np.linspace(0.5, 0.8, 301), "radius": np.geomspace(0.05, 0.2, 301)}
    exact = solve({**over, "composite": "fibrous", "load": 1e4, "friction": 0.2})
    dense = abs(exact["voltage_sensitivity"]).where(exact["trailing_tension"] <= 40e6).max()
    assert float(found["exact"][0]) >= float(dense) * (1 - 1e-6)
    assert bool(found["feasible"])


def test_what_cannot_be_wider_is_one_line(study: Study) -> None:
    target = Target.model_validate(
        {"maximise": "peak_pressure", "over": {"volume_fraction": {"high": 1.2}, "radius": {}}}
    )
    with pytest.raises(InputError, match="volume_fraction") as error:
        widened.made(study, target, widened.beyond(study, target))
    assert "\n" not in str(error.value)
    target = Target.model_validate(
        {"maximise": "peak_pressure", "over": {"radius": {"low": 0.0}}, "at": {"volume_fraction": 0.5}}
    )
    with pytest.raises(InputError, match="must be positive on a log scale"):
        widened.made(study, target, widened.beyond(study, target))
    target = Target.model_validate({"maximise": "peak_pressure", "over": ["radius"], "at": {"volume_fraction": 0.5}})
    assert widened.beyond(study, target) == {}
