"""Largest stresses from tables against plain searches over the fields."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.names import FILM_PEAKS

FILM: dict[str, Any] = {"surroundings": "insulated", "thickness": 2e-4, "radius": 0.05}


def test_of_two_hills_of_the_pressure_the_higher_is_given() -> None:
    case = FILM | {"material": "PZT-5H", "base": "polyimide", "friction": 0.1, "load": 2.495e5}
    assert float(solver.solve(case)["peak_pressure"]) == pytest.approx(69.682e6, abs=5e2)


def test_a_sweep_of_the_load_has_no_steps_where_tables_change() -> None:
    """200 loads about the change of tables at a half-length of one thickness: third differences are steps."""
    case = FILM | {"material": "BaTiO3", "base": "steel", "thickness": 1e-4, "friction": 0.2}
    coarse = np.geomspace(1e2, 1e5, 200)
    trial = solver.solve(case | {"load": coarse})
    half = ((trial["contact_trailing"] + trial["contact_leading"]) / 2).values.ravel()
    load = np.interp(0.0, np.log(half / 1e-4), np.log(coarse))
    swept = solver.solve(case | {"load": np.exp(load + 0.001 * np.linspace(-1, 1, 200))}, peaks=True)
    half = ((swept["contact_trailing"] + swept["contact_leading"]) / 2).values.ravel()
    assert half[0] < 1e-4 < half[-1]
    for name in ("peak_pressure", *FILM_PEAKS):
        if not name.endswith("position"):
            values = swept[name].values.ravel()
            assert np.max(np.abs(np.diff(values, 3))) <= 1e-8 * np.max(values), name


@pytest.mark.parametrize(
    ("case", "largest"),
    [
        ({"load": 1e6}, 6.22e6),  # 5.3 half-lengths from the middle: the base bends with the width of the contact
        ({"load": 1e4, "friction": 0.01, "base": "steel"}, None),  # 220 half-lengths from the middle
    ],
)
def test_the_base_is_searched_as_far_as_its_tension_rises(case: dict[str, Any], largest: float | None) -> None:
    factors = {"material": "BaTiO3", "thickness": 1e-4, "base": "aluminium oxide", "radius": 0.05, "friction": 0.05}
    factors |= {"surroundings": "insulated", "magnetic": "insulating"} | case
    answer = solver.solve(factors, peaks=["base_peak_principal_tension"])
    half = float(answer["contact_trailing"] + answer["contact_leading"]) / 2
    far = 1 + np.geomspace(0.01, 400.0, 120)
    x: Array = np.concatenate([-far[::-1], np.linspace(-0.99, 0.99, 21), far])
    x = x[np.abs(x) * half < 500e-4]  # fields inside end some hundred thicknesses away
    top = 1e-4 / half
    depths = np.geomspace(top * (1 + 1e-9), 2 + 2 * top, 8)
    inside = solver.solve_interior(factors, x, -depths, fields=["principal_tension"])
    tension = inside["principal_tension"].values.squeeze()
    computed = float(answer["base_peak_principal_tension"])
    assert np.max(tension) * (1 - 1e-6) <= computed <= np.max(tension) * 1.03
    if largest is not None:
        assert computed == pytest.approx(largest, rel=1e-3)
