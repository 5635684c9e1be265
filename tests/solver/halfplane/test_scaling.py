"""How results depend on load, radius and charges (theory section 8): powers of P and R, affine in T and J."""

from typing import Any

import numpy as np
import xarray as xr
from hypothesis import given

import solver
from tests.solver.cases import assert_same, closed_form
from tests.solver.strategies import between, decades, loads, materials, property_based

POSITIONS = (-4.0, -1.05, -0.9, 0.2, 0.97, 1.05)
MECHANICAL: tuple[str, ...] = (
    "contact_trailing",
    "contact_leading",
    "pressure_exponent",
    "peak_pressure",
    "trailing_tension",
)
MECHANICAL += ("leading_compression", "contact_pressure", "shear_traction")
TANGENTS_WITHOUT_CHARGES = ("voltage_per_load", "magnetic_potential_per_load", "charge_per_force", "flux_per_force")
RATIOS = ("stroke_per_volt", "stroke_per_ampere", *TANGENTS_WITHOUT_CHARGES)


@property_based
@given(material=materials(), case=loads(), heavier=decades(-2, 2), further=decades(-2, 2))
def test_potentials_move_by_a_logarithm_when_the_datum_does(
    material: solver.Material, case: dict[str, Any], heavier: float, further: float
) -> None:
    """depth / P and potentials / P at T = J = 0 depend on log(h / L) alone, so the datum can make up for the width."""
    case = {"material": material, **case, "charge": 0.0, "magnetic_charge": 0.0}
    one = solver.solve(case | {"datum": 1.0})
    two = solver.solve(case | {"load": heavier * case["load"], "datum": heavier**0.5})
    for name in ("depth", "voltage", "magnetic_potential"):
        np.testing.assert_allclose(two[name], heavier * one[name], rtol=1e-11, atol=1e-12 * heavier * spread(one, name))
    rates = [solver.solve(case | {"datum": datum}) for datum in (1.0, further, further**2)]
    for name in ("depth", "voltage", "magnetic_potential"):
        first, second = rates[1][name] - rates[0][name], rates[2][name] - rates[1][name]
        np.testing.assert_allclose(first, second, rtol=1e-11, atol=1e-12 * spread(one, name))


def spread(first: xr.Dataset, name: str) -> float:
    """A size of a potential that its own cancellation does not make small."""
    tangent = {"voltage": "voltage_per_load", "magnetic_potential": "magnetic_potential_per_load"}
    return float(abs(first[name])) + (float(abs(first[tangent[name]])) * 1e6 if name in tangent else 0.0)


@property_based
@given(material=materials(), case=loads(), times=between(-3, 3))
def test_charges_enter_affinely_and_leave_the_pressure_alone(
    material: solver.Material, case: dict[str, Any], times: float
) -> None:
    def at(share: float) -> xr.Dataset:
        charges = {name: share * case[name] for name in ("charge", "magnetic_charge")}
        return solver.solve({"material": material, **case, **charges}, POSITIONS, regular=True)

    none, first, part = at(0.0), at(1.0), at(times)
    names_left = [*MECHANICAL, *RATIOS]
    for name in names_left:
        np.testing.assert_array_equal(first[name], none[name], err_msg=name)
    for name in set(closed_form(none)) - set(names_left):
        if name.startswith("blocked"):
            continue  # a ratio of two affine functions
        sizes = [float(np.max(np.abs(values[name]))) for values in (none, first)]
        expected = none[name].values + times * (first[name].values - none[name].values)
        np.testing.assert_allclose(part[name], expected, rtol=1e-11, atol=1e-13 * max(sizes), err_msg=name)


@property_based
@given(material=materials(), case=loads())
def test_charges_act_one_by_one(material: solver.Material, case: dict[str, Any]) -> None:
    grid = {"charge": [0.0, case["charge"]], "magnetic_charge": [0.0, case["magnetic_charge"]]}
    out = solver.solve({"material": material, **case, **grid}, POSITIONS, regular=True)
    corners = {(i, j): out.isel(charge=i, magnetic_charge=j, drop=True) for i in (0, 1) for j in (0, 1)}
    linear = [name for name in closed_form(out) if not name.startswith("blocked")]
    mixed = corners[1, 1][linear] + corners[0, 0][linear] - corners[0, 1][linear]
    for name in linear:
        largest = max(float(np.max(np.abs(corner[name]))) for corner in corners.values())
        np.testing.assert_allclose(mixed[name], corners[1, 0][name], rtol=1e-11, atol=1e-13 * largest, err_msg=name)


@property_based
@given(case=loads())
def test_a_composite_s_end_is_the_phase(case: dict[str, Any]) -> None:
    for fraction, name in ((0.0, "CoFe2O4"), (1.0, "BaTiO3")):
        mixed = solver.solve({"volume_fraction": fraction, **case}, POSITIONS)
        pure = solver.solve({"material": name, **case}, POSITIONS)
        assert_same(mixed.drop_vars("volume_fraction"), pure.drop_vars("material"), rtol=1e-12)
