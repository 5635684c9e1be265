"""Surroundings of a design's contact and the effect of the other ones, in numbers and words."""

import pytest

from tests.studies import shipped
from workflow.language.numbers import shown
from workflow.report import exact as other_surroundings
from workflow.study.model import Study, load
from workflow.study.sections import Device

CASE = {"volume_fraction": 0.5, "friction": 0.0, "radius": 0.05, "load": 1e4}


@pytest.fixture(scope="module")
def bare() -> Study:
    """A half-plane without friction: the charge per load is the same in air, the theorem of docs/theory.md, 10."""
    return load("config/quickstart.yaml").narrowed({"magnetic": "insulating"})


@pytest.fixture(scope="module")
def study(bare: Study) -> Study:
    return bare.model_copy(update={"device": Device.model_validate({"electrode_length": "10 mm"})})


def test_air_is_compared_with_what_is_insulated_and_the_other_way_round(study: Study) -> None:
    compared = other_surroundings.compared(study, CASE)
    assert compared["surroundings"] == "insulated"
    present, other = compared["quantities"]["charge_per_force"]
    assert other == pytest.approx(present, rel=1e-9)
    present, other = compared["quantities"]["voltage"]
    assert 0.1 < other / present < 0.99
    said = other_surroundings.told(compared)
    assert f"{shown(other, 'V', 3)} instead of {shown(present, 'V', 3)}" in said.replace("\N{NO-BREAK SPACE}", " ")
    assert other_surroundings.compared(study.narrowed({"electric": "insulating"}), CASE) == {}
    assert other_surroundings.told({}) == ""
    back = other_surroundings.compared(study.narrowed({"surroundings": "air"}), CASE)
    assert back == {
        "surroundings": "air",
        "quantities": {name: values[::-1] for name, values in compared["quantities"].items()},
    }
    oil = study.model_copy(update={"fixed": {**study.fixed, "surroundings": "air", "gap_permittivity": 2.2}})
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
