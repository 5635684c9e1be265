"""Studies of layered bodies: the solver's stacks in data set, surrogate and designs, and how bad ones are refused."""

from pathlib import Path

import numpy as np
import pytest

import solver
from solver.fields import FIELDS
from storage.netcdf import read_whole
from tests.studies import made
from workflow.dataset import slabs as dataset
from workflow.design.search import targets
from workflow.design.search.contact_fields import fields
from workflow.learning import training
from workflow.report import page
from workflow.study.model import Study, thawed

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
def study() -> Study:
    return made(LAYERS)


@pytest.fixture(scope="module")
def slab(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("slabs") / "slab_0.nc"
    dataset.write_slab(study, 0, path)
    return path


def stack(copper: float, fraction: float, base: str) -> solver.Stack:
    top = solver.Layer(
        solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), fraction), 2e-4, electric="grounded"
    )
    layers = [top, solver.Layer(solver.find("copper"), copper)]
    return solver.Stack(layers) if base == "rigid" else solver.Stack(layers, solver.find(base))


def test_every_case_of_the_data_set_is_the_solvers_stack(study: Study, slab: Path) -> None:
    whole = read_whole(slab)
    assert dict(whole.sizes) == {"copper_thickness": 2, "volume_fraction": 2, "load": 5, "base": 2, "position": 5}
    assert whole["copper_thickness"].attrs["units"] == "m"
    for place in ((0, 1, 4, 0), (1, 0, 1, 1)):
        stored = whole.isel(dict(zip(("copper_thickness", "volume_fraction", "load", "base"), place, strict=True)))
        body = stack(stored["copper_thickness"].item(), stored["volume_fraction"].item(), stored["base"].item())
        case = {
            "surroundings": "insulated", "body": body, "radius": 0.05, "friction": 0.1, "load": stored["load"].item(),
        }  # fmt: skip
        exact = solver.solve(case, stored["position"].values)
        for name in (*study.quantities, *FIELDS):
            np.testing.assert_allclose(
                stored[name], exact[name], rtol=1e-9, atol=1e-9 * float(np.abs(whole[name]).max())
            )


def test_a_design_takes_a_lower_layers_thickness(study: Study, slab: Path) -> None:
    answer = targets.solve_target(study, "thin", training.fit(study, read_whole(slab).drop_dims("position")))
    design = {name: answer.variable(name).value for name in study.factors}
    assert design["copper_thickness"] <= 55e-6 * (1 + 1e-9)
    base = answer.combination["base"]
    body = stack(design["copper_thickness"], design["volume_fraction"], base)
    case = {"surroundings": "insulated", "body": body, "radius": 0.05, "friction": 0.1, "load": design["load"]}
    exact = solver.solve(case)
    for term, value in (
        ("abs(voltage_per_load)", abs(exact["voltage_per_load"])),
        ("nominal_field <= 3 kV/mm", exact["nominal_field"]),
    ):
        assert answer.term(term).exact == pytest.approx(float(value), rel=1e-9)
    shown = fields(study.narrowed({"base": base}), design)
    below = solver.solve_interior(case, shown["x"].values, shown["y"].values, fields=["stress_xx"])
    np.testing.assert_allclose(shown["inside_stress_xx"], below["stress_xx"], rtol=1e-9, equal_nan=True)


def test_a_body_is_stored_frozen_and_drawn(study: Study, slab: Path) -> None:
    words = read_whole(slab).attrs["body"]
    assert words.startswith("fibrous, thickness = 200 µm")
    assert words.endswith("copper, thickness = copper_thickness | base")
    assert study.tabled == ["copper_thickness", "volume_fraction"]
    assert thawed(study.frozen()).physics == study.physics
    assert study.physics != study.model_copy(update={"body": study.body[:1]}).physics
    assert "copper" in str(page._problem(study))
