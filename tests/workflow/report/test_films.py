"""Films and other surroundings on the page: times with tables, absolute quantities, differences in words."""

import numpy as np
import pytest

import solver
from tests.studies import fitted, made, shipped
from workflow.dataset import factorial
from workflow.language.numbers import shown
from workflow.learning import timing
from workflow.report import exact, page, whatif
from workflow.report import exact as other_surroundings
from workflow.study.datum import hanging
from workflow.study.model import Study, load
from workflow.study.sections import Device

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


@pytest.fixture(scope="module")
def study() -> Study:
    return made(FILM)


def test_films_are_timed_and_drawn_and_the_panel_knows_no_closed_form(study: Study) -> None:
    quantities = factorial.exact(study, factorial.axes(study))
    model = fitted(study)
    times = timing.timing(study, quantities, factorial.cases(study, "validation"), model)
    assert all(value > 0 for value in times.values())
    drawings = page._problem(study), page._problem(shipped("paper"))
    assert ["half-plane</title>" in drawn for drawn in drawings] == [False, True]
    assert all("film on its base" in drawn for drawn in drawings)
    hangs = hanging(study)
    content = whatif.content(study, model, quantities, [], hangs)
    assert content is not None
    assert not any(kind["pressure"] for kind in content["kinds"])
    words = {quantity["name"]: quantity["long_name"] for quantity in content["quantities"]}
    assert (words["voltage"], words["depth"]) == (
        "electric potential of the punch", "indentation depth relative to the datum"
    )  # fmt: skip


def test_what_hangs_on_the_datum_is_said_of_the_base_where_it_does(study: Study) -> None:
    rows = {row["name"]: row for row in exact.changes(study)}
    assert all(name.endswith("[steel]") for name in rows)
    case = {**study.fixed, "volume_fraction": 0.55, "thickness": np.sqrt(2e-4 * 3e-4), "base": "steel"}
    depths = solver.solve({**case, "datum": [0.1, 1.0, 10.0]})["depth"]
    np.testing.assert_allclose(rows["depth[steel]"]["values"], depths, rtol=1e-12)
    assert np.isfinite(rows["depth[steel]"]["slope"])


CASE = {"volume_fraction": 0.5, "friction": 0.0, "radius": 0.05, "load": 1e4}


@pytest.fixture(scope="module")
def bare() -> Study:
    """A half-plane without friction: the charge per load is the same in air, the theorem of docs/theory.md, 10."""
    return load("config/quickstart.yaml").narrowed({"magnetic": "insulating"})


@pytest.fixture(scope="module")
def sensor(bare: Study) -> Study:
    return bare.model_copy(update={"device": Device.model_validate({"electrode_length": "10 mm"})})


def test_air_is_compared_with_what_is_insulated_and_the_other_way_round(sensor: Study) -> None:
    compared = other_surroundings.compared(sensor, CASE)
    assert compared["surroundings"] == "insulated"
    present, other = compared["quantities"]["charge_per_force"]
    assert other == pytest.approx(present, rel=1e-9)
    present, other = compared["quantities"]["voltage"]
    assert 0.1 < other / present < 0.99
    said = other_surroundings.told(compared)
    assert f"{shown(other, 'V', 3)} instead of {shown(present, 'V', 3)}" in said.replace("\N{NO-BREAK SPACE}", " ")
    assert other_surroundings.compared(sensor.narrowed({"electric": "insulating"}), CASE) == {}
    assert other_surroundings.told({}) == ""
    back = other_surroundings.compared(sensor.narrowed({"surroundings": "air"}), CASE)
    assert back == {
        "surroundings": "air",
        "quantities": {name: values[::-1] for name, values in compared["quantities"].items()},
    }
    oil = sensor.model_copy(update={"fixed": {**sensor.fixed, "surroundings": "air", "gap_permittivity": 2.2}})
    assert other_surroundings.compared(oil, CASE)["quantities"]["voltage"][1] == present


def test_a_ball_on_a_film_is_compared_too() -> None:
    """A large ball on a thin film has 2.3 pF, and ten times as much in air."""
    ball = shipped("point_sensor").narrowed({"base": "steel"})
    compared = other_surroundings.compared(ball, {"thickness": 5e-5, "radius": 0.05, "force": 0.1})
    assert list(compared["quantities"]) == ["voltage", "capacitance", "charge_per_force"]
    air, bare = compared["quantities"]["capacitance"]
    assert air > 10 * bare
    expected = "capacitance 2.34 pF instead of 38.2 pF and charge per force 204 pC/N instead of 166 pC/N"
    assert expected in other_surroundings.told(compared)
