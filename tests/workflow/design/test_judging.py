"""Judgements of one design against closed forms: Hertz on a body without charges, bounds of the library."""

import numpy as np
import pytest

from tests.studies import shipped
from tests.workflow.design import standin
from workflow.design.verdict import assessment, linearity, merit
from workflow.design.verdict import assessment as sensitivity

HERTZ = {"friction": 0.0}  # then the largest pressure goes as the root of load over radius
AT = {"radius": 0.1, "load": 1e4}


def test_elasticities_and_costs_are_those_of_hertz() -> None:
    study = standin.study(fixed=standin.FIXED | HERTZ)
    design = standin.design(study, AT, minimise="peak_pressure", over=["radius", "load"], subject_to=["load >= 9 kN/m"])
    exact, _ = assessment.exactly(design, design.terms)
    sensitivities = sensitivity.sensitivities(design, exact)
    assert sensitivities["radius"].elasticity == pytest.approx((-0.5, 0.0), abs=1e-6)
    assert sensitivities["load"].elasticity == pytest.approx((0.5, 1.0), rel=1e-6)
    assert sensitivities["radius"].cost == pytest.approx(0.99**-0.5 - 1, rel=1e-9)
    assert sensitivities["load"].cost == pytest.approx(1.01**0.5 - 1, rel=1e-9)
    assert sensitivities["load"].loss == pytest.approx(sensitivities["load"].cost * exact[0])
    assert sensitivities["radius"].matters
    assert sensitivities["load"].margin_left == pytest.approx(0.99e4 / 9e3 - 1)  # of the bound


@pytest.mark.parametrize("room", [1.2, 3.0])
def test_the_load_at_the_first_limit_is_that_of_hertz(room: float) -> None:
    study = standin.study(fixed=standin.FIXED | HERTZ)
    open_ = standin.design(study, AT, maximise="load", over=["radius", "load"])
    factors = {name: np.full((1, 1), value) for name, value in AT.items()}
    pressure = float(open_.exact.values(factors, ["peak_pressure"])["peak_pressure"][0, 0])
    limit = f"peak_pressure <= {room * pressure:.12g} Pa"
    design = standin.design(study, AT, maximise="load", over=["radius", "load"], subject_to=[limit])
    overload = merit.first_limit(design, [AT, AT])
    assert overload is not None
    assert overload.overload == pytest.approx(room**2, rel=1e-3)
    assert overload.overload_term == limit
    free = standin.design(study, AT, maximise="load", over=["radius", "load"], subject_to=["peak_pressure <= 1e6 MPa"])
    overload = merit.first_limit(free, [AT, AT])
    assert overload is not None
    assert (overload.overload, overload.overload_term) == (merit.MOST_LOAD, "")


def test_a_design_is_judged_with_a_surrogate_that_errs() -> None:
    study = standin.study()
    target = {"maximise": "abs(voltage_per_load)", "over": ["radius", "load"], "subject_to": ["load <= 10 kN/m"]}
    right, wrong = (assessment.judge(standin.design(study, AT, off, **target)) for off in (0.0, 0.1))
    assert right.terms[0].inside
    assert not wrong.terms[0].inside
    assert wrong.outside.startswith("abs(voltage_per_load): exact ")
    assert wrong.terms[0].predicted == pytest.approx(1.1 * right.terms[0].exact, rel=1e-12)
    assert [limit.name for limit in right.binding] == ["load <= 10 kN/m"]
    assert right.status.startswith("feasible; binding: load <= 10 kN/m")


def test_a_wide_or_deep_contact_is_beyond_small_strain() -> None:
    """A fingertip on 3 mm of film: a/R = 0.49, and four fifths of the film deep."""
    fingertip = shipped("point_sensor")
    corner = {"contact_radius": np.array([[4.9e-3]]), "depth": np.array([[2.4e-3]])}
    radius, thickness = np.array([[0.01]]), np.array([[3e-3]])
    wide, deep = linearity.beyond_small_strain(fingertip, corner, radius, thickness)
    assert wide[0] == "a contact half-width of 4.9 mm is 0.49 of the punch radius and exceeds 0.2 of it"
    assert deep[0] == "a depth of 2.4 mm is 0.8 of the film's thickness and exceeds 0.1 of it"
    assert linearity.beyond_small_strain(fingertip, corner, 3 * radius, None) == []
    assert linearity.beyond_small_strain(fingertip, corner, None, 10 * thickness) == []
