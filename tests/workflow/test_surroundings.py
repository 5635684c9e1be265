"""A study with air beside the contact, run to its page."""

import json
from collections.abc import Callable

import pytest

from solver import solve
from tests.workflow.conftest import Project
from workflow.dataset.slabs import open_results
from workflow.design.verdict import netcdf

STUDY = """\
title: A half-plane in air
fixed: {material: PZT-4, magnetic: insulating, surroundings: air}
factors:
  radius: {low: 0.03, high: 0.05, levels: 3, scale: log}
  load: {low: 8e3, high: 1.2e4, levels: 3, scale: log}
dataset: {slabs: 1, positions: {inside: 4, outside: 2}}
surrogate: {outputs: [peak_pressure, charge_sensitivity, capacitance_at_load]}
validation: {cases: 20, calibration: 40, tolerance: 0.05}
device: {electrode_length: 10 mm, amplifier: {input_capacitance: 10 pF, cable_capacitance: 100 pF}}
design:
  voltage:
    maximise: abs(signal_voltage)
    over: [radius]
    at: {load: 1e4}
    subject_to: [peak_pressure <= 90 MPa]
"""


def test_a_study_in_air_runs_to_its_page_with_fields(copy: Callable[[str], Project]) -> None:
    project = copy("air")
    (project.folder / "config" / "air.yaml").write_text(STUDY, encoding="utf-8")
    project.run("meecontact", "run", "air", "--cores", "2")
    folder = project.folder / "results" / "air"
    data = open_results(folder)
    assert {"capacitance_at_load", "gap_field"} <= set(data.data_vars)
    assert data.sizes["position"] == 6
    assert float(abs(data["electric_displacement_y"].isel(position=0)).min()) > 0  # beside the contact
    told = json.loads((folder / "solved.json").read_text(encoding="utf-8"))["designs"]["voltage"]
    own, other = told["around"]["quantities"]["voltage"]
    assert own / other < 0.95
    design = netcdf.read(folder / "design" / "voltage.nc")
    case = {"material": "PZT-4", "magnetic": "insulating", "surroundings": "air", **design.case}
    figure = next(one.figure_low for one in design.figures if one.figure == "circuit_capacitance")
    assert figure == pytest.approx(110e-12 + 0.01 * float(solve(case)["capacitance_at_load"]), rel=1e-9)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert (
        "Air is beside the contact and carries charge (surroundings: air); with insulated surroundings: voltage" in page
    )
    assert "the punch hangs in air" in page
    assert 'id="figure-contact_voltage"' in page
