"""A small study of a ball on a film, run whole."""

import re

import numpy as np
import pytest
from scipy.constants import Boltzmann

from solver import solve
from storage.netcdf import read_whole
from tests.workflow.conftest import Copy, Project
from workflow.dataset.slabs import open_results
from workflow.design.verdict import netcdf

BALL = """\
title: A ball on a film
fixed: {surroundings: insulated, material: PZT-4, profile: sphere, punch: steel, base: steel, magnetic: insulating}
factors:
  thickness: {low: 20 um, high: 200 um, scale: log}
  radius: {low: 5 mm, high: 50 mm, scale: log}
  force: {low: 10 mN, high: 500 mN, scale: log}
groups:
  force * radius / thickness^3: {levels: 14, scale: log}
dataset: {slabs: 1}
surrogate: {outputs: [contact_radius, charge_per_force, capacitance, peak_pressure]}
validation: {cases: 20, calibration: 60, tolerance: 1e-3}
device: {amplifier: {input_capacitance: 10 pF, charge_noise: 1 fC}}
design:
  quiet:
    minimise: smallest_force
    over: [radius]
    at: {thickness: 50 um, force: 0.2}
    subject_to: [peak_pressure <= depoling_stress]
"""


@pytest.fixture(scope="module")
def ball(copy: Copy) -> Project:
    project = copy("ball")
    (project.folder / "config/ball.yaml").write_text(BALL, encoding="utf-8")
    project.run("meecontact", "run", "ball", "--cores", "2")
    return project


def test_one_axis_tells_three_factors(ball: Project) -> None:
    whole = open_results(ball.folder / "results/ball")
    assert dict(whole.sizes) == {"force_radius_per_thickness3": 14, "position": 64}
    data = read_whole(ball.folder / "results/ball/validation.nc")
    assert float(data["max_error"].max()) < 1e-3


def test_the_design_is_what_the_solver_says(ball: Project) -> None:
    answer = netcdf.read(ball.folder / "results/ball/design/quiet.nc")
    exact = solve(
        {"material": "PZT-4", "profile": "sphere", "punch": "steel", "base": "steel", "magnetic": "insulating"}
        | {"surroundings": "insulated"}
        | answer.case
    )
    assert float(exact["peak_pressure"]) == pytest.approx(83e6, rel=1e-3)  # the depoling stress of PZT-4 stops it
    capacitance = float(exact["capacitance"]) + 10e-12
    noise = np.hypot(1e-15, np.sqrt(Boltzmann * 293.15 * capacitance))
    assert answer.terms[0].exact == pytest.approx(noise / abs(float(exact["charge_per_force"])), rel=1e-9)
    figures = {figure.figure: figure.figure_low for figure in answer.figures}
    assert figures["signal_charge"] == pytest.approx(0.2 * float(exact["charge_per_force"]), rel=1e-9)
    assert figures["circuit_capacitance"] == pytest.approx(capacitance, rel=1e-9)
    assert "force" not in figures


def test_the_page_speaks_of_a_point(ball: Project) -> None:
    page = (ball.folder / "results/ball/report.html").read_text(encoding="utf-8")
    words = re.sub(r"<[^>]+>", " ", page[: page.index('id="whatif"')])
    assert re.search(r"PZT-4, 50 µm on steel.*steel ball, R = [\d.]+ mm", words, re.DOTALL)
    assert not [word for word in ("slides", "N/m", "half-plane") if word in words]
    assert "figure-contact_quiet" in page  # the fields of its contact, over r/a
    assert "figure-fields" in page  # and those of its surface
