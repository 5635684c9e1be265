"""Sensor and actuator tangents against differences of ``solve`` itself."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from numpy.polynomial import chebyshev

import solver
from tests.solver.strategies import decades, loads, materials, property_based

FIELDS = (
    ("charge", "voltage", "voltage_per_load", "charge_per_force", "stroke_per_volt", "blocked_load_per_volt"),
    (
        "magnetic_charge",
        "magnetic_potential",
        "magnetic_potential_per_load",
        "flux_per_force",
        "stroke_per_ampere",
        "blocked_load_per_ampere",
    ),
)
_NODES = np.cos(np.pi * (np.arange(12) + 0.5) / 12)
_SPAN = 0.1  # loads within a tenth of the case's: twelve Chebyshev points leave 1e-14 of the function


@property_based
@given(material=materials(), case=loads(), datum=decades(0, 2))
def test_sensitivities_are_derivatives_and_balances_null_the_potential(
    material: solver.Material, case: dict[str, Any], datum: float
) -> None:
    case = {"material": material, **case, "datum": datum}
    bare = case | {"charge": 0.0, "magnetic_charge": 0.0}
    centre, at_bare, along = solver.solve(case), solver.solve(bare), solver.solve(bare | {"load": around(case)})
    for charge, potential, sensitivity, balance, _, _ in FIELDS:
        size = float(abs(along[potential]).max()) / case["load"]
        slope = derivative(along[potential], case["load"])
        assert centre[sensitivity].item() == pytest.approx(slope, rel=1e-11, abs=1e-11 * size), sensitivity
        nulled = solver.solve(bare | {charge: centre[balance].item() * case["load"]})
        assert abs(nulled[potential].item()) <= 1e-13 * abs(at_bare[potential].item()), balance


@property_based
@given(material=materials(), case=loads(), datum=decades(0, 2))
def test_strokes_and_blocked_loads_are_derivatives(
    material: solver.Material, case: dict[str, Any], datum: float
) -> None:
    case = {"material": material, **case, "datum": datum}
    centre, along = solver.solve(case), solver.solve(case | {"load": around(case)})
    for charge, potential, _, _, stroke, blocked in FIELDS:
        moved = solver.solve(case | {charge: case[charge] + 1.0})  # affine in the charges: any step is exact
        jacobian = np.array(
            [
                [derivative(along[name], case["load"]), (moved[name] - centre[name]).item()]
                for name in ("depth", potential)
            ]
        )
        noise = 1e-14 * abs(centre.depth.item() / jacobian[1, 1])
        assert centre[stroke].item() == pytest.approx(jacobian[0, 1] / jacobian[1, 1], rel=1e-10, abs=noise), stroke
        # (d depth, d potential) = jacobian (d load, d charge) with d depth = 0
        per_volt = -jacobian[0, 1] / np.linalg.det(jacobian)
        noise = 1e-13 * abs(centre.depth.item() / np.linalg.det(jacobian))
        assert centre[blocked].item() == pytest.approx(per_volt, rel=1e-9, abs=noise), blocked


def derivative(values: xr.DataArray, load: float) -> float:
    """d values/d load at the middle of the Chebyshev points."""
    coefficients = chebyshev.chebfit(_NODES, values.values, _NODES.size - 1)
    return float(chebyshev.chebval(0.0, chebyshev.chebder(coefficients))) / (_SPAN * load)


def around(case: dict[str, Any]) -> xr.DataArray:
    return xr.DataArray(case["load"] * (1 + _SPAN * _NODES), dims="step")
