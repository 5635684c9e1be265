"""Studies of films: what their cases have, what their materials bear, and numbers of their device."""

import pytest

from solver import find
from solver.names import FILM_QUANTITIES, QUANTITIES
from tests.studies import edited, made, shipped
from workflow.study import coupling, datum
from workflow.study.allowable import allowable
from workflow.study.model import Study, thawed

FILM = """\
title: A film
fixed: {surroundings: insulated, composite: fibrous, radius: 0.05, interface_electric: grounded}
categories: {base: [rigid, steel]}
factors:
  load: {low: 2e4, high: 4e4, levels: 3, scale: log}
  thickness: {low: 2e-4, high: 3e-4, levels: 3, scale: log}
  friction: {low: 0.0, high: 0.3, levels: 3}
  volume_fraction: {low: 0.4, high: 0.6, levels: 3}
design:
  thin:
    maximise: abs(voltage_per_load)
    over: [thickness, base]
    at: {load: 3e4, friction: 0.0, volume_fraction: 0.5}
    subject_to: [nominal_field <= 3 kV/mm]
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(FILM)


def test_cases_have_the_quantities_of_films(study: Study) -> None:
    assert study.quantities == [*QUANTITIES, *FILM_QUANTITIES]
    # a nominal field bends where the voltage changes sign: designs take it from voltage and thickness
    assert set(study.quantities) - set(study.outputs) == {"nominal_field"}
    assert study.design["thin"].names() == ["voltage_per_load", "voltage", "thickness"]
    searched = study.model_copy(update={"dataset": study.dataset.model_copy(update={"peaks": True})})
    # no file holds a position where nothing is tensile, and a rigid base has no stresses
    assert set(searched.quantities) - set(study.quantities) == {
        "interface_shear", "interface_shear_position", "interface_tension", "film_peak_von_mises",
        "film_peak_principal_tension",
    }  # fmt: skip


def test_only_depths_on_a_base_that_gives_hang_on_the_datum(study: Study) -> None:
    rigid, steel = (study.narrowed({"base": base}) for base in ("rigid", "steel"))
    assert datum.hanging(rigid) == frozenset()
    # the interface to steel is bonded in the magnetic field: what a charge adds is relative, the load's part is not
    hangs = {"depth", "flux_per_force", "blocked_load_per_volt", "blocked_load_per_ampere"}
    assert datum.hanging(steel) == hangs == datum.hanging(study)
    charged = steel.model_copy(update={"fixed": {**steel.fixed, "magnetic_charge": 1e-4}})
    assert datum.hanging(charged) == {*hangs, "magnetic_potential"}
    assert datum.meaning("depth", datum.hanging(study)) == "indentation depth relative to the datum"


QUICKSTART = shipped("quickstart")


def made_of(**fixed: str | float) -> Study:
    """The quickstart of something else, without its designs."""
    factors = {name: axis for name, axis in QUICKSTART.factors.items() if name not in ("volume_fraction", "charge")}
    return QUICKSTART.model_copy(update={"fixed": fixed, "factors": factors, "design": {}})


def test_a_field_needs_a_material_that_couples_to_it_or_a_charge() -> None:
    assert coupling.fields(QUICKSTART) == {"electric", "magnetic"}
    assert coupling.fields(made_of(material="PZT-4")) == {"electric"}
    assert coupling.fields(made_of(material="CoFe2O4")) == {"magnetic"}
    assert coupling.fields(made_of(composite="AlScN", scandium_fraction=0.3)) == {"electric"}
    assert coupling.fields(made_of(material="glass")) == set()
    assert coupling.fields(made_of(material="glass", charge=1e-6)) == {"electric"}
    assert coupling.fields(shipped("paper")) == {"electric", "magnetic"}


def test_quantities_of_a_field_that_is_none_are_not_told_unless_they_are_asked_for() -> None:
    study = made_of(material="PZT-4")
    names = coupling.felt_outputs(study)
    assert {"voltage", "peak_pressure", "stroke_per_volt"} <= set(names)
    assert not {"magnetic_potential", "flux_per_force", "stroke_per_ampere", "permeance_per_length"} & set(names)
    surrogate = study.surrogate.model_copy(update={"outputs": ["depth", "magnetic_potential"]})
    assert coupling.felt_outputs(study.model_copy(update={"surrogate": surrogate})) == ["depth", "magnetic_potential"]
    assert coupling.felt_outputs(QUICKSTART) == QUICKSTART.outputs


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
