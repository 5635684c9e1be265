"""Studies of layered bodies, points and surroundings: quantities, data sets, surrogates, designs, defaults."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.constants import Boltzmann

import solver
from solver.body import FILM_IN_AIR, HALF_PLANE_IN_AIR, HALF_SPACE, POINT_FILM_IN_AIR, Kind
from solver.fields import FIELDS, POINT_FIELDS
from solver.names import GAP_QUANTITIES, POINT_GAP_QUANTITIES, POINT_QUANTITIES
from storage.netcdf import read_whole
from surrogate import Input
from tests.studies import data_set, fitted, made, shipped
from tests.workflow.study.test_model import POINT
from workflow.dataset import effects, factorial, slabs
from workflow.design.search import targets
from workflow.design.search.contact_fields import fields
from workflow.design.wording import words
from workflow.learning import training
from workflow.report import exact, page
from workflow.report.figures import field_panels
from workflow.report.figures.design_plots import figures_of
from workflow.study import defaults, representatives
from workflow.study.contents import Contents, Origin
from workflow.study.model import remade, thawed

LAYERS = """\
title: A composite film on a copper electrode
fixed: {surroundings: insulated, radius: 0.05, friction: 0.1}
categories: {base: [rigid, silicon]}
body:
  - {composite: fibrous, volume_fraction: volume_fraction, thickness: 2e-4, below: {electric: grounded}}
  - {material: copper, thickness: copper_thickness}
factors:
  load: {low: 2e4, high: 4e4, levels: 5, scale: log}
  copper_thickness: {low: 4e-5, high: 6e-5, levels: 2}
  volume_fraction: {low: 0.48, high: 0.52, levels: 2}
dataset: {slabs: 1, positions: {inside: 3, outside: 2}}
surrogate: {outputs: [voltage, voltage_per_load, trailing_tension, depth]}
validation: {cases: 20, calibration: 40, tolerance: 1e-3}
design:
  thin:
    maximise: abs(voltage_per_load)
    over: [copper_thickness, base]
    at: {load: 3e4, volume_fraction: 0.5}
    subject_to: [nominal_field <= 3 kV/mm, copper_thickness <= 55 um]
"""


@pytest.fixture(scope="module")
def slab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("slabs") / "slab_0.nc"
    slabs.write_slab(made(LAYERS), 0, path)
    return path


HELD = {"surroundings": "insulated", "radius": 0.05, "friction": 0.1}


def stack(copper: float, fraction: float, base: str) -> solver.Stack:
    composite = solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), fraction)
    layers = [solver.Layer(composite, 2e-4, electric="grounded"), solver.Layer(solver.find("copper"), copper)]
    return solver.Stack(layers) if base == "rigid" else solver.Stack(layers, solver.find(base))


def test_every_case_of_the_data_set_is_the_solvers_stack_which_is_stored_frozen_and_drawn(slab: Path) -> None:
    study = made(LAYERS)
    whole = read_whole(slab)
    assert dict(whole.sizes) == {"copper_thickness": 2, "volume_fraction": 2, "load": 5, "base": 2, "position": 5}
    assert whole["copper_thickness"].attrs["units"] == "m"
    for place in ((0, 1, 4, 0), (1, 0, 1, 1)):
        stored = whole.isel(dict(zip(("copper_thickness", "volume_fraction", "load", "base"), place, strict=True)))
        body = stack(stored["copper_thickness"].item(), stored["volume_fraction"].item(), stored["base"].item())
        exact = solver.solve({**HELD, "body": body, "load": stored["load"].item()}, stored["position"].values)
        for name in (*study.quantities, *FIELDS):
            size = float(np.abs(whole[name]).max())
            np.testing.assert_allclose(stored[name], exact[name], rtol=1e-9, atol=1e-9 * size)
    words = whole.attrs["body"]
    assert words.startswith("fibrous, thickness = 200 µm")
    assert words.endswith("copper, thickness = copper_thickness | base")
    assert study.tabled == ["copper_thickness", "volume_fraction"]
    assert thawed(study.frozen()).physics == study.physics
    assert study.physics != study.model_copy(update={"body": study.body[:1]}).physics
    assert "copper" in str(page._problem(study))


def test_a_design_takes_a_lower_layers_thickness(slab: Path) -> None:
    study = made(LAYERS)
    answer = targets.solve_target(study, "thin", training.fit(study, read_whole(slab).drop_dims("position")))
    design = {name: answer.variable(name).value for name in study.factors}
    assert design["copper_thickness"] <= 55e-6 * (1 + 1e-9)
    base = answer.combination["base"]
    body = stack(design["copper_thickness"], design["volume_fraction"], base)
    case = {**HELD, "body": body, "load": design["load"]}
    exact = solver.solve(case)
    goal, field = abs(float(exact["voltage_per_load"])), float(exact["nominal_field"])
    assert answer.term("abs(voltage_per_load)").exact == pytest.approx(goal, rel=1e-9)
    assert answer.term("nominal_field <= 3 kV/mm").exact == pytest.approx(field, rel=1e-9)
    shown = fields(study.narrowed({"base": base}), design)
    below = solver.solve_interior(case, shown["x"].values, shown["y"].values, fields=["stress_xx"])
    np.testing.assert_allclose(shown["inside_stress_xx"], below["stress_xx"], rtol=1e-9, equal_nan=True)


BALL = """\
title: A ball on a film
fixed: {surroundings: insulated, material: PZT-4, profile: sphere, punch: steel, base: steel}
factors:
  thickness: {low: 20 um, high: 200 um, scale: log}
  radius: {low: 5 mm, high: 50 mm, scale: log}
  force: {low: 10 mN, high: 500 mN, scale: log}
groups:
  force * radius / thickness^3: {levels: 4}
device: {amplifier: {input_capacitance: 10 pF, charge_noise: 1 fC}}
design:
  quiet:
    minimise: smallest_force
    over: [thickness, radius]
    at: {force: 0.1}
    subject_to: [abs(signal_charge) <= 100 pC, force <= 1 N, peak_pressure <= depoling_stress]
"""


def test_cases_have_the_quantities_of_points_and_no_datum() -> None:
    study = made(BALL)
    assert set(study.quantities) == {*POINT_QUANTITIES, "nominal_field"}
    assert study.meeting == "point"
    assert study.stores_fields
    assert not study.elastic  # in space an elastic punch has no datum of its own
    assert list(study.axes) == ["force_radius_per_thickness3"]


@pytest.mark.parametrize(("goal", "friction"), [("trailing_tension", 0.0), ("peak_pressure", None)])
def test_what_friction_adds_is_asked_of_points_that_rest(goal: str, friction: float | None) -> None:
    """Without naming a friction, which is then 0; where nothing of it is asked for, none is named."""
    study = made(f"{POINT}design: {{gentle: {{minimise: {goal}, over: [force]}}}}\n")
    assert study.fixed.get("friction") == friction
    assert goal in study.quantities
    assert remade(study).fixed == study.fixed


EFFECTS = """\
title: Points
effects:
  baseline: {material: BaTiO3, profile: sphere, radius: 5 mm, slope: 0.01, width: 200 um, force: 1.0}
  vary: {profile: [sphere, cone, disc], force: [0.5, 1.0]}
  positions: {inside: 8, outside: 4}
"""


def test_effects_of_points_have_their_fields_over_the_distance_from_the_middle() -> None:
    study = made(EFFECTS)
    assert study.kind is HALF_SPACE
    of_force, of_profile = (effects.effect(study, name) for name in ("force", "profile"))
    assert of_force.attrs["fields"].split() == list(POINT_FIELDS)
    middle = np.abs(of_force["position"].values) < 0.2
    assert (of_force["contact_pressure"].diff("force").values[..., middle] > 0).all()
    assert "peak_pressure" not in of_profile  # infinite under a cone and at the rim of a disc
    drawn = field_panels.effect(of_force, ["electric", "magnetic"])
    shown = [ax.get_xlabel() for ax in drawn.axes if ax.get_visible()]
    # nothing couples magnetically: what is zero everywhere is not drawn; the last panel is over lengths
    assert len(shown) == len(POINT_FIELDS)
    assert "r/a" in shown
    assert shown[-1] == "x [µm]"


def test_the_data_set_holds_the_radial_fields(tmp_path: Path) -> None:
    """Slab by slab, in metres that the group stands for: those that the solver has of the case."""
    study = made(BALL)
    data_set(study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": 2})}), tmp_path)
    data = slabs.open_results(tmp_path)
    assert set(POINT_FIELDS) <= set(data.data_vars)
    assert data["position"].attrs["long_name"].startswith("surface position r/a")
    stored = data.isel(force_radius_per_thickness3=2)
    group = {name: levels[2:3] for name, levels in factorial.axes(study).items()}
    exact = solver.solve(study.fixed | representatives.factors(study, group), stored["position"].values).squeeze()
    for name in POINT_FIELDS:
        size = float(np.abs(exact[name]).max())
        np.testing.assert_allclose(stored[name], exact[name], rtol=1e-10, atol=1e-10 * size, err_msg=name)
    sliding = study.model_copy(update={"fixed": study.fixed | {"friction": 0.2}})
    assert not sliding.stores_fields


def test_the_surrogate_of_a_probe_is_right_to_1e_5_of_the_range_within_its_box() -> None:
    """A pressure over force / thickness^2 spans eight decades, apart in the box: by its logarithm."""
    whole = shipped("probe").narrowed({"base": "silicon"})
    surrogate = whole.surrogate.model_copy(update={"outputs": ["peak_pressure", "depth"]})
    probe = whole.model_copy(update={"surrogate": surrogate})
    model = fitted(probe)
    shares, boxes = np.random.default_rng(5).uniform(size=(4, 60)), probe.factors.items()
    points = {
        name: xr.DataArray(Input(name, axis.low, axis.high, axis.scale).from_unit(2 * share - 1), dims="case")
        for (name, axis), share in zip(boxes, shares, strict=True)
    }
    exact, answered = factorial.training_data(probe, factorial.exact(probe, dict(points))), model.predict(points)
    for name in model.outputs_:
        size = float(np.ptp(exact[name].values))
        np.testing.assert_allclose(answered[name], exact[name], rtol=0, atol=1e-5 * size, err_msg=name)


def test_a_design_in_groups_is_what_the_solver_says() -> None:
    """One axis stands for three factors; the depoling stress of PZT-4 limits the design."""
    text = BALL.replace("{levels: 4}", "{levels: 14, scale: log}").replace("steel}", "steel, magnetic: insulating}")
    text = text.replace("over: [thickness, radius]", "over: [radius]").replace(
        "{force: 0.1}", "{thickness: 50 um, force: 0.2}"
    )
    text = text.replace("abs(signal_charge) <= 100 pC, force <= 1 N, ", "")
    outputs = "surrogate: {outputs: [contact_radius, charge_per_force, capacitance, peak_pressure]}\n"
    study = made(f"{text}{outputs}validation: {{cases: 20, calibration: 60, tolerance: 1e-3}}\n")
    model, exact = fitted(study), factorial.exact(study, factorial.axes(study))
    assert dict(exact.sizes) == {"force_radius_per_thickness3": 14}
    table = training.validate(study, exact, factorial.cases(study, "validation"), model)
    assert float(table["max_error"].max()) < 1e-3
    answer = targets.solve_target(study, "quiet", model)
    solved = solver.solve(study.fixed | answer.case)
    assert float(solved["peak_pressure"]) == pytest.approx(83e6, rel=1e-3)
    capacitance = float(solved["capacitance"]) + 10e-12
    noise = np.hypot(1e-15, np.sqrt(Boltzmann * 293.15 * capacitance))
    assert answer.terms[0].exact == pytest.approx(noise / abs(float(solved["charge_per_force"])), rel=1e-9)
    figures = {figure.figure: figure.figure_low for figure in answer.figures}
    assert figures["signal_charge"] == pytest.approx(0.2 * float(solved["charge_per_force"]), rel=1e-9)
    assert figures["circuit_capacitance"] == pytest.approx(capacitance, rel=1e-9)
    assert "force" not in figures
    assert "contact" in figures_of(answer, study.design["quiet"])  # over r/a
    assert words.verdict(answer).device
    assert "film" in str(page._problem(study))


DESIGNED = """\
title: A half-plane in air
fixed: {material: PZT-4, magnetic: insulating, surroundings: air}
factors:
  radius: {low: 0.03, high: 0.05, levels: 3, scale: log}
  load: {low: 8e3, high: 1.2e4, levels: 2, scale: log}
dataset: {slabs: 1, positions: {inside: 4, outside: 2}}
surrogate: {outputs: [peak_pressure, charge_per_force, capacitance_at_load]}
validation: {cases: 20, calibration: 40, tolerance: 0.05}
device: {electrode_length: 10 mm, amplifier: {input_capacitance: 10 pF, cable_capacitance: 100 pF}}
design:
  voltage:
    maximise: abs(signal_voltage)
    over: [radius]
    at: {load: 1e4}
    subject_to: [peak_pressure <= 90 MPa]
"""
#: A half-plane, whose tables are small.
AIR = DESIGNED.split("dataset:")[0]


def test_what_only_some_surroundings_have_is_lacked() -> None:
    mixed = made(AIR.replace(", surroundings: air}", "}\ncategories: {surroundings: [insulated, air]}"))
    assert mixed.surroundings == ["insulated", "air"]
    assert mixed.absent >= {*GAP_QUANTITIES, "electric_edge_intensity_trailing", "capacitance_per_length"}
    assert "voltage[air]" in mixed.output_names
    assert mixed.narrowed({"surroundings": "insulated"}).stores_fields
    assert not mixed.stores_fields


AIR_FILM = """\
title: A film in air, by groups
fixed: {material: PZT-4, magnetic: insulating, surroundings: air, base: steel}
factors:
  radius: {low: 0.02, high: 0.05, scale: log}
  load: {low: 5e3, high: 2e4, scale: log}
  thickness: {low: 2e-4, high: 4e-4, scale: log}
groups:
  load * radius / thickness^2: {levels: 3}
  radius / thickness: {levels: 3}
"""
AIR_BALL = """\
title: A ball on a film in air, by groups
fixed: {material: PZT-4, profile: sphere, magnetic: insulating, surroundings: air, base: rigid}
factors:
  radius: {low: 0.02, high: 0.05, scale: log}
  force: {low: 1.0, high: 4.0, scale: log}
  thickness: {low: 2e-4, high: 4e-4, scale: log}
groups:
  force * radius / thickness^3: {levels: 2}
  radius / thickness: {levels: 2}
"""


@pytest.mark.parametrize(
    ("text", "kind", "names"),
    [
        (AIR, HALF_PLANE_IN_AIR, {*GAP_QUANTITIES, "capacitance_per_length"}),
        (AIR_FILM, FILM_IN_AIR, {*GAP_QUANTITIES}),
        (AIR_BALL, POINT_FILM_IN_AIR, {*POINT_GAP_QUANTITIES}),
    ],
)
def test_cases_in_air_have_its_quantities_and_store_no_fields(text: str, kind: Kind, names: set[str]) -> None:
    study = made(text)
    assert study.kind is kind
    assert study.costly >= {*study.quantities} >= {*names, "voltage"}
    assert not [name for name in study.quantities if "edge_intensity" in name]
    assert not study.stores_fields  # but where positions are given: the study with a design, below


BOX = {
    "radius": {"low": 0.02, "high": 0.05},
    "thickness": {"low": 1e-4, "high": 2e-4},
    "load": {"low": 1e4, "high": 2e4},
}
DEVICE = {"electrode_length": "10 mm", "amplifier": {"input_capacitance": "10 pF", "charge_noise": "1 fC"}}


def settled(*, fixed: dict[str, object] | None = None, **sections: object) -> Contents:
    """A roller on a film with an amplifier, as far as it is read: nothing is solved."""
    axes = {"thickness": {"low": 1e-4, "high": 2e-4, "levels": 2}, "load": {"low": 1e4, "high": 2e4, "levels": 2}}
    usual = {"material": "PZT-4", "base": "steel", "interface_electric": "grounded", **(fixed or {})}
    held = usual if "groups" in sections else {"radius": 0.05, **usual}
    return read({"title": "A film", "fixed": held, "factors": axes, "device": DEVICE, **sections})


def read(content: dict[str, object]) -> Contents:
    study = Contents.model_validate(content, context=Origin(Path(), {}))
    defaults.surround(study)
    return study


def test_a_device_is_in_air_unless_it_says_otherwise() -> None:
    study = settled()
    assert study.surroundings == ["air"]
    assert study.meeting == "line in air"
    assert study.defaults[0].startswith("surroundings: air, the default of films and devices")
    said = settled(fixed={"surroundings": "insulated"})
    assert (said.surroundings, said.defaults) == (["insulated"], ())
    assert settled(device=None).surroundings == ["air"]
    axes = {"load": {"low": 1e4, "high": 2e4, "levels": 2}}
    bare = read({"title": "A half-plane", "fixed": {"material": "PZT-4", "radius": 0.05}, "factors": axes})
    assert (bare.surroundings, bare.defaults, bare.meeting) == (["insulated"], (), "line")


@pytest.mark.parametrize(
    ("sections", "why"),
    [
        ({"fixed": {"electric": "insulating", "magnetic": "insulating"}}, "conducts no field"),
        ({"fixed": {"profile": "flat", "width": 1e-4, "slope": 0.0}}, "no narrow gap with an end"),
        ({"categories": {"profile": ["cylinder", "sphere"]}}, "more than one kind"),
        ({"dataset": {"positions": {"inside": 12, "outside": 6}}}, "ask for fields"),
        ({"factors": BOX, "groups": {"load * radius / thickness^2": {"levels": 3}}}, "make radius / thickness a group"),
        ({"surrogate": {"outputs": ["capacitance_per_length"]}}, "capacitance_at_load"),
    ],
)
def test_what_air_does_not_have_leaves_a_device_insulated(sections: dict[str, dict[str, object]], why: str) -> None:
    study = settled(**sections)
    assert study.surroundings == ["insulated"]
    assert study.meeting == "line"
    assert why in study.defaults[0]


@pytest.mark.parametrize(
    ("sections", "punch", "said"),
    [
        ({}, "steel", "punch: steel, the default of a study with a device"),
        ({"fixed": {"punch": "rigid"}}, "rigid", ""),
        ({"fixed": {"punch": "brass"}}, "brass", ""),
        ({"fixed": {"punch_modulus": 7e10, "punch_poisson": 0.3}}, None, ""),
        ({"device": None}, None, ""),
        (
            {
                "factors": BOX, "groups": {"load * radius / thickness^2": {"levels": 3}},
                "surrogate": {"outputs": ["depth", "voltage"]},
            }, None, "punch: rigid, since its groups do not tell what one of steel makes of its surrogate.outputs",
        ),
    ],
)  # fmt: skip
def test_a_device_is_pressed_by_steel_by_default(sections: dict[str, Any], punch: str | None, said: str) -> None:
    study = settled(**sections)
    defaults.press(study)
    assert study.fixed.get("punch") == punch
    assert study.elastic == (punch in ("steel", "brass") or "punch_modulus" in study.fixed)
    line = next((line for line in study.defaults if line.startswith("punch")), "")
    assert line.startswith(said)
    assert bool(line) == bool(said)


def test_data_and_design_of_a_study_in_air(tmp_path: Path) -> None:
    study = made(DESIGNED)
    assert study.stores_fields
    slabs.write_slab(study, 0, tmp_path / "slab_0.nc")
    data = read_whole(tmp_path / "slab_0.nc")
    assert {"capacitance_at_load", "gap_field"} <= set(data.data_vars)
    assert data.sizes["position"] == 6
    assert float(abs(data["electric_displacement_y"].isel(position=0)).min()) > 0  # beside the contact
    model = training.fit(study, data.drop_dims("position"))
    design = targets.solve_target(study, "voltage", model)
    in_air, other = exact.solved(study, {"voltage": design})["designs"]["voltage"]["around"]["quantities"]["voltage"]
    assert in_air / other < 0.95
    solved = solver.solve({"material": "PZT-4", "magnetic": "insulating", "surroundings": "air", **design.case})
    figure = next(row.figure_low for row in design.figures if row.figure == "circuit_capacitance")
    assert figure == pytest.approx(110e-12 + 0.01 * float(solved["capacitance_at_load"]), rel=1e-9)
