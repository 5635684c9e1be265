"""Allowables of a study's materials, and numbers of its device, from the library and the study's file."""

import pytest

from solver import find
from tests.studies import edited, made
from tests.workflow.study.test_films import FILM
from workflow.study.allowable import allowable
from workflow.study.model import thawed


def test_a_strength_that_bounds_another_stress_is_reported() -> None:
    bounded = edited(FILM, "nominal_field <= 3 kV/mm", "trailing_tension <= tensile_strength")
    assert not any(line.startswith("design.") for line in made(bounded).defaults)
    limited = made(edited(bounded, "trailing_tension", "peak_pressure")).defaults
    (said,) = (line for line in limited if line.startswith("design.thin: "))
    assert said.startswith("design.thin: tensile_strength is a limit of trailing_tension or ")
    assert said.endswith("and here bounds peak_pressure as written")


def test_a_composite_bears_what_its_weaker_phase_does() -> None:
    factors = {"composite": "fibrous", "volume_fraction": 0.5}
    strength = allowable("tensile_strength", factors, {}, ["PZT-4", "PZT-5H"])
    assert strength.value == min(find(name).limits["tensile_strength"].value for name in ("PZT-4", "PZT-5H"))
    assert strength.material == "PZT-5H, the weaker phase"
    assert strength.source == find("PZT-5H").limits["tensile_strength"].source
    assert allowable("tensile_strength", {**factors, "volume_fraction": 1}, {}, ["PZT-4", "PZT-5H"]).material == "PZT-4"
    field = allowable("coercive_field", {}, {}, ["BaTiO3", "CoFe2O4"])
    assert (field.value, field.material) == (0.3e6, "BaTiO3 (CoFe2O4: none known)")
    with pytest.raises(ValueError, match="base_yield_strength: a half-plane, without a base, has none"):
        allowable("base_yield_strength", {}, {}, ["BaTiO3", "CoFe2O4"])
    assert (
        allowable("base_yield_strength", {"base": "steel"}, {}, []).value
        == find("steel").limits["yield_strength"].value
    )
    assert allowable("coercive_field", {"composite": "AlScN", "scandium_fraction": 0.2}, {}, []).value == 200e6


def test_the_numbers_of_a_device_have_units() -> None:
    amplifier = "{input_capacitance: 10 pF, input_resistance: 1 TOhm, cable_capacitance: 1e-10, charge_noise: 2 fC}"
    study = made(f"{FILM}device: {{electrode_length: 10 mm, amplifier: {amplifier}}}\n")
    assert study.device is not None
    assert study.device.constants == {
        "electrode_length": 0.01, "input_capacitance": 10e-12, "input_resistance": 1e12, "cable_capacitance": 1e-10,
        "charge_noise": 2e-15, "voltage_noise": 0.0, "open_loop_gain": 1e6,
        "temperature": 293.15, "thermal_energy": pytest.approx(4.0474e-21, rel=1e-4, abs=0), "feedback_heat": 0.0,
    }  # fmt: skip
    assert thawed(study.frozen()).device == study.device
