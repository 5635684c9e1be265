"""Discs that float: capacitances, potentials by the charges on them in real space, and what they do to a reading."""

from typing import Any

import numpy as np
import pytest
from scipy.special import jv, lpmv, spherical_jn

import solver
from solver.arrays import Array
from solver.point.floating import Discs
from tests.solver.line.test_floating import BETWEEN, COVERED, PERMITTIVITY, PIEZO

#: Charges of discs of one dielectric between two grounded planes are images, with alternating signs, 2 apart.
IMAGES = np.arange(1, 41)[:, None]
BALL: dict[str, Any] = {"profile": "sphere", "radius": 0.01, "punch": "skin", "force": 0.05, "electric": "insulating"}
READ: dict[str, Any] = BALL | {"magnetic": "insulating", "body": COVERED, "collector": 2, "patch_size": 5e-4}


def test_a_small_disc_has_that_of_a_disc_in_a_dielectric_less_its_images() -> None:
    """8 eps b / (1 - 2 b log 2 / pi), to the third power of b."""
    radius = 0.025
    found = Discs(BETWEEN, 2, 2 * radius, 1.0, 0).capacitance
    assert found == pytest.approx(8 * PERMITTIVITY * radius / (1 - 2 * radius * np.log(2) / np.pi), rel=radius**3)


def rule(distance: float, radius: float, nodes: int = 28, angles: int = 48) -> tuple[Array, Array, Array]:
    """Places on a disc (n, 2), x = sqrt(1 - r^2/b^2) and weights of x times an integral, seen from (distance, 0).

    Within the disc, polar about where it is seen from, so that the weights hold the distance; beyond, about its middle.
    """
    X, W = np.polynomial.legendre.leggauss(nodes)
    turn = 2 * np.pi * (np.arange(angles) + 0.5) / angles
    if distance < radius:  # rho = far (1 - t^2)
        along = distance * np.cos(turn)
        root = np.sqrt(radius**2 - distance**2 + along**2)
        far, near = root - along, root + along
        t = (1 + X) / 2
        rho = far[:, None] * (1 - t**2)
        x = np.sqrt((far[:, None] - rho) * (rho + near[:, None])) / radius
        weight = far[:, None] * 2 * t * W / 2 * (2 * np.pi / angles) * rho
        at = np.stack([distance + rho * np.cos(turn)[:, None], rho * np.sin(turn)[:, None]], -1)
        return at.reshape(-1, 2), x.ravel(), (weight / x).ravel()
    t = np.pi / 4 * (1 + X)
    r = radius * np.sin(t)
    at = np.stack([r * np.cos(turn)[:, None], r * np.sin(turn)[:, None]], -1)
    weight = np.broadcast_to(radius**2 * np.sin(t) * W * np.pi / 4 * 2 * np.pi / angles, at.shape[:-1])
    return at.reshape(-1, 2), np.broadcast_to(np.cos(t), at.shape[:-1]).ravel(), weight.ravel()


def by_charges(discs: Discs, place: Array) -> float:
    """Potential at a place of the level, of the charges on all discs, by their densities P_l^m(x)/x."""
    b, (degree, m, sine) = discs.size / 2, discs.terms
    sizes = (discs.charges @ discs.voltages).reshape(len(discs.places), -1) / float(discs.stack.scale[2]) ** 2
    X, W = np.polynomial.legendre.leggauss(60)
    t = np.pi / 4 * (1 + X)
    unit = [
        spherical_jn(order, order + 1.0)
        / (2 * np.pi * b**2 * np.pi / 4)
        / np.sum(W * lpmv(own, order, np.cos(t)) * jv(own, (order + 1.0) * np.sin(t)) * np.sin(t))
        for order, own in zip(degree.tolist(), m.tolist(), strict=True)
    ]
    found = 0.0
    for middle, own in zip(discs.places, sizes, strict=True):
        away = place - middle
        distance, angle = float(np.hypot(*away)), float(np.arctan2(away[1], away[0]))
        at, x, weight = rule(distance, b)
        theta = np.arctan2(at[:, 1], at[:, 0]) + angle
        density = sum(
            size * one * lpmv(order, of, x) * (np.sin(order * theta) if is_sine else np.cos(order * theta))
            for size, one, of, order, is_sine in zip(own, unit, degree, m, sine, strict=True)
        )
        to = np.hypot(at[:, 0] - distance, at[:, 1])
        partial = np.cumsum((-1.0) ** IMAGES / np.hypot(to, 2.0 * IMAGES), 0)
        images = 1 / to + 2 * (partial[-3:].T @ [0.25, 0.5, 0.25])  # means of the last sums of both sides
        found += float(np.sum(density * weight * images)) / (4 * np.pi * PERMITTIVITY)
    return found


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("size", "pitch"), [(1.0, 1.3), (0.3, 0.45)])
def test_discs_have_the_potentials_that_their_charges_make(size: float, pitch: float) -> None:
    discs = Discs(BETWEEN, 2, size, pitch, 1)
    for number, x, y in ((4, 0.1, 0.2), (4, -0.42, 0.05), (5, -0.42, 0.05), (8, -0.1, 0.3)):
        found = by_charges(discs, discs.places[number] + size * np.array([x, y]))
        assert found == pytest.approx(float(discs.voltages[number]), abs=1e-5)


def test_a_reading_is_the_potential_where_a_narrow_charge_is() -> None:
    discs, distance, width = Discs(BETWEEN, 2, 1.0, 1.5, 1), np.array([0.75]), 0.02
    node, share = np.polynomial.legendre.leggauss(16)
    k, weights = (np.arange(175)[:, None] * 2 + 1 + node).ravel(), np.tile(share, 175)
    smeared = weights * np.exp(-((k * width) ** 2) / 2)
    X, W = np.polynomial.hermite_e.hermegauss(3)
    exact = sum(
        a * b * by_charges(discs, np.array([-distance[0] + width * x, width * y])) / (2 * np.pi)
        for x, a in zip(X, W, strict=True)
        for y, b in zip(X, W, strict=True)
    )
    assert float(discs.wave(k, distance, slope=False)[0] @ smeared) == pytest.approx(exact, rel=1e-5)
    beside = discs.wave(k, distance[0] + np.array([-1e-4, 1e-4]), slope=False) @ smeared
    assert float(discs.wave(k, distance, slope=True)[0] @ smeared) == pytest.approx(np.diff(beside)[0] / 2e-4, rel=1e-6)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_capacitances_are_symmetric_and_positive_and_grow_towards_all_that_is_at_zero(number: int) -> None:
    discs = Discs(PIEZO, number, 0.8, 1.2, 1)
    C = discs.matrix
    assert np.min(np.linalg.eigvalsh(C)) > 0
    assert np.all(C[~np.eye(9, dtype=bool)] < 0)
    assert np.all(np.sum(C, 0) > 0)
    np.testing.assert_allclose(C, C[::-1, ::-1], rtol=1e-9)
    assert discs.capacitance < C[4, 4] / float(PIEZO.scale[2]) ** 2
    assert np.ptp(discs.voltages[[1, 3, 5, 7]]) < 1e-12  # alike along x and across it


def test_what_a_floating_disc_reads_is_its_charge_its_capacitance_and_its_voltage() -> None:
    step, pitch = 1e-6, 7e-4
    case = READ | {"patch_pitch": pitch, "floating_neighbours": 1}
    found = solver.solve(case)
    middle = float(found["patch_charge_per_force"])
    assert float(found["disc_voltage_per_force"] * found["disc_capacitance"]) == pytest.approx(-middle, rel=1e-12)
    near = solver.solve(case | {"patch_position": [pitch, pitch / 2 - step, pitch / 2 + step]})
    charges = near["patch_charge_per_force"].values
    assert float(found["crosstalk"]) == pytest.approx(charges[0] / middle, rel=1e-10)
    assert float(found["patch_charge_gradient"]) == pytest.approx((charges[1] - charges[2]) / step, rel=1e-4)
    alone = solver.solve(case | {"floating_neighbours": 0})
    assert 0 < abs(float(found["disc_capacitance"] / alone["disc_capacitance"]) - 1) < 1e-4  # behind a thin film
