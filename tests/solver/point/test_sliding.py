"""Sliding points to first order in friction: the half-space's shift, largest pressures, tension at the edge."""

from math import comb
from typing import Any

import numpy as np
import pytest

import solver
from solver.halfplane.surface import HalfPlane
from solver.point.profile import Shape, halfspace_peak
from tests.solver.cases import BTO, FIBROUS

BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}
FILM: dict[str, Any] = BALL | {"thickness": 1e-4, "surroundings": "insulated", "base": "steel"}


@pytest.mark.parametrize("elastic", [False, True])
def test_half_space_shifts_by_half_the_plane_s_angle(*, elastic: bool) -> None:
    """c = -(a/pi) eta kappa/lambda, of a rigid punch and of one with 210 GPa and nu = 0.3."""
    punch = {"punch_modulus": 210e9, "punch_poisson": 0.3} if elastic else {}
    solution, half = solver.solve(BALL | {"friction": 0.3} | punch), HalfPlane(BTO)
    N = half.compliance + elastic * np.diag([2 * (1 - 0.3**2) / 210e9, 0.0, 0.0])
    k = half.friction_coupling + elastic * np.array([1.3 * 0.4 / 210e9, 0.0, 0.0])
    angle = 0.3 * float(np.linalg.inv(N)[0] @ k)
    assert float(solution["contact_offset"] / solution["contact_radius"]) == pytest.approx(-angle / np.pi, rel=1e-12)


def test_below_an_electrode_it_shifts_as_a_body_whose_surface_is_grounded() -> None:
    """phi = 0 on the surface takes D_y out of N and k; half-spaces are films of the base's own material."""
    bonded = {"thickness": 4e-5, "surroundings": "insulated", "base": "BaTiO3", "interface_electric": "bonded"}
    solution = solver.solve(BALL | bonded | {"friction": 0.3, "electrode": "top", "magnetic": "insulating"})
    half = HalfPlane(BTO)
    (N, k), phi = (half.compliance, half.friction_coupling), 1
    turned = k[0] - k[phi] * N[0, phi] / N[phi, phi]
    angle = 0.3 * turned / (N[0, 0] - N[0, phi] ** 2 / N[phi, phi])
    assert float(solution["contact_offset"] / solution["contact_radius"]) == pytest.approx(-angle / np.pi, rel=1e-12)


@pytest.mark.parametrize("case", [BALL, FILM], ids=["half-space", "film"])
def test_pressure_next_to_the_edge_falls_as_a_root_of_the_distance(case: dict[str, Any]) -> None:
    """To the first order the root's exponent adds a logarithm; sums over depths of 1e-5 had no digits within 1e-4."""
    distance = np.array([1e-6, 1e-4, 1e-2])
    for side in (-1, 1):
        solution = solver.solve(case | {"friction": 0.3}, side * (1 - distance))
        over_root = solution["contact_pressure"].values.ravel() / np.sqrt(distance)
        assert abs(np.diff(over_root, 2)[0]) < 0.03 * over_root[1]


POWER: dict[str, Any] = {"material": "BaTiO3", "profile": "power", "exponent": 4.0, "coefficient": 1e8, "force": 10.0}
RAISED = FILM | {"force": 30.0, "base": "polyimide"}  # largest at 0.7 a


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


@pytest.mark.parametrize("exponent", [4, 6, 10])
def test_pressure_is_largest_beside_the_centre_above_the_exponent_2(exponent: int) -> None:
    # int_r^1 t^(e-1) / sqrt(t^2 - r^2) dt of an even exponent is a polynomial in x = sqrt(1 - r^2)
    half = exponent // 2 - 1
    x = np.linspace(0, 1, 200001)
    values = sum(comb(half, k) * (1 - x**2) ** (half - k) * x ** (2 * k + 1) / (2 * k + 1) for k in range(half + 1))
    exact = exponent * Shape(exponent).rise * np.max(values)
    assert halfspace_peak(Shape(exponent)) == pytest.approx(exact, rel=1e-9)


AIR: dict[str, Any] = BALL | {"magnetic": "insulating", "surroundings": "air"}
EDGES: dict[str, dict[str, Any]] = {
    "half-space": BALL,
    "film": FILM,
    "half-space in air": AIR,
    "film in air": AIR | {"thickness": 1e-4, "base": "rigid", "force": 37.0},
    "charged composite in air": AIR | {"material": FIBROUS, "total_charge": 2e-10, "magnetic": "conducting"},
}


@pytest.mark.parametrize("name", EDGES)
def test_tension_beside_the_trailing_edge_is_that_of_the_fields_inside(name: str) -> None:
    """Sums over b and waves, extrapolated to the edge, against moments and rates."""
    case, air = EDGES[name] | {"friction": 0.3}, "air" in name
    gaps = (4e-4 if air else 1e-3) * 2.0 ** np.arange(5 if air else 4)
    stresses = solver.solve_interior(case, 1 + gaps, [0.0], fields=["stress_xx"])["stress_xx"].values.ravel()
    rows = gaps[:, None] ** (0.5 * np.arange(len(gaps)))  # what friction adds falls as a root
    edge = float(solver.solve(case)["trailing_tension"])
    assert np.linalg.solve(rows, stresses)[0] == pytest.approx(edge, rel=1e-3 if air else 2e-4)
