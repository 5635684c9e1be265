"""Exact similarity: every quantity and field scales with size and strength by the powers of the table."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.curves import SIZES
from solver.fields import EVERY_FIELD, EVERY_INTERIOR
from solver.names import ALL_QUANTITIES
from solver.similarity import FACTOR_WEIGHTS, QUANTITY_WEIGHTS, scale_powers, weight_of

POSITIONS = (-1.3, -0.4, 0.8, 2.0)


def scaled(case: dict[str, Any], size: float, strength: float) -> dict[str, Any]:
    """The similar case."""
    weights = {name: weight_of(name) for name in case}
    return {
        name: value * size ** weights[name].size * strength ** weights[name].strength
        if name in FACTOR_WEIGHTS
        else value
        for name, value in case.items()
    }


def assert_similar(first: xr.Dataset, two: xr.Dataset, size: float, strength: float, rtol: float) -> None:
    """Every variable of two is that of one times its powers, to ``rtol`` of its largest value."""
    assert set(first.data_vars) == set(two.data_vars)
    for name in map(str, first.data_vars):
        weight = QUANTITY_WEIGHTS[name]
        expected = first[name].values * size**weight.size * strength**weight.strength
        largest = float(np.abs(expected).max())
        np.testing.assert_allclose(two[name].values, expected, rtol=rtol, atol=rtol * largest, err_msg=name)


LINE: dict[str, Any] = {"composite": "fibrous", "volume_fraction": 0.4, "friction": 0.2, "load": 1e4, "datum": 0.5}
BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0, "friction": 0.2}


@pytest.mark.parametrize(
    ("case", "rtol"),
    [
        (LINE | {"profile": "flat", "width": 1e-3, "moment": 0.4}, 1e-6),
        (LINE | {"profile": "wedge", "slope": 1e-3}, 1e-6),
        (BALL | {"thickness": 1e-4, "base": "steel", "surroundings": "insulated", "total_charge": 1e-10}, 1e-8),
    ],
    ids=("tilted by a moment", "wedge", "ball on a film"),
)
def test_other_profiles_scale_too(case: dict[str, Any], rtol: float) -> None:
    first, two = (solver.solve(c, POSITIONS, peaks=rtol == 1e-6) for c in (case, scaled(case, 0.3, 1.7)))
    assert_similar(first, two, 0.3, 1.7, rtol)


def test_stacks_scale_with_their_layers() -> None:
    titanate, ferrite = solver.find("BaTiO3"), solver.find("CoFe2O4")
    first, two = (
        solver.solve(
            {"radius": 0.05 * f, "load": 1e5 * f, "datum": f, "surroundings": "insulated"}
            | {"body": solver.Stack([solver.Layer(titanate, f * 1e-4), solver.Layer(ferrite, f * 2e-4)], base="steel")}
        )
        for f in (1.0, 2.0)
    )
    assert_similar(first, two, 2.0, 1.0, 1e-11)


def test_the_table_knows_every_quantity_and_field() -> None:
    assert set(QUANTITY_WEIGHTS) == {*ALL_QUANTITIES, *EVERY_FIELD, *EVERY_INTERIOR, *SIZES}


def test_scales_are_refused_where_nothing_tells_them() -> None:
    with pytest.raises(ValueError, match="'load' and 'charge' scale alike"):
        scale_powers("depth", "load", "charge")
    with pytest.raises(ValueError, match="'temperature' has no known powers"):
        scale_powers("temperature", "load", "radius")
