"""Every quantity and surface field against the 50-digit oracle: extremes, speeds, roots and exponents that meet."""

import warnings
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpmath import isnan, mp, mpf
from scipy.optimize import brentq

import solver
from solver.halfplane.precision import TOLERATED, rounding
from solver.halfplane.speed import limiting_speed, transonic_speed
from solver.halfplane.surface import HalfPlane
from solver.material.constants import ANY_SIZE
from tests.solver.cases import assert_agrees
from verification import digits
from verification.cases import CHARGED, SIH_SONG, constants
from verification.oracles import precise
from verification.oracles.half_plane import half_plane
from verification.oracles.sample_materials import BARIUM_TITANATE, COBALT_FERRITE, isotropic
from verification.oracles.surface_response import surface_response

UP_TO_THE_EDGES = (-1e4, -3.17, -1 - 1e-7, -1 + 1e-7, -0.5, 0.0, 0.7, 1 - 1e-7, 1 + 1e-7, 1.49, 3.2, 1e4)


#: Materials that contacts along a line take.
AXIAL = [name for name, material in solver.materials().items() if material.axial]


def check(material: solver.Material, positions: tuple[float, ...], **change: float) -> None:
    case = CHARGED | change
    exact = precise.solve(constants(material), positions=positions, **case)
    assert_agrees(solver.solve({"material": material, **case}, positions), exact)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", AXIAL)
def test_built_in_materials(name: str) -> None:
    check(solver.find(name), digits.X)


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
    check(solver.find("steel"), (-1 - 1e-9, 1 + 1e-8, 1 + 1e-12), friction=10.0)


CASE = {"radius": 0.05, "load": 1e5, "friction": 0.3}


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


def test_at_the_limiting_speed_the_restricted_tensor_is_singular() -> None:
    def stiffness(speed: mpf) -> mpf:
        N = half_plane(constants(solver.find(SIH_SONG)), float(speed)).normal_compliance
        return 1 / (N[0, 0] - (N[0, 1:3] * mp.inverse(N[1:3, 1:3]) * N[1:3, 0])[0])

    limit = float(limiting_speed(solver.find(SIH_SONG), BOTH))
    at_rest, below, above = (stiffness(mpf(v)) for v in (0.0, limit * (1 - 1e-9), limit * (1 + 1e-9)))
    assert below > 0 > above
    assert abs(below) < 1e-6 * at_rest


#: Ceramics with c13 where a pair of roots coalesces on the imaginary axis: the discriminant is zero.
TITANATE, FERRITE = BARIUM_TITANATE | {"c13": 73530337388.73566}, COBALT_FERRITE | {"c13": 185950658976.0411}
ALUMINIUM = isotropic(70e9, 0.33)


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "material",
    [
        TITANATE, TITANATE | {"c13": TITANATE["c13"] * (1 + 1e-7)}, FERRITE,
        *(ALUMINIUM | {"c33": ALUMINIUM["c33"] * (1 + offset)} for offset in (-1e-8, 0.0, 1e-15)),
        isotropic(70e9, 0.2) | {"g11": 8e-9, "g33": 8e-9},  # three roots p = i, two of them with one eigenvector
        isotropic(5e6, 0.4999),
    ],
)  # fmt: skip
def test_roots_that_coincide_or_nearly_do(material: dict[str, float]) -> None:
    check(solver.Material.from_mapping(material), (-3.0, -1.001, -0.999, 0.25, 0.999, 1.001, 50.0))


MADE = {"c11": 211e9, "c13": 407e9, "c33": 1230e9, "e31": -2.5, "e33": 22.0, "e15": 9.6, "f31": 235.0, "f33": 1180.0}
MADE |= {"f15": 130.0, "eps11": 2.3e-9, "eps33": 9.5e-9, "g11": 0.0, "g33": 5e-9, "mu11": 107e-6, "mu33": 16e-6}


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
    material = solver.Material.from_mapping(MADE | {"c44": crossing() * (1 + offset)})
    check(material, (-20.0, -1.01, -0.99, -0.4, 0.3, 0.99, 1.01, 4.0), friction=1.5)


@pytest.mark.parametrize(("name", "share"), [(SIH_SONG, 0.999), ("steel", 0.6)])
def test_moving_punch_agrees_with_50_digits(name: str, share: float) -> None:
    positions = [-250.0, -1.7, -1.0001, -0.95, 0.2, 0.95, 1.0001, 4.0]
    case = CHARGED | {"friction": 0.6, "speed": float(limiting_speed(solver.find(name), BOTH)) * share}
    computed = solver.solve({"material": name, **case}, positions)
    exact = precise.solve(constants(solver.find(name)), **case, positions=positions)
    assert_agrees(computed, replace(exact, fields={}), 1e-10)
    for field, values in exact.fields.items():
        reference = np.array(values, float)
        scale = float(np.max(np.abs(reference)))
        np.testing.assert_allclose(computed[field], reference, rtol=1e-9, atol=1e-13 * scale, err_msg=field)
