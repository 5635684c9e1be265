"""Integrals of the surface fields against the loads, by a quadrature of their regular forms; what holds pointwise."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given

import solver
from tests.solver.quadrature import Array, rule
from tests.solver.strategies import loads, materials, property_based

_RULE = rule()
_OUTSIDE = np.array([-1e6, -30.0, -2.0, -1 - 1e-12, 1 + 1e-12, 1.1, 5.0, 1e3])


@property_based
@given(material=materials(), case=loads(friction=4.0))
def test_tractions_carry_the_load_and_the_charges(material: solver.Material, case: dict[str, Any]) -> None:
    out = solver.solve({"material": material, **case}, _RULE.X, regular=True)
    half_width = (out.contact_trailing + out.contact_leading).item() / 2

    def total(regular: Array) -> tuple[float, float]:
        """Integral over x and that of the absolute value, of a field times sqrt(1 - X^2)."""
        terms = half_width * _RULE.weight * regular
        return float(terms.sum()), float(np.abs(terms).sum())

    shear = -case["friction"] * case["load"]
    assert total(out.contact_pressure.values * _RULE.root)[0] == pytest.approx(case["load"], rel=1e-12)
    assert total(out.shear_traction.values * _RULE.root)[0] == pytest.approx(shear, rel=1e-12)
    for name, charge in (("electric_displacement_y", "charge"), ("magnetic_induction_y", "magnetic_charge")):
        signed, absolute = total(-out[f"{name}_regular"].values)
        assert signed == pytest.approx(case[charge], rel=1e-12, abs=1e-12 * absolute), name


@property_based
@given(material=materials(), case=loads())
def test_nothing_acts_on_the_free_surface(material: solver.Material, case: dict[str, Any]) -> None:
    out = solver.solve({"material": material, **case}, _OUTSIDE, regular=True)
    names = ("contact_pressure", "shear_traction", "electric_displacement_y", "magnetic_induction_y")
    for name in (*names, "electric_displacement_y_regular", "magnetic_induction_y_regular"):
        assert not out[name].values.any(), name


@property_based
@given(material=materials(), case=loads())
def test_what_holds_at_every_point_of_the_contact(material: solver.Material, case: dict[str, Any]) -> None:
    """Coulomb's law, D_x = e15 sigma_xy / c44 and B_x likewise, pressure within its peak; field and regular form."""
    X = np.linspace(-0.9999, 0.9999, 201)
    out = solver.solve({"material": material, **case}, X, regular=True)
    pressure, shear = out.contact_pressure.values, out.shear_traction.values
    np.testing.assert_allclose(shear, -case["friction"] * pressure, rtol=1e-14)
    np.testing.assert_allclose(out.electric_displacement_x, float(material.e15 / material.c44) * shear, rtol=1e-12)
    np.testing.assert_allclose(out.magnetic_induction_x, float(material.f15 / material.c44) * shear, rtol=1e-12)
    assert np.all(pressure > 0)
    peak = out.peak_pressure.item()
    assert np.all(pressure <= peak * (1 + 1e-14))
    at_peak = solver.solve({"material": material, **case}, [1 - 2 * out.pressure_exponent.item()])
    assert at_peak.contact_pressure.item() == pytest.approx(
        peak, rel=1e-13
    )  # where alpha/(a - x) = (1 - alpha)/(x + b)
    for name in ("electric_displacement_y", "magnetic_induction_y", "stress_xx", "electric_displacement_x"):
        np.testing.assert_allclose(out[f"{name}_regular"], out[name] * np.sqrt(1 - X**2), rtol=1e-11, err_msg=name)


@property_based
@given(material=materials(), case=loads())
def test_edge_values_are_the_limits_of_the_fields(material: solver.Material, case: dict[str, Any]) -> None:
    out = solver.solve({"material": material, **case}, [-1 - 1e-15, -1 + 1e-15, 1 - 1e-15, 1 + 1e-15], regular=True)
    half_width = (out.contact_trailing + out.contact_leading).item() / 2
    for kind, name in (("electric", "electric_displacement_y"), ("magnetic", "magnetic_induction_y")):
        inside = np.sqrt(np.pi * half_width) * out[f"{name}_regular"].values
        edges = [out[f"{kind}_edge_intensity_{edge}"].item() for edge in ("leading", "trailing")]
        np.testing.assert_allclose(inside[[1, 2]], edges, rtol=1e-6, atol=1e-6 * max(map(abs, edges)), err_msg=name)
