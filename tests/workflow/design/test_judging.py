"""Judgements of one design against closed forms: Hertz on a body without charges, bounds of the library."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from solver import Material, solve
from surrogate import GridGP, Input
from surrogate.search.pareto import Front
from tests.studies import shipped
from tests.surrogate import curved
from tests.workflow.design import standin
from workflow.design.question.sources import Exact, Predicted
from workflow.design.search import targets
from workflow.design.verdict import assessment, linearity, merit
from workflow.study.contents import Origin
from workflow.study.model import Study, remade

HERTZ = {"friction": 0.0}  # then the largest pressure goes as the root of load over radius
AT = {"radius": 0.1, "load": 1e4}


def test_elasticities_and_costs_are_those_of_hertz() -> None:
    study = standin.study(fixed=standin.FIXED | HERTZ)
    design = standin.design(study, AT, minimise="peak_pressure", over=["radius", "load"], subject_to=["load >= 9 kN/m"])
    exact, _ = assessment.exactly(design, design.terms)
    sensitivities = assessment.sensitivities(design, exact)
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


def test_a_wide_or_deep_contact_is_beyond_small_strain() -> None:
    """A fingertip on 3 mm of film: a/R = 0.49, and four fifths of the film deep."""
    fingertip = shipped("point_sensor")
    corner = {"contact_radius": np.array([[4.9e-3]]), "depth": np.array([[2.4e-3]])}
    radius, thickness = np.array([[0.01]]), np.array([[3e-3]])
    wide, deep = linearity.beyond_small_strain(fingertip, corner, radius, thickness)
    assert wide[0] == "a contact half-width of 4.9 mm is 0.49 of the punch radius and exceeds 0.2 of it"
    assert deep[0] == "a depth of 2.4 mm is 0.8 of the film's thickness and exceeds 0.1 of it"
    ((slightly, _),) = linearity.beyond_small_strain(fingertip, corner, None, thickness * 2.4 / 3 * 9.97)
    assert slightly.endswith(" is 0.1003 of the film's thickness and exceeds 0.1 of it")
    assert linearity.beyond_small_strain(fingertip, corner, 3 * radius, None) == []
    assert linearity.beyond_small_strain(fingertip, corner, None, 10 * thickness) == []


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


def test_curves_are_asked_for_the_quantities_of_a_term_even_if_it_has_none() -> None:
    model = curved.fitted()
    source = Predicted(model)
    X = np.array([[0.2, 0.8], [-0.5, 1.3]])
    factors = {"a": X[:, 0], "b": X[:, 1]}
    assert source.values(factors, []) == {}  # a goal that is a factor
    assert source.slopes(factors, [], ["a"]) == {}
    place = model.outputs_.index("place")
    np.testing.assert_allclose(source.values(factors, ["place"])["place"], model.predict_array(X)[:, place], rtol=1e-5)


def test_errors_of_one_quantity_are_its_own_and_those_of_several_go_together() -> None:
    random, axis = np.random.default_rng(0), Input("x", 0.0, 1.0)

    def outputs(x: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        return {"one": 1 / (x + 0.1), "same": 2 + 3 / (x + 0.1)}

    grid = xr.Dataset({name: ("x", values) for name, values in outputs(axis.levels(9)).items()}, {"x": axis.levels(9)})
    held = random.uniform(0, 1, 400)
    cases = xr.Dataset({name: ("case", values) for name, values in {"x": held, **outputs(held)}.items()})
    model = GridGP(inputs=[axis]).fit(grid).calibrate(cases)
    source, factors, X = Predicted(model), {"x": np.array([[0.3]])}, np.array([[0.3]])
    mean, std = model.predict_array(X, return_std=True)
    reach = np.abs(np.stack(model.interval_array(X))[:, 0] - mean).max(axis=0)
    for k, name in enumerate(model.outputs_):
        assert source.errors(factors, {name: np.array([-2.0])}) == pytest.approx(
            (2 * std[0, k], 2 * reach[k]), rel=1e-9
        )
    cancelled = source.errors(factors, {"one": np.array([3.0]), "same": np.array([-1.0])})
    added = source.errors(factors, {"one": np.array([3.0]), "same": np.array([1.0])})
    assert cancelled[1] < 0.02 * reach[1]
    assert added[1] == pytest.approx(2 * reach[1], rel=0.05)  # a quantile of 400 rows
    assert source.errors(factors, {"one": np.array([0.0])}) == (0.0, 0.0)


def test_the_field_below_a_contact_is_what_charges_make_and_does_not_depend_on_the_datum() -> None:
    """A pure dielectric below a conducting strip: D_y = T / (pi h) in the middle, where the field is the largest."""
    load, charge, width, eps33 = 1e3, 2e-6, 1e-3, 1e-9
    plain = {"c11": 1e11, "c12": 4e10, "c13": 4e10, "c33": 1e11, "c44": 3e10}
    mine = Material.from_mapping({"name": "plain", **plain, "eps11": 4 * eps33, "eps33": eps33})
    text = {"title": "a strip", "fixed": {"profile": "flat", "material": "plain", "width": width, "charge": charge}}
    study = Study.model_validate(
        text | {"factors": {"load": {"low": 500, "high": 2000, "levels": 3}}}, context=Origin(Path(), {"plain": mine})
    )
    rows = [
        Exact(remade(study, fixed={**study.fixed, "datum": datum})).field_below({"load": np.array([[load]])})
        for datum in (0.1, 10.0)
    ]
    assert rows[0] == pytest.approx(charge / (np.pi * width / 2) / eps33, rel=1e-9)
    assert rows[1] == pytest.approx(rows[0], rel=1e-12)
