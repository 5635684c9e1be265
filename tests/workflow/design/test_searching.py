"""The search's parts on questions whose best is known by hand, without a fit."""

import numpy as np
import pytest
import xarray as xr

from solver import solve
from surrogate.search.optimise import maximise
from surrogate.search.pareto import Front
from tests.workflow.design import standin
from workflow.design.question.question import Question
from workflow.design.search import polish, targets
from workflow.design.search.candidate import Candidate
from workflow.study.target import Target

AT = {"radius": 0.1, "load": 1e4}


def searched(candidate: Candidate) -> Candidate:
    """A candidate at its best on what stands for the surrogate."""
    best = maximise(candidate.problem(candidate.question.predicted), scan=64)
    return Candidate({}, candidate.question, best)


@pytest.mark.parametrize("off", [0.03, -0.03])
def test_a_polish_keeps_the_limit_that_a_surrogate_breaks(off: float) -> None:
    target = {"maximise": "load", "over": ["load"], "at": {"radius": 0.1}, "subject_to": ["peak_pressure <= 100 MPa"]}
    study = standin.study(fixed=standin.FIXED | {"friction": 0.0})
    polished = polish.first_feasible([searched(standin.candidate(study, off, **target))])
    (load,) = polished.design.variables["load"]
    pressure = solve({**standin.FIXED, "friction": 0.0, "radius": 0.1, "load": load})["peak_pressure"]
    assert polished.best.feasible
    assert float(pressure) == pytest.approx(100e6, rel=1e-8)
    assert float(pressure) <= 100e6 * (1 + 1e-12)


def test_a_tolerance_costs_what_it_keeps_away_from_the_limit() -> None:
    study = standin.study()
    target = Target(maximise="radius", over=["radius"], at={"load": 1e4}, tolerance={"radius": "5 %"},
                    subject_to=["radius <= 100 mm"])  # fmt: skip
    candidate = standin.candidate(study, **target.model_dump())
    best = searched(candidate)
    without = searched(standin.candidate(study, **targets.without_tolerances(target).model_dump()))

    def other(target: Target) -> Question:
        return Question(study, target, candidate.question.predicted, candidate.question.exact, {"load": 1e4})

    costs = targets.costs(best, without, other)
    assert float(best.design.variables["radius"][0]) == pytest.approx(0.1 / 1.05, rel=1e-9)
    assert costs.exact == pytest.approx(0.1, rel=1e-9)
    # the goal counts the least radius within the tolerance, 0.95 of the design's
    assert costs.cost["radius"] == pytest.approx(1.05 / 0.95 - 1, rel=1e-6)
    assert costs.gain["radius"] == pytest.approx((0.975 / 1.025) / (0.95 / 1.05) - 1, rel=1e-6)


def test_the_front_of_all_choices_is_what_none_of_them_dominates() -> None:
    def part(rows: list[list[float]]) -> xr.Dataset:
        return xr.Dataset({"front_exact": (("front", "objective"), np.array(rows))})

    merged = targets.merged({"a": part([[3.0, 1.0], [1.0, 3.0]]), "b": part([[2.0, 2.0], [2.0, 0.5]])}, np.ones(2))
    assert merged["front_exact"].values.tolist() == [[1.0, 3.0], [2.0, 2.0], [3.0, 1.0]]
    assert merged["front_choice"].values.tolist() == ["a", "b", "a"]
    fronts = [
        Front(np.empty((2, 0)), np.array(rows), np.zeros(2), np.ones(2))
        for rows in ([[3.0, 1.0], [1.0, 3.0]], [[2.0, 0.0]])
    ]
    least, span = targets.normalisation(fronts)
    assert (least.tolist(), span.tolist()) == ([1.0, 1.0], [2.0, 2.0])  # the second front is dominated


def test_map_and_slices_are_the_terms_about_the_design() -> None:
    study = standin.study()
    limit = "trailing_tension <= 50 MPa"
    design = standin.design(study, AT, maximise="peak_pressure", over=["radius", "load"], subject_to=[limit])
    pictures = targets.map_and_slices(design)
    over = {"radius": pictures["map_x"].values[::20], "load": pictures["map_y"].values[::20]}
    exact = solve({**standin.FIXED, **over}).transpose(*over)
    np.testing.assert_allclose(pictures["map_objective"].values[::20, ::20], exact["peak_pressure"], rtol=1e-9)
    np.testing.assert_allclose(
        pictures["map_excess"].values[::20, ::20], exact["trailing_tension"] / 50e6 - 1, rtol=1e-9, atol=1e-9
    )
    load_slice = pictures.sel(slice="load")
    along = solve({**standin.FIXED, "radius": 0.1, "load": load_slice["slice_value"].values})["peak_pressure"]
    np.testing.assert_allclose(load_slice["slice_objective"], along, rtol=1e-9)
    assert np.all(load_slice["slice_low"] <= load_slice["slice_objective"])
