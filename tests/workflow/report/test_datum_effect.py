"""The page's datum effects are those of the exact solver, and every number that depends on the datum is marked."""

import json
import re

import numpy as np
import pytest

import solver
from solver.halfplane.surface import HalfPlane
from storage.netcdf import read_whole
from tests.workflow.conftest import Project
from workflow.design.verdict import netcdf
from workflow.report.exact import changes, of_design, singular_zone
from workflow.study.datum import HANGING
from workflow.study.model import load

#: What depends on the datum in a body without surroundings.
HERE = HANGING - {"capacitance_at_load"}


def test_changes_with_the_datum_are_those_of_the_exact_solver(ran: Project) -> None:
    study = load(ran.folder / "config/small.yaml")
    rows = {row["name"]: row for row in changes(study)}
    assert set(rows) == HERE
    middle = {"volume_fraction": 0.6, "friction": 0.25, "radius": 0.004**0.5, "load": np.sqrt(5e3 * 5e4)}
    for length, place in ((0.1, 0), (1.0, 1), (10.0, 2)):
        exact = solver.solve({**middle, "datum": length})
        for name, row in rows.items():
            assert row["values"][place] == pytest.approx(float(exact[name]), rel=1e-12)
    # theory section 6: -N_J . (P, T, J) log(10) / pi for a decade
    material = solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.6)
    compliance = HalfPlane(material).compliance[:, 0] * np.log(10) / np.pi
    assert rows["voltage"]["slope"] == pytest.approx(-compliance[1] * middle["load"], rel=1e-9)
    assert rows["voltage_per_load"]["slope"] == pytest.approx(-compliance[1], rel=1e-9)
    assert rows["depth"]["slope"] == pytest.approx(compliance[0] * middle["load"], rel=1e-9)
    assert {name for name, row in rows.items() if np.isfinite(row["slope"])} == {
        "depth", "voltage", "magnetic_potential", "voltage_per_load", "magnetic_potential_per_load"
    }  # fmt: skip


def test_a_design_says_what_another_datum_makes_of_it(ran: Project) -> None:
    study = load(ran.folder / "config/small.yaml")
    answer = netcdf.read(ran.folder / "results/small/design/sensor.nc")
    (row,) = of_design(study, study.design["sensor"], answer)
    assert row["name"] == "abs(voltage_per_load)"
    assert row["units"] == "V m N-1"
    assert row["values"][1] == pytest.approx(answer.terms[0].exact, rel=1e-9)
    assert row["values"][2] - row["values"][1] == pytest.approx(row["values"][1] - row["values"][0], rel=1e-9)
    other = netcdf.read(ran.folder / "results/small/design/impossible.nc")
    assert of_design(study, study.design["impossible"], other) == []  # a stroke, under a tension


def test_conduction_outweighs_the_tension_in_the_zone_that_the_page_names(ran: Project) -> None:
    study = load(ran.folder / "config/small.yaml")
    answer = netcdf.read(ran.folder / "results/small/design/sensor.nc")
    edge = singular_zone(study, answer)
    assert edge is not None
    case = dict(answer.terms[1].worst)
    inside, outside = 1 - np.array([1.0, 25.0]) * edge["zone"] / edge["half"], [1 + 1e-9]
    exact = solver.solve(case, [*inside, *outside])
    stress = exact["stress_xx"].values
    assert stress[2] == pytest.approx(float(exact["trailing_tension"]), rel=1e-3)
    assert abs(stress[0] - stress[2]) == pytest.approx(edge["tension"], rel=0.05)
    assert abs(stress[1] - stress[2]) < edge["tension"] / 2


def test_page_card_and_files_name_the_datum(ran: Project) -> None:
    folder = ran.folder / "results/small"
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert re.search(r"<code>datum</code></td><td>[^<]*</td><td class=\"n\">1 m</td>", page)
    rows = set(re.findall(r'<tr><td><code>(\w+)</code><a class="mark-l"', page))
    assert rows == HERE  # in the tables of ranges; every such number is marked, and no other
    assert "depends on the datum, and the design is the best for the study" in page
    card = json.loads((folder / "datacard.json").read_text(encoding="utf-8"))
    assert card["datum"] == 1.0
    words = (folder / "datacard.md").read_text(encoding="utf-8")
    assert "Datum: 1 m; on this arbitrary length of the potentials depend depth, voltage, " in words
    comment = read_whole(folder / "quantities.nc")["voltage"].attrs["comment"]
    assert comment.startswith("depends on the datum")
    assert comment.endswith("datum: 1 m, the default")
