"""Classical limits: Hertz, Guler & Erdogan's isotropic sliding, Betti reciprocity."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from scipy.special import roots_jacobi

import solver
from tests.solver.strategies import between, decades, loads, materials, property_based

YOUNG, POISSON = decades(6, 12), between(0.0, 0.49)
X = np.array([-40.0, -1.5, -1 - 1e-3, -0.999, -0.4, 0.0, 0.6, 0.999, 1 + 1e-3, 2.5])


@property_based
@given(young=YOUNG, poisson=POISSON, radius=decades(-3, 1), load=decades(0, 6))
def test_hertz(young: float, poisson: float, radius: float, load: float) -> None:
    """Johnson (Contact Mechanics, 1985), sections 4.2 and 5.6: line contact without friction."""
    out = solver.solve({"material": solver.Material.isotropic(young, poisson), "radius": radius, "load": load}, X)
    modulus = young / (1 - poisson**2)
    a = np.sqrt(4 * radius * load / (np.pi * modulus))
    peak = 2 * load / (np.pi * a)
    pressure = peak * np.sqrt(np.maximum(1 - X**2, 0))
    for name, value in {"contact_trailing": a, "contact_leading": a, "peak_pressure": peak}.items():
        assert out[name].item() == pytest.approx(value, rel=1e-13), name
    depth = 2 * load / (np.pi * modulus) * (np.log(2 / a) + 0.5)
    assert out.depth.item() == pytest.approx(depth, rel=1e-12, abs=1e-14 * load / modulus)
    assert out.pressure_exponent.item() == 0.5
    np.testing.assert_allclose(out.contact_pressure, pressure, rtol=1e-13)
    np.testing.assert_allclose(out.stress_xx, -pressure, rtol=1e-12)
    for name in ("voltage", "magnetic_potential", "trailing_tension", "voltage_per_load", "stroke_per_ampere"):
        assert out[name].item() == 0, name
    for name in ("shear_traction", "electric_displacement_y", "magnetic_induction_y", "electric_displacement_x"):
        assert not out[name].values.any(), name


@property_based
@given(young=YOUNG, poisson=POISSON, friction=between(0.01, 3.0))
def test_isotropic_sliding(young: float, poisson: float, friction: float) -> None:
    """Guler and Erdogan (Int. J. Mech. Sci. 49, 2007): exponent and ends; sigma_xx by a Gauss-Jacobi quadrature."""
    material = solver.Material.isotropic(young, poisson)
    out = solver.solve({"material": material, "radius": 0.05, "load": 1e4, "friction": friction}, X)
    alpha = np.arctan2(1, friction * (1 - 2 * poisson) / (2 * (1 - poisson))) / np.pi
    assert out.pressure_exponent.item() == pytest.approx(alpha, rel=1e-13)
    width = np.sqrt(4 * (1 - poisson**2) / young * 0.05 * 1e4 / (np.pi * alpha * (1 - alpha)))
    assert out.contact_trailing.item() == pytest.approx((1 - alpha) * width, rel=1e-12)
    assert out.contact_leading.item() == pytest.approx(alpha * width, rel=1e-12)

    scale = np.sin(np.pi * alpha) * young / (2 * (1 - poisson**2)) / 0.05 * width / 2
    inside = np.abs(X) < 1
    pressure = np.zeros(X.size)
    pressure[inside] = scale * (1 - X[inside]) ** alpha * (1 + X[inside]) ** (1 - alpha)
    np.testing.assert_allclose(out.contact_pressure, pressure, rtol=1e-11)
    nodes, weights = roots_jacobi(400, alpha, 1 - alpha)
    far = np.abs(X) > 1.2  # sigma_xx = sigma_yy - (2/pi) int sigma_xy(s)/(x-s) ds, and sigma_xy = -eta p
    sliding = 2 / np.pi * friction * scale * (weights / (X[far, None] - nodes)).sum(axis=1)
    np.testing.assert_allclose(out.stress_xx.values[far], sliding, rtol=1e-11)


@property_based
@given(material=materials(), case=loads(), datum=decades(0, 2))
def test_reciprocity_without_friction(material: solver.Material, case: dict[str, Any], datum: float) -> None:
    """d depth/dT = -V/P and d depth/dJ = -Psi/P, the right-hand sides without charges."""
    case = {"material": material, **case, "friction": 0.0, "datum": datum}
    grid = {"charge": [0.0, 1e-3], "magnetic_charge": [0.0, 1.0]}
    out = solver.solve(case | grid)
    at_rest = out.isel(charge=0, magnetic_charge=0)
    for name, potential in (("charge", "voltage"), ("magnetic_charge", "magnetic_potential")):
        moved = out.isel({other: 1 if other == name else 0 for other in grid})
        change = (moved.depth - at_rest.depth).item()
        expected = -at_rest[potential].item() / case["load"] * grid[name][1]
        assert change == pytest.approx(expected, rel=1e-10, abs=1e-13 * abs(at_rest.depth.item())), name
    # and so the charge that undoes the voltage is that which moves the punch by a volt
    for stroke, sensitivity in (("stroke_per_volt", "charge_per_force"), ("stroke_per_ampere", "flux_per_force")):
        assert at_rest[stroke].item() == pytest.approx(at_rest[sensitivity].item(), rel=1e-10), stroke


@property_based
@given(material=materials(), case=loads())
def test_fields_decay_along_the_surface_as_one_over_distance(material: solver.Material, case: dict[str, Any]) -> None:
    far = np.array([-1e9, -1e7, 1e7, 1e9])
    out = solver.solve({"material": material, **case}, far)
    for name in ("stress_xx", "electric_displacement_x", "magnetic_induction_x"):
        moments = out[name].values * far
        np.testing.assert_allclose(moments, moments[0], rtol=1e-5, err_msg=name)


@property_based
@given(material=materials(), case=loads(friction=1.0))
def test_far_stress_is_flamant_s(material: solver.Material, case: dict[str, Any]) -> None:
    """Far out only the shear force tells: sigma_xx x -> -(edge stress slope), in the ratio of the resultants."""
    out = solver.solve({"material": material, **case, "friction": case["friction"] + 0.01}, [1e9])
    half_width = (out.contact_trailing + out.contact_leading).item() / 2
    per_force = out.trailing_tension.item() / out.contact_trailing.item()  # stiffness * L^-1_xx * eta / (lam R)
    alpha = out.pressure_exponent.item()
    # int p dx = P = pi alpha (1 - alpha) l^2 / (2 lam R), so that lam R drops out
    lam_radius = np.pi * alpha * (1 - alpha) * (2 * half_width) ** 2 / (2 * case["load"])
    expected = per_force * lam_radius * case["load"] / np.pi / (1e9 * half_width)
    assert out.stress_xx.item() == pytest.approx(expected, rel=1e-7)
