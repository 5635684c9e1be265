"""Studies of point contacts: what they accept, what their cases have, and the one line with which they are refused."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.constants import Boltzmann

import solver
from solver.body import HALF_SPACE
from solver.fields import POINT_FIELDS
from solver.names import POINT_QUANTITIES
from surrogate import Input
from tests.studies import data_set, fitted, made, shipped
from tests.workflow.study.test_model import POINT
from workflow.dataset import effects, factorial
from workflow.dataset import slabs as dataset
from workflow.design.search import targets
from workflow.design.wording import words
from workflow.learning import training
from workflow.report import page
from workflow.report.figures import field_panels
from workflow.report.figures.design_plots import figures_of
from workflow.study import representatives
from workflow.study.model import Study, remade

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


@pytest.fixture(scope="module")
def study() -> Study:
    return made(BALL)


def test_cases_have_the_quantities_of_points_and_no_datum(study: Study) -> None:
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


def test_the_data_set_holds_the_radial_fields(study: Study, tmp_path: Path) -> None:
    """Slab by slab, in metres that the group stands for: those that the solver has of the case."""
    data_set(study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": 2})}), tmp_path)
    data = dataset.open_results(tmp_path)
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
