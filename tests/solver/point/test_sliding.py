"""Sliding points to first order in friction: Hamilton's sphere, the half-space's shift, films by a second rule."""

from math import comb
from typing import Any

import numpy as np
import pytest

import solver
from solver.halfplane.surface import HalfPlane
from solver.point import slidingtable
from solver.point.profile import Shape, halfspace_peak
from tests.solver.point.points import FIBROUS
from verification.cases import constants
from verification.oracles import point
from verification.points import PROFILES

BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}


@pytest.mark.parametrize("punch", ["rigid", "steel"])
def test_half_space_shifts_by_half_the_plane_s_angle(punch: str) -> None:
    """c = -(a/pi) eta kappa/lambda."""
    case = BALL | {"friction": 0.3, "punch": punch}
    solution = solver.solve(case)
    half = HalfPlane(solver.find("BaTiO3"))
    steel = punch == "steel"
    N = half.compliance + steel * np.diag([2 * (1 - 0.3**2) / 210e9, 0.0, 0.0])
    k = half.friction_coupling + steel * np.array([1.3 * 0.4 / 210e9, 0.0, 0.0])
    inverse = np.linalg.inv(N)
    angle = 0.3 * float(inverse[0] @ k)
    offset = float(solution["contact_offset"] / solution["contact_radius"])
    assert offset == pytest.approx(-angle / np.pi, rel=1e-3 if steel else 1e-12)  # the library's steel is near that


def test_below_an_electrode_it_shifts_as_a_body_whose_surface_is_grounded() -> None:
    """phi = 0 on the surface takes D_y out of N and k; half-spaces are films of the base's own material."""
    titanate = solver.find("BaTiO3")
    bonded = {"thickness": 4e-5, "surroundings": "insulated", "base": "BaTiO3", "interface_electric": "bonded"}
    solution = solver.solve(BALL | bonded | {"friction": 0.3, "electrode": "top", "magnetic": "insulating"})
    half = HalfPlane(titanate)
    (N, k), phi = (half.compliance, half.friction_coupling), 1
    turned = k[0] - k[phi] * N[0, phi] / N[phi, phi]
    angle = 0.3 * turned / (N[0, 0] - N[0, phi] ** 2 / N[phi, phi])
    assert float(solution["contact_offset"] / solution["contact_radius"]) == pytest.approx(-angle / np.pi, rel=1e-12)


@pytest.mark.parametrize("body", [{}, {"thickness": 1e-4, "surroundings": "insulated", "base": "steel"}])
def test_pressure_next_to_the_edge_falls_as_a_root_of_the_distance(body: dict[str, Any]) -> None:
    """To the first order the root's exponent adds a logarithm; sums over depths of 1e-5 had no digits within 1e-4."""
    distance = np.array([1e-6, 1e-4, 1e-2])
    for side in (-1, 1):
        pressure = solver.solve(BALL | {"friction": 0.3} | body, side * (1 - distance))[
            "contact_pressure"
        ].values.ravel()
        over_root = pressure / np.sqrt(distance)
        assert abs(np.diff(over_root, 2)[0]) < 0.03 * over_root[1]


def test_tension_beside_the_trailing_edge_is_that_of_the_fields_inside() -> None:
    for body in ({}, {"thickness": 1e-4, "surroundings": "insulated", "base": "steel"}):
        case = BALL | {"friction": 0.3} | body
        edge = float(solver.solve(case)["trailing_tension"])
        gaps = np.array([1e-3, 2e-3, 4e-3, 8e-3])
        outside = solver.solve_interior(case, 1 + gaps, [0.0], fields=["stress_xx"])["stress_xx"].values.ravel()
        rows = gaps[:, None] ** np.array([0.0, 0.5, 1.0, 1.5])  # what friction adds falls as a root
        assert np.linalg.solve(rows, outside)[0] == pytest.approx(edge, rel=2e-4)


def test_films_do_not_hang_on_the_number_of_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    """With half as many nodes in b again."""
    case = BALL | {"thickness": 5e-5, "surroundings": "insulated", "base": "rigid", "friction": 0.3}
    names = ["contact_offset", "electric_edge_intensity_trailing", "magnetic_edge_intensity_leading"]
    usual = solver.solve(case)[names]
    monkeypatch.setattr(slidingtable, "_FIRST", 36)
    slidingtable.sliding_window.clear()
    finer = solver.solve(case)[names]
    slidingtable.sliding_window.clear()
    for name in names:
        np.testing.assert_allclose(usual[name], finer[name], rtol=1e-9, atol=0)


POWER: dict[str, Any] = {"material": "BaTiO3", "profile": "power", "exponent": 4.0, "coefficient": 1e8, "force": 10.0}
RAISED: dict[str, Any] = BALL | {
    "force": 30.0,
    "thickness": 1e-4,
    "surroundings": "insulated",
    "base": "polyimide",
}  # largest at 0.7 a


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", [BALL, POWER, POWER | {"exponent": 2.5, "coefficient": 1e3}, RAISED],
                         ids=["ball", "power", "kinked power", "film"])  # fmt: skip
def test_largest_pressure_is_that_of_the_fields_on_the_surface(case: dict[str, Any]) -> None:
    """The fields are computed inside and continued to the surface: another way from the same densities."""
    sliding = case | {"friction": 0.3}
    coarse = np.linspace(-0.98, 0.98, 50)
    best = coarse[np.argmax(solver.solve(sliding, coarse)["contact_pressure"].values.ravel())]
    near = best + 0.04 * np.cos(np.pi * np.arange(9) / 8)
    pressure = solver.solve(sliding, near)["contact_pressure"].values.ravel()
    series = np.polynomial.chebyshev.Chebyshev.fit(near, pressure, 8)
    top = float(np.max(series(best + 0.04 * np.linspace(-1, 1, 20001))))
    assert float(solver.solve(sliding)["peak_pressure"]) == pytest.approx(top, rel=1e-8)


def test_a_sharp_apex_bears_what_it_bears_at_rest() -> None:
    blunt = solver.solve(POWER | {"exponent": 1.5, "coefficient": 1.0, "friction": np.array([0.0, 0.3])})
    assert float(blunt["peak_pressure"][1]) == float(blunt["peak_pressure"][0])


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("punch", "exponent", "coefficient"), PROFILES)
@pytest.mark.parametrize("conducts", [(True, True), (True, False), (False, True), (False, False)])
def test_every_quantity_to_1e_13(
    punch: dict[str, Any], exponent: float, coefficient: float, conducts: tuple[bool, bool]
) -> None:
    charge, flux = np.where(conducts, (3e-10, -2e-8), 0.0).tolist()
    electric, magnetic = ("conducting" if conducting else "insulating" for conducting in conducts)
    case = {"material": FIBROUS, "force": 10.0, "total_charge": charge, "total_flux": flux, "electric": electric}
    solution = solver.solve(case | punch | {"magnetic": magnetic, "punch_modulus": 210e9, "punch_poisson": 0.3})
    exact = point.quantities(
        constants(FIBROUS), exponent=exponent, coefficient=coefficient, force=10.0, charge=charge,
        magnetic_charge=flux, conducted=tuple(i for i in (1, 2) if conducts[i - 1]),
        punch_compliance=2 * (1 - 0.3**2) / 210e9,
    )  # fmt: skip
    if exponent > 2:
        exact.pop("peak_pressure")  # not at the centre
    assert set(exact) <= set(solution)
    for name, value in exact.items():
        assert float(solution[name]) == pytest.approx(value, rel=1e-13), name


@pytest.mark.parametrize("exponent", [4, 6, 10])
def test_pressure_is_largest_beside_the_centre_above_the_exponent_2(exponent: int) -> None:
    # int_r^1 t^(e-1) / sqrt(t^2 - r^2) dt of an even exponent is a polynomial in x = sqrt(1 - r^2)
    half = exponent // 2 - 1
    x = np.linspace(0, 1, 200001)
    values = sum(comb(half, k) * (1 - x**2) ** (half - k) * x ** (2 * k + 1) / (2 * k + 1) for k in range(half + 1))
    exact = exponent * Shape(exponent).rise * np.max(values)
    assert halfspace_peak(Shape(exponent)) == pytest.approx(exact, rel=1e-9)
