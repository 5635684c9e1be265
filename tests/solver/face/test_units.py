"""A factor may bear its unit: the same cases, or one line that says what is wrong."""

import xarray as xr

import solver

BALL = {"material": "AlN", "profile": "sphere", "punch": "steel"}


def test_a_text_with_a_unit_is_its_number() -> None:
    forces = ["1 mN", 0.01, "1e-1N"]
    computed = solver.solve(
        BALL | {"radius": "5 mm", "force": forces, "thickness": "20 um", "surroundings": "insulated", "base": "silicon"}
    )
    same = solver.solve(
        BALL
        | {
            "radius": 5e-3,
            "force": [1e-3, 0.01, 0.1],
            "thickness": 2e-5,
            "surroundings": "insulated",
            "base": "silicon",
        }
    )
    xr.testing.assert_identical(computed, same)
    named = xr.DataArray(["5 mm", "2 cm"], dims="punch_radius")
    several = solver.solve(BALL | {"radius": named, "force": 1e-3})
    assert several["radius"].values.tolist() == [5e-3, 2e-2]
