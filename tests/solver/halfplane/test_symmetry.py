"""Symmetries that need no formula: mirror, reversed poling, electric and magnetic fields exchanged."""

from typing import Any

import numpy as np
import xarray as xr
from hypothesis import given

import solver
from solver.material.constants import ANY_SIZE
from tests.solver.cases import closed_form
from tests.solver.strategies import constants, loads, property_based

POSITIONS = np.array([-30.0, -1.01, -0.98, -0.3, 0.3, 0.98, 1.01, 30.0])
ELECTRIC, MAGNETIC = ("e31", "e33", "e15"), ("f31", "f33", "f15")


@property_based
@given(c=constants(), case=loads())
def test_reversed_poling_reverses_the_electric_and_magnetic_fields(c: dict[str, float], case: dict[str, Any]) -> None:
    assert_images(
        c, case,
        {name: -c[name] for name in (*ELECTRIC, *MAGNETIC)},
        {name: -case[name] for name in ("charge", "magnetic_charge")},
        {"electric": -1, "magnetic": -1},
    )  # fmt: skip


def assert_images(
    c: dict[str, float],
    case: dict[str, Any],
    reversed_constants: dict[str, float],
    reversed_charges: dict[str, float],
    signs: dict[str, int],
) -> None:
    first, two = (
        solver.solve({"material": solver.Material.from_mapping(m), **k}, POSITIONS)
        for m, k in ((c, case), (c | reversed_constants, case | reversed_charges))
    )
    for name in closed_form(first):
        size = float(np.max(np.abs(first[name])))
        sign = signs["electric"] if electric(name) else signs["magnetic"] if magnetic(name) else 1
        np.testing.assert_allclose(two[name], sign * first[name], rtol=1e-10, atol=1e-12 * size, err_msg=name)


def electric(name: str) -> bool:
    return name in ("voltage", "charge_per_force") or "electric" in name or "volt" in name


def magnetic(name: str) -> bool:
    return name == "flux_per_force" or "magnetic" in name or "ampere" in name


#: What an output is called when electric and magnetic fields change places.
PARTNERS = {"voltage": "magnetic_potential", "voltage_per_load": "magnetic_potential_per_load"}
PARTNERS |= {"charge_per_force": "flux_per_force", "stroke_per_volt": "stroke_per_ampere"}
PARTNERS |= {"blocked_load_per_volt": "blocked_load_per_ampere"}
PARTNERS |= {f"electric_displacement_{axis}": f"magnetic_induction_{axis}" for axis in "xy"}
PARTNERS |= {f"electric_edge_intensity_{edge}": f"magnetic_edge_intensity_{edge}" for edge in ("trailing", "leading")}


@property_based
@given(c=constants(), case=loads())
def test_electric_and_magnetic_fields_may_change_places(c: dict[str, float], case: dict[str, Any]) -> None:
    partners = dict(zip(("e31", "e33", "e15", "eps11", "eps33"), ("f31", "f33", "f15", "mu11", "mu33"), strict=True))
    partners |= {two: first for first, two in partners.items()}
    swapped = {partners.get(name, name): value for name, value in c.items()}
    first = solver.solve({"material": solver.Material.from_mapping(c), **case}, POSITIONS)
    case = case | {"charge": case["magnetic_charge"], "magnetic_charge": case["charge"]}
    arrays: dict[str, Any] = {name: np.array(value) for name, value in swapped.items()}
    two = solver.solve({"material": solver.Material(**arrays, any_size=ANY_SIZE), **case}, POSITIONS)
    names = PARTNERS | {two: first for first, two in PARTNERS.items()}
    assert_renamed(first, two, names)


def assert_renamed(first: xr.Dataset, two: xr.Dataset, names: dict[str, str]) -> None:
    for name in closed_form(first):
        size = float(np.max(np.abs(first[name])))
        np.testing.assert_allclose(two[names.get(name, name)], first[name], rtol=1e-10, atol=1e-12 * size, err_msg=name)
