"""Steady sliding: agreement with 50 digits up to the limiting speed, and that speed against its own equations."""

from typing import Any

import numpy as np
import pytest
from mpmath import cos, mp, mpf, pi, sin
from scipy.optimize import brentq

import solver
from solver.halfplane.speed import limiting_speed, transonic_speed
from verification.cases import SIH_SONG, constants
from verification.oracles import precise
from verification.oracles.half_plane import half_plane

POSITIONS = [-250.0, -1.7, -1.0001, -0.95, 0.2, 0.95, 1.0001, 4.0]
BOTH = np.array([True, True])


@pytest.mark.parametrize(("name", "share"), [(SIH_SONG, 0.999), ("steel", 0.6)])
def test_moving_punch_agrees_with_50_digits(name: str, share: float) -> None:
    speed = float(limiting_speed(solver.find(name), BOTH)) * share
    case: dict[str, Any] = {"radius": 0.03, "load": 4e4, "friction": 0.6, "datum": 0.2}
    case |= {"charge": 1e-6, "magnetic_charge": -2e-3}
    computed = solver.solve({"material": name, **case, "speed": speed}, POSITIONS)
    exact = precise.solve(constants(solver.find(name)), **case, speed=speed, positions=POSITIONS)
    for quantity, value in exact.quantities.items():
        np.testing.assert_allclose(computed[quantity].item(), float(value), rtol=1e-10, err_msg=quantity)
    for field, values in exact.fields.items():
        reference = np.array(values, float)
        scale = float(np.max(np.abs(reference)))
        np.testing.assert_allclose(computed[field], reference, rtol=1e-9, atol=1e-13 * scale, err_msg=field)


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
