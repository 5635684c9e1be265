"""The verdict on designs: of punches without a voltage or with a fixed radius, at edges, under limits that meet."""

from typing import Any

import numpy as np
import pytest

from solver import find, solve, solve_interior
from tests.studies import fitted
from tests.workflow.design import standin
from workflow.design.search import targets
from workflow.design.verdict import multipliers
from workflow.design.verdict.answer import ROUNDING, Answer
from workflow.design.wording import words
from workflow.report.figures.design_plots import figures_of
from workflow.study.target import Target

LOAD = {"low": 5e3, "high": 5e4, "levels": 5, "scale": "log"}
RADIUS = {"low": 0.02, "high": 0.2, "levels": 5, "scale": "log"}
FRACTION = {"low": 0.4, "high": 0.8, "levels": 10}
CHARGE = {"low": -2e-6, "high": 2e-6, "levels": 4}


def exact_ranges(answer: Answer) -> dict[str, tuple[float, float]]:
    """Least and largest exact value of every quantity of a design."""
    return {row.quantity: (row.exact_low, row.exact_high) for row in answer.ranges}


def ask(factors: dict[str, Any], fixed: dict[str, Any] | None = None, **target: Any) -> Answer:
    """Answer a target of a small study whose composite is fibrous and whose friction is 0.2."""
    study = standin.study(fixed={"composite": "fibrous", "friction": 0.2, **(fixed or {})}, factors=factors)
    return targets.answer(study, "mine", Target.model_validate(target), fitted(study))


def test_a_punch_without_a_voltage_is_judged_and_drawn() -> None:
    target = {"maximise": "peak_pressure", "over": ["volume_fraction", "radius"], "subject_to": ["radius >= 50 mm"]}
    factors = {"volume_fraction": FRACTION, "radius": RADIUS}
    answer = ask(factors, {"load": 1e4, "electric": "insulating"}, **target)
    assert answer.feasible
    assert answer.variable("radius").value == pytest.approx(0.05, rel=1e-6)
    assert "voltage" not in exact_ranges(answer)
    assert "field" not in answer.flags  # but the tension
    assert set(figures_of(answer, Target.model_validate(target))) == {"map", "slices", "contact"}


@pytest.mark.parametrize(
    ("profile", "flagged"), [({"radius": 1e-7}, True), ({"profile": "flat", "width": 1e-4}, False)]
)
def test_too_wide_a_contact_is_told_of_a_fixed_radius_too(profile: dict[str, Any], flagged: bool) -> None:
    target = {"maximise": "abs(voltage_per_load)", "over": ["volume_fraction", "load"]}
    answer = ask({"volume_fraction": FRACTION, "load": LOAD}, profile, **target)
    flags = answer.flags
    assert ("no longer a parabola" in flags) == flagged
    assert ("both surfaces must be smoother than most are" in flags) == (exact_ranges(answer)["depth"][1] < 1e-7)
    if flagged:
        width = sum(exact_ranges(answer)[f"contact_{side}"][1] for side in ("trailing", "leading"))
        assert f"the contact is {width / profile['radius']:.2g} of the radius wide" in flags


SQUARE = {"volume_fraction": FRACTION, "radius": RADIUS}


def test_a_pair_of_limits_that_is_an_equality_is_met_to_rounding() -> None:
    limits = ["trailing_tension <= 30 MPa", "trailing_tension >= 30 MPa"]
    target = {"maximise": "abs(voltage_per_load)", "over": list(SQUARE), "subject_to": limits}
    answer = ask(SQUARE, {"load": 1e4}, **target)
    assert answer.feasible
    assert answer.status == f"feasible; binding: {', '.join(limits)}"
    assert max(abs(limit.margin) for limit in answer.limits) <= ROUNDING
    # the curve of all designs with this tension, by brute force
    over = {"volume_fraction": np.linspace(0.4, 0.8, 401), "radius": np.geomspace(0.02, 0.2, 81)}
    exact = solve({**over, "load": 1e4, "friction": 0.2, "composite": "fibrous"}).transpose(*over)
    tension, goal = exact["trailing_tension"].values, abs(exact["voltage_per_load"].values)
    crossing = np.diff(np.sign(tension - 30e6), axis=1) != 0
    assert crossing.sum() > 250
    assert answer.terms[0].exact == pytest.approx(np.minimum(goal[:, :-1], goal[:, 1:])[crossing].max(), rel=5e-4)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "target",
    [
        {"minimise": "max(abs(voltage), -2 * voltage) / load"},
        {"maximise": "abs(voltage_per_load)", "subject_to": ["abs(voltage) <= 0"]},
    ],
)
def test_a_kink_is_solved_to_rounding(target: dict[str, Any]) -> None:
    factors = {"volume_fraction": FRACTION, "radius": RADIUS, "charge": CHARGE}
    answer = ask(factors, {"load": 1e4}, over=["charge", "radius"], at={"volume_fraction": 0.6}, **target)
    assert answer.feasible
    low, high = exact_ranges(answer)["voltage"]
    assert max(abs(low), abs(high)) < 1e-9  # volts, of some 1e6 over the charges


def test_what_the_material_bears_is_a_limit_and_its_linear_range_is_told() -> None:
    """BaTiO3 alone, a volume fraction of 1, has these figures in the library; the field is that below the contact."""
    target = {"maximise": "abs(voltage_per_load)", "over": ["radius"], "at": {"load": 1e4}}
    fixed, factors = {"volume_fraction": 1.0, "composite": "fibrous"}, {"radius": RADIUS, "load": LOAD}
    answer = ask(factors, fixed, **target, subject_to=["trailing_tension <= 120 % of tensile_strength"])
    (limit,) = answer.limits
    assert limit.limit == pytest.approx(1.2 * 35e6, rel=1e-12)
    assert limit.bound == "tensile strength of BaTiO3"
    assert limit.source == find("BaTiO3").limits["tensile_strength"].source
    judged = words.verdict(answer)
    assert judged.kind.startswith("beyond linear theory; otherwise ")
    case = {"composite": "fibrous", "friction": 0.2, **fixed, "load": 1e4, "radius": answer.variable("radius").value}
    exact = solve(case)
    inside = solve_interior(case, [0.0], np.linspace(-2.0, 0.0, 201))
    field = np.hypot(inside["electric_field_x"], inside["electric_field_y"]).max()
    assert bool(field > 0.3e6) == ("coercive field of BaTiO3" in judged.beyond)
    assert bool(exact["trailing_tension"] > 35e6) == ("tensile strength of BaTiO3" in judged.beyond)


def test_an_edge_of_the_box_binds_nothing_and_what_does_not_matter_is_told() -> None:
    target = {"maximise": "abs(stroke_per_volt)", "subject_to": ["peak_pressure <= 500 MPa"]}
    answer = ask(SQUARE, {"load": 1e4}, over={"volume_fraction": {"high": 0.7}, "radius": {}}, **target)
    assert [answer.variable(name).sensitivity.matters for name in ("volume_fraction", "radius")] == [True, False]
    assert answer.status == (
        "feasible; binding: none; volume_fraction at the upper end of the range asked for; "
        "radius of no effect on the goal"
    )
    says = words.verdict(answer)
    assert says.stops == "limited by volume fraction at the upper end of the range asked for (0.7)."
    start = "The goal does not depend on radius; the smallest value is chosen that leaves every"
    assert says.without_effect.startswith(start)
    # which is the least radius that leaves 1 % to the limit, by the exact solver
    case = {"composite": "fibrous", "friction": 0.2, "load": 1e4, "volume_fraction": 0.7}
    radius = answer.variable("radius").value
    pressure = solve({**case, "radius": [radius, 0.999 * radius]})["peak_pressure"].values / 500e6
    assert pressure[0] <= 0.99 + 1e-6
    assert pressure[1] > 0.99 or radius == pytest.approx(0.02)
    # what a little more would bring, from the exact solver
    case = {"composite": "fibrous", "friction": 0.2, "load": 1e4, "radius": 0.1}
    strokes = np.log(np.abs(solve({**case, "volume_fraction": 0.7 * np.array([0.9999, 1.0001])})["stroke_per_volt"]))
    weight = multipliers.multipliers(answer, [], answer.at_ends)["volume_fraction"]
    assert weight == pytest.approx(float(strokes[1] - strokes[0]) / 2e-4, rel=1e-4)
    assert says.advice.startswith("To first order, volume fraction 0.77 would gain ")


def test_next_to_zero_an_error_costs_units_and_no_share() -> None:
    factors = {"volume_fraction": FRACTION, "charge": CHARGE}
    fixed = {"load": 1e4, "radius": 0.1}
    answer = ask(factors, fixed, minimise="abs(voltage)", over=["charge"], at={"volume_fraction": 0.6})
    charge = answer.variable("charge")
    sensitivity = charge.sensitivity
    assert np.isnan(sensitivity.cost)
    assert np.isnan(sensitivity.elasticity).all()
    assert sensitivity.matters
    exact = solve(
        {"composite": "fibrous", "friction": 0.2, **fixed, "volume_fraction": 0.6, "charge": 1.01 * charge.value}
    )
    assert sensitivity.loss == pytest.approx(abs(float(exact["voltage"])), rel=1e-6)
