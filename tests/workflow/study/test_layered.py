"""Studies of layered bodies: the solver's stacks in data set, surrogate and designs, and how bad ones are refused."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import solver
from solver.fields import FIELDS
from storage.netcdf import read_whole
from tests.studies import edited, fitted, made, refusal
from workflow.dataset import datacard, factorial
from workflow.dataset import slabs as dataset
from workflow.design.search import targets
from workflow.design.search.contact_fields import fields
from workflow.report import exact as report
from workflow.report import firstscreen, page
from workflow.study.datum import hanging
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
  copper_thickness: {low: 4e-5, high: 6e-5, levels: 3}
  volume_fraction: {low: 0.48, high: 0.52, levels: 2}
dataset: {slabs: 1, positions: {inside: 3, outside: 2}}
surrogate: {outputs: [voltage, voltage_per_load, trailing_tension, depth]}
validation: {cases: 20, calibration: 60, tolerance: 1e-3}
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
    assert dict(whole.sizes) == {"copper_thickness": 3, "volume_fraction": 2, "load": 5, "base": 2, "position": 5}
    assert whole["copper_thickness"].attrs["units"] == "m"
    for place in ((0, 1, 4, 0), (2, 0, 1, 1)):
        stored = whole.isel(dict(zip(("copper_thickness", "volume_fraction", "load", "base"), place, strict=True)))
        body = stack(stored["copper_thickness"].item(), stored["volume_fraction"].item(), stored["base"].item())
        case = {
            "surroundings": "insulated",
            "body": body,
            "radius": 0.05,
            "friction": 0.1,
            "load": stored["load"].item(),
        }
        exact = solver.solve(case, stored["position"].values)
        for name in (*study.quantities, *FIELDS):
            np.testing.assert_allclose(
                stored[name], exact[name], rtol=1e-9, atol=1e-9 * float(np.abs(whole[name]).max())
            )


ONE = """\
title: one
fixed: {surroundings: insulated, radius: 0.05, friction: 0.1, load: 3e4, base_poisson: 0.3}
body: [{composite: laminate, volume_fraction: volume_fraction, thickness: thickness}]
factors:
  thickness: {low: 2e-4, high: 3e-4, levels: 2}
  volume_fraction: {low: 0.4, high: 0.6, levels: 2}
  base_modulus: {low: 1e11, high: 2e11, levels: 2}
"""


def test_a_body_of_one_layer_is_the_film_of_the_same_factors() -> None:
    """Two ways through the face to one number, with every factor of the body an axis of the cases."""
    study = made(ONE)
    values = ([2e-4, 3e-4, 2.5e-4], [0.4, 0.5, 0.6], [1e11, 2e11, 2e11])
    axes = {name: xr.DataArray(column, dims="case") for name, column in zip(study.factors, values, strict=True)}
    answers = factorial.exact(study, axes)
    film = solver.solve({**study.fixed, **axes, "composite": "laminate"})
    for name in study.quantities:
        np.testing.assert_allclose(answers[name], film[name], rtol=1e-11, atol=1e-12 * float(np.abs(film[name]).max()))


def test_a_design_takes_a_lower_layers_thickness(study: Study) -> None:
    answer = targets.solve_target(study, "thin", fitted(study, calibrated=True))
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
    ends = report.contact(study, answer)
    assert ends["contact_leading"] == pytest.approx(float(exact["contact_leading"]), rel=1e-9)
    build = firstscreen.answered(study, "thin", study.design["thin"], answer, ends, {}).build.partition(";")[0]
    assert build.replace("\N{NO-BREAK SPACE}", " ").startswith("Fibrous, 50 % BaTiO3, 200 µm on copper, ")
    assert build.endswith(" on a rigid base" if base == "rigid" else " on silicon")
    shown = fields(study.narrowed({"base": base}), design)
    below = solver.solve_interior(case, shown["x"].values, shown["y"].values, fields=["stress_xx"])
    np.testing.assert_allclose(shown["inside_stress_xx"], below["stress_xx"], rtol=1e-9, equal_nan=True)


def test_a_body_tells_what_it_is(study: Study, slab: Path) -> None:
    words = ["fibrous, thickness = 200 µm, volume_fraction = volume_fraction, electric interface = grounded",
             "copper, thickness = copper_thickness"]  # fmt: skip
    assert read_whole(slab).attrs["body"] == " | ".join([*words, "base"])
    assert f"Layer 2: {words[1]}" in datacard.markdown(datacard.card(study, "layers", [slab], []))
    assert study.tabled == ["copper_thickness", "volume_fraction"]
    assert "voltage" not in hanging(study)
    again = thawed(study.frozen())
    assert (
        again.physics
        == study.physics
        != study.model_copy(update={"surroundings": "insulated", "body": study.body[:1]}).physics
    )
    drawing = str(page._problem(study))
    assert "copper" in drawing
    assert "layers on their base" in drawing


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("  copper_thickness: {", "  zinc_thickness: {", "body.1: thickness: 'copper_thickness' is neither in factors"),
        ("radius: 0.05", "radius: 0.05, x_thickness: 1e-3", "fixed: x_thickness: no layer of the body names it"),
        ("[rigid, silicon]", "[rigid, silicom]", "base: 'silicom' is unknown; did you mean 'silicon'?"),
        ("categories: {base: [rigid, silicon]}\n", "", "base: a body needs a base, or else base_modulus and base_poi"),
        ("radius: 0.05", "radius: 0.05, base_poisson: 0.3", "base, base_poisson: a body needs a base, or else"),
        ("material: copper", "material: coper", "body.1: material: 'coper' is unknown; did you mean 'copper'?"),
        ("material: copper, ", "", "body.1: material: give either a material or a composite"),
        ("copper, t", "copper, volume_fraction: 0.5, t", "body.1: volume_fraction: copper has none"),
        ("volume_fraction: volume_fraction, ", "", "body.0: volume_fraction: missing; must be a finite number >= 0"),
        ("s: copper_thickness", "s: copper", "body.1: thickness: 'copper' is no name of such a factor; must be thick"),
        ("s: copper_thickness", "s: thickness", "body.1: thickness: 'thickness' must be <word>_thickness, or a number"),
        ("thickness: 2e-4", "thickness: top_thickness", "body.0: thickness: 'top_thickness' must be thickness, or a"),
        ("thickness: 2e-4", "thickness: -2e-4", "body.0: thickness: -0.0002 is not a finite number > 0 [m]"),
        ("low: 4e-5", "low: -1e-3", "factors: copper_thickness: -0.001 is not a finite number > 0 [m]"),
        ("{electric: grounded}", "{magnetic: insulated}", "interface_magnetic: 'insulated' is allowed above a rigid"),
        ("radius: 0.05", "radius: 0.05, thickness: 1e-4", "thickness: beside a body; a stack has its own materials"),
        ("copper_thickness <= 55 um", "copper_thickness <= 55 V", "design.thin: 'copper_thickness <= 55 V': unit mism"),
    ],
)  # fmt: skip
def test_bad_bodies_are_refused_in_one_line(old: str, new: str, expected: str) -> None:
    assert refusal(edited(LAYERS, old, new)).startswith(expected)
