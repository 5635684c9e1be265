"""Exact cases beside the page: the datum, films, other surroundings, each as the solver has them."""

import json
import re

import numpy as np
import pytest

import solver
from solver.halfplane.surface import HalfPlane
from storage.netcdf import read_whole
from tests.studies import fitted, made, shipped
from tests.workflow.conftest import Project
from workflow.dataset import factorial
from workflow.design.verdict import netcdf
from workflow.language.numbers import shown
from workflow.learning import timing
from workflow.report import exact, page, whatif
from workflow.report.exact import changes, of_design, singular_zone
from workflow.study.datum import HANGING, hanging
from workflow.study.model import load
from workflow.study.sections import Device

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
    sloping = {name for name, row in rows.items() if np.isfinite(row["slope"])}
    assert sloping == {"depth", "voltage", "magnetic_potential", "voltage_per_load", "magnetic_potential_per_load"}


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


FILM = """\
title: A film
fixed: {surroundings: insulated, composite: fibrous, radius: 0.05, friction: 0.1, load: 3e4}
categories: {base: [rigid, steel]}
factors:
  volume_fraction: {low: 0.5, high: 0.6, levels: 2}
  thickness: {low: 2e-4, high: 3e-4, levels: 2, scale: log}
surrogate: {outputs: [contact_trailing, contact_leading, pressure_exponent, peak_pressure, voltage, depth]}
validation: {cases: 40, calibration: 60, tolerance: 1e-3}
"""


def test_films_are_timed_and_drawn_and_the_panel_knows_no_closed_form() -> None:
    study = made(FILM)
    quantities = factorial.exact(study, factorial.axes(study))
    model = fitted(study)
    times = timing.timing(study, quantities, factorial.cases(study, "validation"), model)
    assert all(value > 0 for value in times.values())
    drawings = page._problem(study), page._problem(shipped("paper"))
    assert ["half-plane</title>" in drawn for drawn in drawings] == [False, True]
    assert all("film on its base" in drawn for drawn in drawings)
    content = whatif.content(study, model, quantities, [], hanging(study))
    assert content is not None
    assert not any(kind["pressure"] for kind in content["kinds"])
    words = {quantity["name"]: quantity["long_name"] for quantity in content["quantities"]}
    assert words["voltage"] == "electric potential of the punch"
    assert words["depth"] == "indentation depth relative to the datum"


def test_what_hangs_on_the_datum_is_said_of_the_base_where_it_does() -> None:
    study = made(FILM)
    rows = {row["name"]: row for row in exact.changes(study)}
    assert all(name.endswith("[steel]") for name in rows)
    case = {**study.fixed, "volume_fraction": 0.55, "thickness": np.sqrt(2e-4 * 3e-4), "base": "steel"}
    depths = solver.solve({**case, "datum": [0.1, 1.0, 10.0]})["depth"]
    np.testing.assert_allclose(rows["depth[steel]"]["values"], depths, rtol=1e-12)
    assert np.isfinite(rows["depth[steel]"]["slope"])


CASE = {"volume_fraction": 0.5, "friction": 0.0, "radius": 0.05, "load": 1e4}


def test_air_is_compared_with_what_is_insulated_and_the_other_way_round() -> None:
    """On a half-plane without friction the charge per load is the same in air: the theorem of docs/theory.md, 10."""
    bare = load("config/quickstart.yaml").narrowed({"magnetic": "insulating"})
    sensor = bare.model_copy(update={"device": Device.model_validate({"electrode_length": "10 mm"})})
    compared = exact.compared(sensor, CASE)
    assert compared["surroundings"] == "insulated"
    present, other = compared["quantities"]["charge_per_force"]
    assert other == pytest.approx(present, rel=1e-9)
    present, other = compared["quantities"]["voltage"]
    assert 0.1 < other / present < 0.99
    said = exact.told(compared)
    assert f"{shown(other, 'V', 3)} instead of {shown(present, 'V', 3)}" in said.replace("\N{NO-BREAK SPACE}", " ")
    assert exact.compared(sensor.narrowed({"electric": "insulating"}), CASE) == {}
    assert exact.told({}) == ""
    turned = {name: values[::-1] for name, values in compared["quantities"].items()}
    back = exact.compared(sensor.narrowed({"surroundings": "air"}), CASE)
    assert back == {"surroundings": "air", "quantities": turned}
    oil = sensor.model_copy(update={"fixed": {**sensor.fixed, "surroundings": "air", "gap_permittivity": 2.2}})
    assert exact.compared(oil, CASE)["quantities"]["voltage"][1] == present


def test_a_ball_on_a_film_is_compared_too() -> None:
    """A large ball on a thin film has 2.3 pF, and ten times as much in air."""
    ball = shipped("point_sensor").narrowed({"base": "steel"})
    compared = exact.compared(ball, {"thickness": 5e-5, "radius": 0.05, "force": 0.1})
    assert list(compared["quantities"]) == ["voltage", "capacitance", "charge_per_force"]
    air, bare = compared["quantities"]["capacitance"]
    assert air > 10 * bare
    expected = "capacitance 2.34 pF instead of 38.2 pF and charge per force 204 pC/N instead of 166 pC/N"
    assert expected in exact.told(compared)
