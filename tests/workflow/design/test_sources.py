"""The surrogate as a source of designs asks curves for no more than is needed."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from solver import Material
from surrogate import GridGP, Input
from tests.surrogate import curved
from workflow.design.question.sources import Exact, Predicted
from workflow.study.keys import Origin
from workflow.study.model import Study, remade


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
