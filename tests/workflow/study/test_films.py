"""Materials and films of a study: quantities, fields, what materials bear, uncertain constants, devices."""

import numpy as np
import pytest

from solver import Material, find, solve
from solver.names import FILM_QUANTITIES, QUANTITIES
from solver.names import THERMAL as NAMES
from tests.studies import edited, made, shipped
from workflow.dataset import factorial
from workflow.study import coupling, datum, uncertainty
from workflow.study.allowable import allowable
from workflow.study.model import Study, load, thawed
from workflow.study.target import Distribution

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


def test_cases_have_the_quantities_of_films() -> None:
    study = made(FILM)
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


def test_only_depths_on_a_base_that_gives_hang_on_the_datum() -> None:
    study = made(FILM)
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
    # quantities of a field that is none are not told unless they are asked for
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
    yields = allowable("base_yield_strength", {"base": "steel"}, {}, [])
    assert yields.value == find("steel").limits["yield_strength"].value
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


UNCERTAIN = """\
title: A film on steel
fixed: {surroundings: insulated,
        composite: fibrous, volume_fraction: 0.5, friction: 0.1, radius: 0.05, interface_electric: grounded,
        interface_magnetic: grounded}
categories: {base: [rigid, steel]}
factors:
  thickness: {low: 2e-4, high: 6e-4, levels: 6, scale: log}
  load: {low: 2e4, high: 1e5, levels: 6, scale: log}
surrogate: {outputs: [depth, contact_trailing, voltage]}
"""


def test_families_and_their_priors() -> None:
    film = made(UNCERTAIN)
    priors = {constant.name: constant.std for constant in uncertainty.uncertain(film)}
    assert list(priors) == [
        "BaTiO3 stiffness", "BaTiO3 piezoelectricity", "BaTiO3 permittivity", "BaTiO3 permeability",
        "CoFe2O4 stiffness", "CoFe2O4 piezomagnetism", "CoFe2O4 permittivity", "CoFe2O4 permeability",
        "steel modulus", "steel poisson",
    ]  # fmt: skip
    other = find("BaTiO3 (alternative 1)")
    off = np.mean([np.log(other.eps11 / find("BaTiO3").eps11), np.log(other.eps33 / find("BaTiO3").eps33)])
    assert priors["BaTiO3 permittivity"] == pytest.approx(abs(off))
    alloy = "title: An alloy\nfixed: {composite: AlScN, scandium_fraction: 0.3, radius: 0.05}\n"
    assert not uncertainty.materials(made(f"{alloy}factors: {{load: {{low: 1e4, high: 2e4, levels: 3}}}}\n"))
    assert {priors["steel poisson"], priors["steel modulus"], priors["CoFe2O4 stiffness"]} == {0.02, 0.05}


def test_the_first_design_question_tells_the_distribution_of_a_factor() -> None:
    study = shipped("peaks")
    narrow = study.design["poled"].model_copy(update={"uncertain": {"friction": Distribution(uniform=[0.1, 0.2])}})
    pair = study.model_copy(update={"design": {"narrow": narrow, "poled": study.design["poled"]}})
    assert pair.distributions == {"friction": Distribution(uniform=[0.1, 0.2])}


def test_a_moved_study_is_solved_with_moved_constants() -> None:
    film = made(UNCERTAIN)
    constants = uncertainty.uncertain(film, {"steel modulus": 0.1, "steel poisson": None, "BaTiO3 e33": 0.2})
    moved = uncertainty.moved(film, constants, np.array([1.0, -1.0, 0.5]))
    case = {"thickness": 3e-4, "load": 5e4}
    answer = factorial.exact(moved, {**case, "base": "steel"})
    ceramic = find("BaTiO3").plain() | {"e33": 18.6 * np.exp(0.1), "alternatives": []}
    base = Material.isotropic(200e9 * np.exp(0.1), 0.28, name="steel")
    exact = solve({**film.fixed, **case, "base": base}, phases=(Material.from_mapping(ceramic), "CoFe2O4"))
    for name in ("voltage", "depth", "capacitance_per_length"):
        assert float(answer[name]) == pytest.approx(float(exact[name]), rel=1e-9)
    assert uncertainty.concerned(film, constants[0]) == {"base": "steel"}
    assert uncertainty.concerned(film, constants[2]) == {}
    assert [constant.change(1.0) for constant in constants] == ["+10.5 %", "+0.02", "+22.1 %"]


def test_alternatives_that_differ_by_more_than_30_percent_are_solved() -> None:
    """A square moves by the square of the alternative's ratio, where a first-order product of 2 x 128 % is 256 %."""
    study = made(UNCERTAIN.replace("[rigid, steel]", "[steel, polyimide]"))
    constants = [constant for constant in uncertainty.uncertain(study) if constant.family == "modulus"]
    assert [constant.name for constant in constants] == ["steel modulus", "polyimide modulus"]

    def squares(study: Study) -> np.ndarray:
        return np.array([float(find(name, study.own_materials).c11) ** 2 for name in ("steel", "polyimide")])

    ratio = float(find("polyimide (alternative 1)").c11 / find("polyimide").c11)
    assert ratio > 1 + uncertainty._WIDE
    shares = uncertainty.sensitivities(study, constants, squares)
    assert shares == pytest.approx(np.diag([2 * 0.05, ratio**2 - 1]), rel=1e-4)  # the difference quotient's own 1e-5


def test_the_time_of_heat_spreads_by_the_covers_conductivity() -> None:
    study = load("config/taxel.yaml")
    case = {"thickness": 3e-3, "force": 0.02, "patch_position": 0.0, "feedback_resistance": 1e12}
    constants = {constant.name: constant for constant in uncertainty.uncertain(study)}
    cover = constants["PDMS conductivity"]
    (share,) = uncertainty.sensitivities(
        study, [cover], lambda moved: factorial.exact(moved, case)["heat_time"].values.ravel()
    )[0]
    assert share == pytest.approx(-cover.std, rel=0.03)  # h^2 c/kappa: the film below is thin, the charge leaks slowly
    assert not {constant.family for constant in uncertainty.uncertain(made(UNCERTAIN))} & {*NAMES}
