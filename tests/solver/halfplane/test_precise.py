"""Every quantity and surface field against the 50-digit oracle: extremes, speeds, roots and exponents that meet."""

import warnings
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpmath import cos, isnan, mp, mpf, pi, sin
from scipy.optimize import brentq

import solver
from solver.halfplane.precision import TOLERATED, rounding
from solver.halfplane.speed import limiting_speed, transonic_speed
from solver.halfplane.surface import HalfPlane
from solver.material.constants import ANY_SIZE
from tests.solver.cases import CHARGED, assert_agrees
from verification.cases import SIH_SONG, constants
from verification.oracles import precise
from verification.oracles.half_plane import half_plane
from verification.oracles.sample_materials import BARIUM_TITANATE, COBALT_FERRITE, isotropic
from verification.oracles.surface_response import surface_response

POSITIONS = (-1e4, -1.2, -0.999, 0.1, 0.8, 30.0)
UP_TO_THE_EDGES = (-1e4, -3.17, -1 - 1e-7, -1 + 1e-7, -0.5, 0.0, 0.7, 1 - 1e-7, 1 + 1e-7, 1.49, 3.2, 1e4)


#: Materials that contacts along a line take.
AXIAL = [name for name, material in solver.materials().items() if material.axial]


def check(factors: dict[str, Any], exact_constants: dict[str, Any], positions: tuple[float, ...]) -> None:
    contact = {name: value for name, value in factors.items() if name in CHARGED}
    exact = precise.solve(exact_constants, positions=positions, **contact)
    assert_agrees(solver.solve(factors, positions), exact)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", AXIAL)
def test_built_in_materials(name: str) -> None:
    check({"material": name} | CHARGED, constants(solver.find(name)), POSITIONS)


@pytest.mark.parametrize(
    ("name", "friction", "conducted"),
    [(SIH_SONG, 1.3, (1, 2)), (SIH_SONG, 0.0, (1,)), ("PZT-5H", 0.4, ()), ("PZT-5H", 1e-9, (2,))],
)
def test_conduction(name: str, friction: float, conducted: tuple[int, ...]) -> None:
    """A quantity that an insulating punch lacks is NaN by the oracle and absent from the solution."""
    case: dict[str, Any] = {"radius": 0.03, "load": 4e4, "friction": friction, "datum": 0.2}
    case |= {"charge": 1e-6 * (1 in conducted), "magnetic_charge": -2e-3 * (2 in conducted)}
    case |= {"electric" if i == 1 else "magnetic": "insulating" for i in (1, 2) if i not in conducted}
    exact = precise.solve(constants(solver.find(name)), positions=UP_TO_THE_EDGES, **case)
    computed = solver.solve({"material": name, **case}, UP_TO_THE_EDGES)
    absent = {quantity for quantity, value in exact.quantities.items() if isnan(value)}
    assert not absent & set(computed)
    known = {quantity: value for quantity, value in exact.quantities.items() if quantity not in absent}
    assert_agrees(computed, replace(exact, quantities=known, fields={}), 2e-13)
    assert_agrees(computed, replace(exact, quantities={}), 2e-12)


def test_fields_outside_the_very_edges() -> None:
    """Steel under steep friction has a small pressure exponent: rounding of 1/X would show in sigma_xx."""
    positions = (-1 - 1e-9, 1 + 1e-8, 1 + 1e-12)
    check({"material": "steel", **CHARGED, "friction": 10.0}, constants(solver.find("steel")), positions)


CASE = {"radius": 0.05, "load": 1e5, "friction": 0.3}


def orthotropic(c11: float, c33: float, c13: float, c44: float) -> tuple[solver.Material, float, float]:
    """An elastic material with N11 and k1 in closed form (Ting, Anisotropic Elasticity, 1996, section 6.9)."""
    mean = np.sqrt(c11 * c33)
    S21 = np.sqrt(c44 * (mean - c13) / (c33 * (c13 + 2 * c44 + mean)))
    constants = {"c11": f"{c11!r} Pa", "c13": f"{float(c13)!r} Pa", "c33": f"{c33!r} Pa", "c44": f"{c44!r} Pa"}
    material = solver.Material.from_mapping({"name": "orthotropic", **constants})
    return material, 1 / (np.sqrt(c33 / c11) * (mean + c13) * S21), -1 / (mean + c13)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("c44", [2.0, 2e2, 2e5, 2e8, 2e11, 2e20])
@pytest.mark.parametrize("c33", [2e2, 2e11, 2e20])
def test_the_estimate_follows_the_error_of_strongly_anisotropic_materials(c33: float, c44: float) -> None:
    material, lam, kap = orthotropic(2e11, c33, 0.3 * np.sqrt(2e11 * c33), c44)
    half = HalfPlane(material)
    error = max(abs(half.compliance[0, 0] / lam - 1), abs(half.friction_coupling[0] - kap) / lam)
    assert error <= max(30 * rounding(half), 1e-11)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("short", [1e-3, 1e-9, 1e-12, 1e-15])
@pytest.mark.parametrize("name", ["steel", "PZT-5H"])
def test_the_estimate_follows_the_error_next_to_the_limiting_speed(name: str, short: float) -> None:
    material = solver.find(name)
    speed = np.asarray(limiting_speed(material) * (1 - short))
    exact = np.array(half_plane(constants(material), float(speed)).normal_compliance.tolist(), dtype=float)
    half = HalfPlane(material, speed)
    size = np.sqrt(np.abs(np.diag(exact)))
    error = float(np.max(np.abs(half.compliance - exact) / np.outer(size, size)))
    assert error <= max(30 * rounding(half), 1e-11)
    assert (rounding(half) > TOLERATED) == (short < 1e-6)


def test_lost_digits_are_warned_of_in_words() -> None:
    sheared = replace(solver.find("BaTiO3"), c44=np.asarray(43.0), name="sheared", any_size=ANY_SIZE)
    with pytest.warns(solver.PrecisionWarning, match="sheared: constants so far apart that rounding costs digits"):
        solver.solve({"material": sheared, **CASE})
    speed = float(limiting_speed(solver.find("steel"))) * (1 - 1e-14)
    with pytest.warns(solver.PrecisionWarning, match="steel: a speed so near the limiting one that"):
        solver.solve({"material": "steel", "speed": speed, **CASE})


def test_ordinary_materials_are_not_warned_of() -> None:
    with warnings.catch_warnings(action="error"):
        solver.solve({"material": AXIAL, **CASE, "load": 1e3})  # rubber stays in small strain
        solver.solve({"volume_fraction": np.linspace(0, 1, 5), "composite": ["fibrous", "laminate"], **CASE})


BOTH = np.array([True, True])


def test_limiting_speed_of_isotropic_solids_is_that_of_rayleigh_waves() -> None:
    for poisson in (0.0, 0.2, 0.3, 0.45):
        material = solver.Material.isotropic(200e9, poisson, rho=7850.0)
        shear = np.sqrt(float(material.c44) / 7850)
        ratio = (1 - 2 * poisson) / (2 - 2 * poisson)

        def rayleigh(v: float, ratio: float = ratio) -> float:
            return float((2 - v * v) ** 2 - 4 * np.sqrt((1 - v * v) * (1 - ratio * v * v)))

        expected = shear * brentq(rayleigh, 0.5, 1 - 1e-12, xtol=1e-15)
        assert float(limiting_speed(material, BOTH)) == pytest.approx(expected, rel=1e-12)
        assert float(transonic_speed(material)) == pytest.approx(shear, rel=1e-12)


@pytest.mark.soak
def test_at_the_limiting_speed_the_restricted_tensor_is_singular() -> None:
    def stiffness(speed: mpf) -> mpf:
        N = half_plane(constants(solver.find(SIH_SONG)), float(speed)).normal_compliance
        return 1 / (N[0, 0] - (N[0, 1:3] * mp.inverse(N[1:3, 1:3]) * N[1:3, 0])[0])

    limit = float(limiting_speed(solver.find(SIH_SONG), BOTH))
    at_rest, below, above = (stiffness(mpf(v)) for v in (0.0, limit * (1 - 1e-9), limit * (1 + 1e-9)))
    assert below > 0 > above
    assert abs(below) < 1e-6 * at_rest


@pytest.mark.soak
def test_at_the_transonic_speed_a_root_becomes_real() -> None:
    name = "PZT-5H"
    speed = float(transonic_speed(solver.find(name)))
    half = half_plane(constants(solver.find(name)))
    inertia = mpf(constants(solver.find(name))["rho"]) * mpf(speed) ** 2
    units = mp.diag([1, 1, mpf(10) ** 10, mpf(10) ** 8])

    def determinant(angle: mpf, factor: float) -> mpf:
        c, s = cos(angle), sin(angle)
        whole = half.Q * c**2 + (half.R + half.R.T) * (s * c) + half.T * s**2
        moving = whole - mp.diag([1, 1, 0, 0]) * (inertia * factor * c**2)
        return mp.det(units * moving * units / mpf(10) ** 11)

    angles = [pi * k / 720 for k in range(-359, 360)]
    sign = determinant(mpf(0), 0.0)
    assert all(determinant(angle, 1 - 1e-6) * sign > 0 for angle in angles)
    lowest = min(angles, key=lambda angle: determinant(angle, 1.0) * sign)
    assert any(determinant(lowest + pi * k / 72000, 1 + 1e-6) * sign < 0 for k in range(-200, 201))


ROOT_POSITIONS = (-3.0, -1.001, -0.999, 0.25, 0.999, 1.001, 50.0)


#: Ceramics with c13 moved until a pair of roots coalesces on the imaginary axis, where the discriminant is zero.
COALESCING = {
    "titanate": BARIUM_TITANATE | {"c13": 73530337388.73566},
    "ferrite": COBALT_FERRITE | {"c13": 185950658976.0411},
}


ALUMINIUM = isotropic(70e9, 0.33)


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "material",
    [
        *(COALESCING[name] | {"c13": COALESCING[name]["c13"] * (1 + offset)}
          for name, offset in (("titanate", 0.0), ("titanate", 1e-7), ("ferrite", 0.0))),
        *(ALUMINIUM | {"c33": ALUMINIUM["c33"] * (1 + offset)} for offset in (-1e-8, 0.0, 1e-15)),
        isotropic(70e9, 0.2) | {"g11": 8e-9, "g33": 8e-9},  # three roots p = i, two of them with one eigenvector
        isotropic(5e6, 0.4999),
    ],
)  # fmt: skip
def test_roots_that_coincide_or_nearly_do(material: dict[str, float]) -> None:
    constants = {name: value for name, value in material.items() if name != "rho"}
    exact = precise.solve(constants, positions=ROOT_POSITIONS, **CHARGED)
    computed = solver.solve({"material": solver.Material.from_mapping(constants), **CHARGED}, ROOT_POSITIONS)
    assert_agrees(computed, exact)


MADE = {"c11": 211e9, "c13": 407e9, "c33": 1230e9, "e31": -2.5, "e33": 22.0, "e15": 9.6, "f31": 235.0, "f33": 1180.0}
MADE |= {"f15": 130.0, "eps11": 2.3e-9, "eps33": 9.5e-9, "g11": 0.0, "g33": 5e-9, "mu11": 107e-6, "mu33": 16e-6}
CROSSING_POSITIONS = (-20.0, -1.01, -0.99, -0.4, 0.3, 0.99, 1.01, 4.0)
CONTACT: dict[str, Any] = CHARGED | {"friction": 1.5}


def coupling(c44: float) -> float:
    """kap/lam by Schur complement of the oracle's compliance."""
    surface = surface_response(MADE | {"c44": c44})
    units = np.array([1.0, 1e10, 1e8])
    N, k = surface.normal_compliance / np.outer(units, units), surface.shear_coupling / units
    inverse = np.linalg.inv(N[1:, 1:])
    return float((k[0] - N[0, 1:] @ inverse @ k[1:]) / (N[0, 0] - N[0, 1:] @ inverse @ N[1:, 0]))


@cache
def crossing() -> float:
    """c44 at which kap is zero."""
    return float(brentq(coupling, 12e9, 60e9, xtol=1e-6, rtol=1e-15))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("offset", [0.0, 1e-9, -1e-13, 0.1])
def test_values_at_and_about_the_crossing(offset: float) -> None:
    c44 = crossing() * (1 + offset)
    exact = precise.solve(MADE | {"c44": c44}, positions=CROSSING_POSITIONS, **CONTACT)
    material = solver.Material.from_mapping(MADE | {"c44": c44})
    assert_agrees(solver.solve({"material": material, **CONTACT}, CROSSING_POSITIONS), exact)


@pytest.mark.parametrize(("name", "share"), [(SIH_SONG, 0.999), ("steel", 0.6)])
def test_moving_punch_agrees_with_50_digits(name: str, share: float) -> None:
    positions = [-250.0, -1.7, -1.0001, -0.95, 0.2, 0.95, 1.0001, 4.0]
    speed = float(limiting_speed(solver.find(name), BOTH)) * share
    case: dict[str, Any] = {"radius": 0.03, "load": 4e4, "friction": 0.6, "datum": 0.2}
    case |= {"charge": 1e-6, "magnetic_charge": -2e-3}
    computed = solver.solve({"material": name, **case, "speed": speed}, positions)
    exact = precise.solve(constants(solver.find(name)), **case, speed=speed, positions=positions)
    for quantity, value in exact.quantities.items():
        np.testing.assert_allclose(computed[quantity].item(), float(value), rtol=1e-10, err_msg=quantity)
    for field, values in exact.fields.items():
        reference = np.array(values, float)
        scale = float(np.max(np.abs(reference)))
        np.testing.assert_allclose(computed[field], reference, rtol=1e-9, atol=1e-13 * scale, err_msg=field)
