"""Surface fields of point contacts: the loads that they carry, Hankel's integrals, the textbook's sphere."""

from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.special import j0, j1

import solver
from solver.arrays import Array
from solver.halfplane.surface import HalfPlane
from solver.point.profile import Shape, halfspace_form
from tests.solver.point.points import BTO, FIBROUS

PUNCHES: list[dict[str, Any]] = [
    {"profile": "sphere", "radius": 5e-3},
    {"profile": "cone", "slope": 0.1},
    {"profile": "disc", "width": 1e-4},
    {"profile": "power", "exponent": 3.5, "coefficient": 1e6},
]
CHARGED = {"force": 10.0, "total_charge": 2e-9, "total_flux": 1e-6}
COATED = {"thickness": 1e-4, "surroundings": "insulated", "base": "rigid"}


def solved(case: dict[str, Any], positions: Array) -> dict[str, Array]:
    """Quantities and fields; tractions as (sigma_yy, D_y, B_y) besides."""
    values = {str(name): value.values for name, value in solver.solve(case, positions).items()}
    names = ("contact_pressure", "electric_displacement", "magnetic_induction")
    return values | {"tractions": np.stack([-values[names[0]], values[names[1]], values[names[2]]])}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("punch", PUNCHES, ids=lambda punch: punch["profile"])
@pytest.mark.parametrize("body", [{}, COATED], ids=["half-space", "film"])
def test_tractions_carry_the_loads(punch: dict[str, Any], body: dict[str, Any]) -> None:
    # r = a sin(angle) takes the edge's singularity away, the square in the angle most of an apex's
    nodes, weights = np.polynomial.legendre.leggauss(80)
    angle = np.pi / 2 * ((nodes + 1) / 2) ** 2
    weights = weights * np.pi / 4 * (nodes + 1)
    fields = solved({"material": FIBROUS} | punch | body | CHARGED, np.sin(angle))
    ring = 2 * np.pi * fields["contact_radius"] ** 2 * np.sin(angle) * np.cos(angle) * weights
    loads = -fields["tractions"] @ ring / np.array([CHARGED[name] for name in ("force", "total_charge", "total_flux")])
    np.testing.assert_allclose(loads, 1.0, rtol=1e-12)


@pytest.mark.parametrize("punch", [PUNCHES[0], PUNCHES[3]], ids=["sphere", "power"])
def test_strains_are_hankel_s_integrals(punch: dict[str, Any]) -> None:
    """u_r = int_0^inf k . t(k) J1(kr) dk with t(k) by quadrature; sigma_rr and sigma_tt follow by Hooke's law."""
    places = np.array([0.3, 0.8, 1.7, 3.0])
    fields = solved({"material": BTO} | punch | {"force": 10.0}, places)
    nodes, weights = np.polynomial.legendre.leggauss(400)
    angle, weights = np.pi / 4 * (nodes + 1), np.pi / 4 * weights
    inside = solved({"material": BTO} | punch | {"force": 10.0}, np.sin(angle))["tractions"]
    half = HalfPlane(BTO)
    sources = half.friction_coupling @ inside * weights * np.sin(angle) * np.cos(angle)
    panel, rule = np.polynomial.legendre.leggauss(20)
    k, rule = (2 * np.arange(300)[:, None] + 1 + panel).ravel(), np.tile(rule, 300)
    fade = np.exp(-((k / 300) ** 6))  # flat where it counts: averages over some 1/300 a, far from the edge
    spectrum = (sources @ j0(np.sin(angle)[:, None] * k)) * fade * rule
    hoop = -j1(places[:, None] * k) @ spectrum / places
    dilation = -j0(places[:, None] * k) @ (spectrum * k)
    pressed = half.in_plane_share @ fields["tractions"]
    shear = BTO.c11 - BTO.c12
    radial = half.in_plane_stiffness * dilation - shear * hoop + pressed
    tangential = (half.in_plane_stiffness - shear) * dilation + shear * hoop + pressed
    size = np.max(np.abs(radial))
    np.testing.assert_allclose(fields["radial_stress"] / size, radial / size, atol=2e-5)
    np.testing.assert_allclose(fields["hoop_stress"] / size, tangential / size, atol=2e-5)


@pytest.mark.parametrize("punch", PUNCHES[:3], ids=lambda punch: punch["profile"])
def test_stresses_on_a_film_are_those_inside_it(punch: dict[str, Any]) -> None:
    """(P5.1) and sums over k, against Hankel integrals of the densities, continued to the surface from 1e-3 a."""
    places, stresses = np.array([-0.4, 0.8, 1.2, -3.0]), ("radial_stress", "hoop_stress")
    case = (
        {"material": "BaTiO3", "punch": "steel", "thickness": 1e-4, "surroundings": "insulated", "base": "polyimide"}
        | punch
        | CHARGED
    )
    del case["total_flux"]
    fields, inside = solver.solve(case, places), solver.solve_interior(case, places, [0.0])
    for name, other in zip(stresses, ("stress_xx", "stress_zz"), strict=True):
        size = float(np.abs(fields[name]).max())
        np.testing.assert_allclose(fields[name], inside[other].squeeze(), atol=1e-9 * size, rtol=0)


def test_stresses_need_c12_and_a_bare_surface_and_a_cone_s_pressure_is_infinite_at_its_apex() -> None:
    without, stresses = {"material": replace(BTO, c12=np.array(np.nan))}, {"radial_stress", "hoop_stress"}
    for body in (without, without | COATED, {"material": "BaTiO3", "electrode": "top"} | COATED):
        assert not stresses & set(solver.solve(body | PUNCHES[0] | {"force": 1.0}, [0.0]).data_vars)
    with pytest.raises(solver.FactorError, match=r"^positions: the pressure of r\^1 is infinite at 0"):
        solver.solve({"material": "BaTiO3", "force": 1.0} | PUNCHES[1], [0.0])


@pytest.mark.parametrize("exponent", [0.4, 1.6])
def test_the_pressure_grows_towards_the_middle_as_in_50_digits(exponent: float) -> None:
    """F = int_0^x (1 - x^2 + v^2)^(e/2 - 1) dv, x = sqrt(1 - r^2), by quadrature in mpmath."""
    places = [1e-9, 1e-6, 1e-3, 0.5, 0.99]
    shape = Shape(exponent)
    ours = halfspace_form(shape, np.sqrt(1 - np.square(places)), np.array(places)) / (shape.rise * exponent)
    with mpmath.workdps(50):
        for r, value in zip(map(mpmath.mpf, places), ours, strict=True):
            breaks = [mpmath.mpf(0), *(r * 10**n for n in range(10) if r * 10**n < 0.9), mpmath.sqrt(1 - r**2)]
            exact = mpmath.quad(lambda v, r=r: (r**2 + v**2) ** (mpmath.mpf(exponent) / 2 - 1), breaks)
            assert value == pytest.approx(float(exact), rel=1e-12), r
