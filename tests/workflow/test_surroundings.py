"""A study with air beside the contact: its data, design and what is told of them, and run to its page."""

from pathlib import Path

import pytest

from solver import solve
from storage.netcdf import read_whole
from tests.studies import made
from workflow.dataset import slabs
from workflow.design.search import targets
from workflow.learning import training
from workflow.report import exact

STUDY = """\
title: A half-plane in air
fixed: {material: PZT-4, magnetic: insulating, surroundings: air}
factors:
  radius: {low: 0.03, high: 0.05, levels: 3, scale: log}
  load: {low: 8e3, high: 1.2e4, levels: 3, scale: log}
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
    study = made(STUDY)
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
