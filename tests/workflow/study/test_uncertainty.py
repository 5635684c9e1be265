"""Uncertain constants of a study's materials: what is found, with which priors, and what a moved study answers."""

import numpy as np
import pytest

from solver import Material, find, solve
from solver.names import THERMAL as NAMES
from tests.studies import made, shipped
from workflow.dataset import factorial
from workflow.study import uncertainty
from workflow.study.model import Study, load
from workflow.study.target import Distribution

FILM = """\
title: A film on steel
fixed: {surroundings: insulated,
        composite: fibrous, volume_fraction: 0.5, friction: 0.1, radius: 0.05, interface_electric: grounded,
        interface_magnetic: grounded}
categories: {base: [rigid, steel]}
factors:
  thickness: {low: 2e-4, high: 6e-4, levels: 6, scale: log}
  load: {low: 2e4, high: 1e5, levels: 6, scale: log}
surrogate: {outputs: [depth, contact_trailing, voltage]}
"""


@pytest.fixture(scope="module")
def film() -> Study:
    return made(FILM)


def test_families_and_their_priors(film: Study) -> None:
    priors = {constant.name: constant.std for constant in uncertainty.uncertain(film)}
    assert list(priors) == [
        "BaTiO3 stiffness", "BaTiO3 piezoelectricity", "BaTiO3 permittivity", "BaTiO3 permeability",
        "CoFe2O4 stiffness", "CoFe2O4 piezomagnetism", "CoFe2O4 permittivity", "CoFe2O4 permeability",
        "steel modulus", "steel poisson",
    ]  # fmt: skip
    other = find("BaTiO3 (alternative 1)")
    off = np.mean([np.log(other.eps11 / find("BaTiO3").eps11), np.log(other.eps33 / find("BaTiO3").eps33)])
    assert priors["BaTiO3 permittivity"] == pytest.approx(abs(off))
    alloy = "title: An alloy\nfixed: {composite: AlScN, scandium_fraction: 0.3, radius: 0.05}\n"
    assert not uncertainty.materials(made(f"{alloy}factors: {{load: {{low: 1e4, high: 2e4, levels: 3}}}}\n"))
    assert {priors["steel poisson"], priors["steel modulus"], priors["CoFe2O4 stiffness"]} == {0.02, 0.05}


def test_the_first_design_question_tells_the_distribution_of_a_factor() -> None:
    study = shipped("peaks")
    narrow = study.design["poled"].model_copy(update={"uncertain": {"friction": Distribution(uniform=[0.1, 0.2])}})
    pair = study.model_copy(update={"design": {"narrow": narrow, "poled": study.design["poled"]}})
    assert pair.distributions == {"friction": Distribution(uniform=[0.1, 0.2])}


def test_a_moved_study_is_solved_with_moved_constants(film: Study) -> None:
    constants = uncertainty.uncertain(film, {"steel modulus": 0.1, "steel poisson": None, "BaTiO3 e33": 0.2})
    moved = uncertainty.moved(film, constants, np.array([1.0, -1.0, 0.5]))
    case = {"thickness": 3e-4, "load": 5e4}
    answer = factorial.exact(moved, {**case, "base": "steel"})
    ceramic = find("BaTiO3").plain() | {"e33": 18.6 * np.exp(0.1), "alternatives": []}
    base = Material.isotropic(200e9 * np.exp(0.1), 0.28, name="steel")
    exact = solve({**film.fixed, **case, "base": base}, phases=(Material.from_mapping(ceramic), "CoFe2O4"))
    for name in ("voltage", "depth", "capacitance_per_length"):
        assert float(answer[name]) == pytest.approx(float(exact[name]), rel=1e-9)
    assert uncertainty.concerned(film, constants[0]) == {"base": "steel"}
    assert uncertainty.concerned(film, constants[2]) == {}
    assert [constant.change(1.0) for constant in constants] == ["+10.5 %", "+0.02", "+22.1 %"]


def test_alternatives_that_differ_by_more_than_30_percent_are_solved() -> None:
    """A square moves by the square of the alternative's ratio, where a first-order product of 2 x 128 % is 256 %."""
    study = made(FILM.replace("[rigid, steel]", "[steel, polyimide]"))
    constants = [constant for constant in uncertainty.uncertain(study) if constant.family == "modulus"]
    assert [constant.name for constant in constants] == ["steel modulus", "polyimide modulus"]

    def squares(study: Study) -> np.ndarray:
        return np.array([float(find(name, study.own_materials).c11) ** 2 for name in ("steel", "polyimide")])

    ratio = float(find("polyimide (alternative 1)").c11 / find("polyimide").c11)
    assert ratio > 1 + uncertainty._WIDE
    shares = uncertainty.sensitivities(study, constants, squares)
    assert shares == pytest.approx(np.diag([2 * 0.05, ratio**2 - 1]), rel=1e-4)  # the difference quotient's own 1e-5


def test_the_time_of_heat_spreads_by_the_covers_conductivity() -> None:
    study = load("config/taxel.yaml")
    case = {"thickness": 3e-3, "force": 0.02, "patch_position": 0.0, "feedback_resistance": 1e12}
    constants = {constant.name: constant for constant in uncertainty.uncertain(study)}
    cover = constants["PDMS conductivity"]
    (share,) = uncertainty.sensitivities(
        study, [cover], lambda moved: factorial.exact(moved, case)["heat_time"].values.ravel()
    )[0]
    assert share == pytest.approx(-cover.std, rel=0.03)  # h^2 c/kappa: the film below is thin, the charge leaks slowly
    assert not [name for name in NAMES if name in {constant.family for constant in uncertainty.uncertain(made(FILM))}]
