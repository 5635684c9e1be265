"""Fields inside films and their largest values: figures, the closed form, interfaces, equilibrium, searches."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.names import FILM_PEAKS
from solver.stack.layers import Layer, Stack
from tests.solver.cases import BTO, CFO, FIBROUS

ON_STEEL = Stack((Layer(FIBROUS, 2e-4, magnetic="grounded"),), "steel")
BONDED = Stack((Layer(FIBROUS, 2e-4, "bonded", "bonded"),), CFO)
BETWEEN = Stack((Layer(BTO, 1e-4, "grounded"), Layer(FIBROUS, 1e-4), Layer(CFO, 1e-4)), CFO)


@pytest.mark.parametrize("stack", [ON_STEEL, BONDED, BETWEEN], ids=["grounded", "bonded", "electrode between"])
def test_potentials_are_the_punch_s_on_it_meet_at_interfaces_and_have_the_fields_as_gradients(stack: Stack) -> None:
    case = {"body": stack, "radius": 0.05, "friction": 0.3, "load": 1e5, "surroundings": "insulated"}
    case |= {"charge": 2e-5, "magnetic_charge": 1e-2, "datum": 0.01}
    punch, potentials = solver.solve(case), ["electric_potential", "magnetic_potential"]
    h, X, step = float(punch["contact_trailing"] + punch["contact_leading"]) / 2, np.array([-0.9, 0.0, 0.5]), 1e-3

    def fields(x: Array, y: Array, names: list[str]) -> Array:
        """Fields inside, (name, y, x)."""
        inside = solver.solve_interior(case, x, y, fields=names)
        return np.stack([inside[name].values.squeeze() for name in names])

    within = fields(X, np.array([0.0, -0.1 * stack.thickness / h]), potentials)
    for potential, strength in zip(within, (punch["voltage"], punch["magnetic_potential"]), strict=True):
        np.testing.assert_allclose(potential[0], float(strength), rtol=1e-9)
    size = np.max(np.abs(within), axis=(1, 2))
    ends = np.cumsum([layer.thickness for layer in stack.layers]) / h
    for end in ends:
        above, below = np.moveaxis(fields(X, -end * np.array([1.0, 1 + 1e-9]), potentials), 1, 0)
        assert np.all(np.max(np.abs(above - below), axis=1) < 1e-8 * size)
    stencil, offsets = np.array([1, -8, 0, 8, -1]) / (12 * step), np.linspace(-2 * step, 2 * step, 5)
    for y in (-0.4 * ends[0], -(ends[-1] + 0.4)):
        around = fields(0.4 + offsets, y + offsets, potentials) / h
        for k, kind in enumerate(("electric", "magnetic")):
            field = fields(np.array([0.4]), np.array([y]), [f"{kind}_field_x", f"{kind}_field_y"])
            gradient = np.array([around[k, 2] @ stencil, around[k, :, 2] @ stencil])
            np.testing.assert_allclose(gradient, -field, atol=1e-7 * size[k] / h)


FILM: dict[str, Any] = {"surroundings": "insulated", "thickness": 2e-4, "radius": 0.05}


def test_of_two_hills_of_the_pressure_the_higher_is_given() -> None:
    case = FILM | {"material": "PZT-5H", "base": "polyimide", "friction": 0.1, "load": 2.495e5}
    assert float(solver.solve(case)["peak_pressure"]) == pytest.approx(69.682e6, abs=5e2)


def test_a_sweep_of_the_load_has_no_steps_where_tables_change() -> None:
    """Loads about the change of tables at a half-length of one thickness: third differences are steps."""
    case = FILM | {"material": "BaTiO3", "base": "steel", "thickness": 1e-4, "friction": 0.2}
    coarse = np.geomspace(1e2, 1e5, 50)
    trial = solver.solve(case | {"load": coarse})
    half = ((trial["contact_trailing"] + trial["contact_leading"]) / 2).values.ravel()
    load = np.interp(0.0, np.log(half / 1e-4), np.log(coarse))
    swept = solver.solve(case | {"load": np.exp(load + 0.001 * np.linspace(-1, 1, 50))}, peaks=True)
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
