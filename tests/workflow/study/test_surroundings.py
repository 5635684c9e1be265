"""Studies with air beside the contact and the punch of a device: quantities, fields, defaults, refusals."""

from pathlib import Path
from typing import Any

import pytest

from solver import solve
from solver.body import FILM_IN_AIR, HALF_PLANE_IN_AIR, POINT_FILM_IN_AIR, Kind
from solver.names import GAP_QUANTITIES, POINT_GAP_QUANTITIES
from storage.netcdf import read_whole
from tests.studies import made
from workflow.dataset import slabs
from workflow.design.search import targets
from workflow.learning import training
from workflow.report import exact
from workflow.study import defaults
from workflow.study.contents import Contents, Origin

#: A half-plane, whose tables are small.
AIR = """\
title: A half-plane in air
fixed: {material: PZT-4, radius: 0.05, magnetic: insulating, surroundings: air}
factors:
  load: {low: 1e4, high: 2e4, levels: 3}
"""


def test_what_only_some_surroundings_have_is_lacked() -> None:
    mixed = made(AIR.replace(", surroundings: air}", "}\ncategories: {surroundings: [insulated, air]}"))
    assert mixed.surroundings == ["insulated", "air"]
    assert mixed.absent >= {*GAP_QUANTITIES, "electric_edge_intensity_trailing", "capacitance_per_length"}
    assert "voltage[air]" in mixed.output_names
    assert mixed.narrowed({"surroundings": "insulated"}).stores_fields
    assert not mixed.stores_fields


GROUPS = """\
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
BALL = """\
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
        (GROUPS, FILM_IN_AIR, {*GAP_QUANTITIES}),
        (BALL, POINT_FILM_IN_AIR, {*POINT_GAP_QUANTITIES}),
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
    """A study of sections, with its surroundings."""
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
def test_a_device_is_pressed_by_steel_unless_it_or_its_groups_say_otherwise(
    sections: dict[str, Any], punch: str | None, said: str
) -> None:
    study = settled(**sections)
    defaults.press(study)
    assert study.fixed.get("punch") == punch
    assert study.elastic == (punch in ("steel", "brass") or "punch_modulus" in study.fixed)
    line = next((line for line in study.defaults if line.startswith("punch")), "")
    assert line.startswith(said)
    assert bool(line) == bool(said)


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
    solved = solve({"material": "PZT-4", "magnetic": "insulating", "surroundings": "air", **design.case})
    figure = next(row.figure_low for row in design.figures if row.figure == "circuit_capacitance")
    assert figure == pytest.approx(110e-12 + 0.01 * float(solved["capacitance_at_load"]), rel=1e-9)
