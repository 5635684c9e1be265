"""Allowables of a study's materials, and numbers of its device, from the library and the study's file."""

import pytest

from solver import find
from tests.studies import made, refusal
from workflow.study.allowable import allowable
from workflow.study.model import thawed

FILM = """\
title: A film
phases: {phases}
fixed: {{composite: {composite}, {share}: 0.5, radius: 0.05, base: {base}, friction: 0.2, charge: 0.0,
         surroundings: insulated}}
factors:
  thickness: {{low: 2e-4, high: 3e-4, levels: 3}}
  load: {{low: 1e4, high: 2e4, levels: 3}}
{more}
design:
  mine:
    maximise: {goal}
    over: [thickness]
    at: {{load: 1e4}}
    subject_to: ["{limit}"]
"""


def film(**entries: str) -> str:
    """The text of a small study of a film."""
    usual = {
        "phases": "[BaTiO3, CoFe2O4]", "composite": "fibrous", "share": "volume_fraction", "base": "rigid", "more": "",
        "goal": "abs(charge_per_force)", "limit": "trailing_tension <= tensile_strength",
    }  # fmt: skip
    return FILM.format(**(usual | entries))


def test_a_strength_that_bounds_another_stress_is_reported() -> None:
    assert not any(line.startswith("design.") for line in made(film()).defaults)
    limited = made(film(limit="peak_pressure <= tensile_strength")).defaults
    (said,) = (line for line in limited if line.startswith("design.mine: "))
    assert said.startswith("design.mine: tensile_strength is a limit of trailing_tension or ")
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


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"limit": "nominal_field <= breakdown_field"}, "breakdown_field: none is known of BaTiO3 and CoFe2O4"),
        ({"goal": "force * abs(charge_per_force)"}, "device: electrode_length: missing; must be a number with a unit"),
        ({"limit": "trailing_tension <= base_tensile_strength"}, "base_tensile_strength: a rigid base has none"),
        ({"goal": "abs(signal_voltage)", "more": "device: {electrode_length: 10 mm}"},
         "device: amplifier: input_capacitance: missing; must be a number with a unit"),
        ({"more": "device: {electrode_length: 1, amplifier: {input_capacitance: 1e-11, charge_noise: 1}}"},
         "device.amplifier.charge_noise: 1 is 1 C; did you mean 1 fC?"),
    ],
)  # fmt: skip
def test_what_the_library_or_the_study_lacks_is_one_line(entries: dict[str, str], message: str) -> None:
    assert message in refusal(film(**entries))


def test_the_numbers_of_a_device_have_units() -> None:
    amplifier = "{input_capacitance: 10 pF, input_resistance: 1 TOhm, cable_capacitance: 1e-10, charge_noise: 2 fC}"
    study = made(film(more=f"device: {{electrode_length: 10 mm, amplifier: {amplifier}}}"))
    assert study.device is not None
    assert study.device.constants == {
        "electrode_length": 0.01, "input_capacitance": 10e-12, "input_resistance": 1e12, "cable_capacitance": 1e-10,
        "charge_noise": 2e-15, "voltage_noise": 0.0, "open_loop_gain": 1e6,
        "temperature": 293.15, "thermal_energy": pytest.approx(4.0474e-21, rel=1e-4, abs=0), "feedback_heat": 0.0,
    }  # fmt: skip
    assert thawed(study.frozen()).device == study.device


@pytest.mark.parametrize(
    ("limit", "name"),
    [("nominal_field <= 1 kV/mm", "thickness"), ("capacitance_per_length >= 1 nF/m", "capacitance_per_length")],
)
def test_a_half_plane_has_no_field_of_a_film(limit: str, name: str) -> None:
    text = film(limit=limit).replace("base: rigid, ", "").replace("radius: 0.05, ", "")
    text = text.replace("thickness: {low: 2e-4, high: 3e-4", "radius: {low: 0.02, high: 0.05")
    assert f"'{name}' is a film's: a half-plane has none" in refusal(text.replace("[thickness]", "[radius]"))
