"""The verdict on designs: of punches without a voltage or with a fixed radius, at edges, under limits that meet."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
import yaml

from workflow import design, factorial, learning
from workflow import study as studies
from workflow.designfigures import figures_of
from workflow.target import Target

LOAD = {"low": 5e3, "high": 5e4, "levels": 5, "scale": "log"}
RADIUS = {"low": 0.02, "high": 0.2, "levels": 5, "scale": "log"}
FRACTION = {"low": 0.4, "high": 0.8, "levels": 10}

Ask = Callable[..., xr.Dataset]


@pytest.fixture
def ask(tmp_path: Path) -> Ask:
    """Answer a target of a small study whose composite is fibrous and whose friction is 0.2."""

    def answer(factors: dict[str, Any], fixed: dict[str, Any] | None = None, **target: Any) -> xr.Dataset:
        text = {
            "title": "small",
            "fixed": {"composite": "fibrous", "friction": 0.2, **(fixed or {})},
            "factors": factors,
            "validation": {"cases": 20, "calibration": 40, "tolerance": 1e-2},
        }
        (tmp_path / "one.yaml").write_text(yaml.safe_dump(text), encoding="utf-8")
        study = studies.load(tmp_path / "one.yaml")
        model = learning.fit(study, factorial.exact(study, dict(factorial.levels(study))))
        return design.answer(study, "mine", Target.model_validate(target), model)

    return answer


@pytest.mark.parametrize("insulating", [["electric"], ["electric", "magnetic"]])
def test_a_punch_without_a_voltage_is_judged_and_drawn(ask: Ask, insulating: list[str]) -> None:
    target = {"maximise": "peak_pressure", "over": ["volume_fraction", "radius"], "subject_to": ["radius >= 50 mm"]}
    factors = {"volume_fraction": FRACTION, "radius": RADIUS}
    answer = ask(factors, {"load": 1e4, **dict.fromkeys(insulating, "insulating")}, **target)
    assert bool(answer["feasible"])
    assert float(answer["value"].sel(factor="radius")) == pytest.approx(0.05, rel=1e-6)
    assert "voltage" not in answer["quantity"].values
    assert answer["flags"].item() == ""
    assert set(figures_of(answer, Target.model_validate(target))) == {"map", "slices", "bars", "contact"}


@pytest.mark.parametrize(
    ("profile", "told"),
    [({"radius": 1e-7}, True), ({"radius": 0.05}, False), ({"profile": "flat", "width": 1e-4}, False)],
)
def test_a_contact_too_wide_for_its_parabola_is_told_of_a_fixed_radius_too(
    ask: Ask, profile: dict[str, Any], told: bool
) -> None:
    target = {"maximise": "abs(voltage_sensitivity)", "over": ["volume_fraction", "load"]}
    answer = ask({"volume_fraction": FRACTION, "load": LOAD}, profile, **target)
    flags = answer["flags"].item()
    assert ("no longer a parabola" in flags) == told
    if told:
        width = float(answer["exact_high"].sel(quantity=["contact_trailing", "contact_leading"]).sum())
        assert f"the contact is {width / profile['radius']:.2g} of the radius wide" in flags
