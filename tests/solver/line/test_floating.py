"""Strips that float: capacitances against closed forms and charges on the strips, and what they do to a reading."""

from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

import solver
from solver.arrays import Array
from solver.stack.electrodes import Electrode
from solver.stack.floating import Strips, stiffness
from solver.stack.layers import Layer, Stack
from solver.stack.wavenumbers import wavenumbers
from tests.solver.line.films import BTO, FIBROUS, SILICON, by_exponentials

GLASS, PDMS, PVDF, COPPER = (solver.find(name) for name in ("glass", "PDMS", "PVDF", "copper"))
BETWEEN = Stack(
    [Layer(GLASS, 1.0, "grounded"), Layer(GLASS, 1.0)], electroded=True
)  # of one dielectric, grounded planes
PIEZO = Stack([Layer(GLASS, 1.0, "grounded"), Layer(BTO, 0.7, "grounded"), Layer(FIBROUS, 1.5)], SILICON)
PERMITTIVITY = float(GLASS.eps33)


@pytest.mark.parametrize(("size", "gap"), [(1.0, 0.1), (1.0, 0.01), (0.3, 0.5), (2.0, 3.0)])
def test_one_strip_between_grounded_planes_has_the_capacitance_of_conformal_mapping(size: float, gap: float) -> None:
    """4 eps K(k)/K(k'), k = tanh(pi w/4h) / tanh(pi (w + 2g)/4h): that of a coplanar line with a backing, twice."""
    modulus = np.tanh(np.pi * size / 4) / np.tanh(np.pi * (size + 2 * gap) / 4)
    exact = 4 * PERMITTIVITY * ellipk(modulus**2) / ellipk(1 - modulus**2)
    assert Strips(BETWEEN, 2, size, size + gap, 0).capacitance == pytest.approx(exact, rel=1e-12)


def by_charges(size: float, pitch: float, outer: float = 12.0, nodes: int = 40) -> tuple[Array, Array, Array]:
    """Three strips and the grounded rest, by the charges on them instead of the potentials between.

    A line charge in the middle between grounded planes two apart has -log tanh(pi |x| / 4) / (2 pi eps).
    Collocation with Chebyshev densities on every conductor. Returns charges of the strips per voltage, (3, 3), places
    in a gap beside the middle strip, and the potentials there under one volt on each; (place, 3).
    """
    edge = 2 * pitch - size / 2
    ends = [(-outer, -edge), *((j * pitch - size / 2, j * pitch + size / 2) for j in (-1, 0, 1)), (edge, outer)]
    X = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes)
    x = np.array([(a + b) / 2 + (b - a) / 2 * X for a, b in ends])
    half = np.array([(b - a) / 2 for a, b in ends])
    orders = np.arange(nodes)
    T = np.cos(orders * np.arccos(X)[:, None])  # (node, order)
    logs = np.where(orders == 0, -np.log(2), -1 / np.maximum(orders, 1)) * T  # of log|X - S| with the density

    def smooth(distance: Array) -> Array:
        away = np.abs(distance)
        ratio = np.where(away > 1e-12, np.tanh(np.pi * away / 4) / np.where(away > 1e-12, away, 1.0), np.pi / 4)
        return np.asarray(np.log(ratio))

    blocks = [
        [
            logs + np.log(half[c]) * (orders == 0) + smooth(x[r][:, None] - x[c]) @ T / nodes
            if r == c
            else np.log(np.tanh(np.pi * np.abs(x[r][:, None] - x[c]) / 4)) @ T / nodes
            for c in range(5)
        ]
        for r in range(5)
    ]
    volts = np.repeat(np.eye(5)[:, 1:4], nodes, axis=0)
    found = np.linalg.solve(-np.block(blocks) / (2 * np.pi * PERMITTIVITY), volts).reshape(5, nodes, 3)
    places = (pitch / 2) + (pitch - size) / 2 * np.array([-0.8, -0.1, 0.5])
    at = sum(np.log(np.tanh(np.pi * np.abs(places[:, None] - x[c]) / 4)) @ T / nodes @ found[c] for c in range(5))
    return np.asarray(found[1:4, 0]), np.asarray(places), np.asarray(-at / (2 * np.pi * PERMITTIVITY))


@pytest.mark.parametrize(("size", "pitch"), [(1.0, 1.5), (0.4, 0.7)])
def test_three_strips_are_those_that_charges_on_them_give(size: float, pitch: float) -> None:
    charges, places, potentials = by_charges(size, pitch)
    row = Strips(BETWEEN, 2, size, pitch, 1)
    ours = row.matrix / float(BETWEEN.scale[2]) ** 2
    # what lies beyond 12 thicknesses is cut off there, and its edge is resolved by 40 terms
    np.testing.assert_allclose(ours, charges, atol=1e-6 * charges[1, 1])
    side = -charges[0, 1] / (charges[0, 0] + charges[0, 2])
    np.testing.assert_allclose(row.voltages, [side, 1.0, side], rtol=1e-5)
    # the potential in a gap, by its transform less that of straight ramps; beyond k = 600 it falls like k^-1.5
    gap, k = pitch - size, np.asarray((np.arange(20_000) + 0.5) * 0.03)
    volts = np.array([0.0, *row.voltages, 0.0])
    middles = pitch * (np.arange(4) - 1.5)
    ramps = sum(
        -(b - a) * np.sin(k * m) * np.sinc(k * gap / 2 / np.pi) / k
        for a, b, m in zip(volts[:-1], volts[1:], middles, strict=True)
    )
    corners = (middles[:, None] + [-gap / 2, gap / 2]).ravel()
    straight = np.interp(places, corners, np.repeat(volts, 2)[1:-1])
    inverse = np.cos(places[:, None] * k) @ (row.wave(k) - ramps) * 0.03 / np.pi
    np.testing.assert_allclose(inverse + straight, potentials @ row.voltages, atol=3e-4)


def test_an_electrode_s_charge_per_potential_by_exponentials_of_the_layers() -> None:
    """Over an active base, between a bare surface and others that are grounded."""
    k = np.array([0.3, 1.0, 3.0])
    for number in (1, 2, 3):
        ours, limit = stiffness(PIEZO, number, k)
        for wave, value in zip(k.tolist(), ours, strict=True):
            columns, phi = by_exponentials(PIEZO, wave)
            charges = np.linalg.solve(np.concatenate([columns[4:], phi]), np.eye(7)[4 + 3 - number])[4:]
            assert value == pytest.approx(charges[3 - number], rel=1e-9)
        assert stiffness(PIEZO, number, np.array([60.0]))[0][0] == pytest.approx(limit, rel=1e-12)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_capacitances_are_symmetric_and_positive_and_grow_towards_all_that_is_at_zero(number: int) -> None:
    row = Strips(PIEZO, number, 0.8, 1.0, 3)
    C = row.matrix
    np.testing.assert_array_equal(C, C.T)
    assert np.min(np.linalg.eigvalsh(C)) > 0
    assert np.all(C[~np.eye(7, dtype=bool)] < 0)
    assert np.all(np.sum(C, 0) > 0)  # a volt on all leaves charge on each
    np.testing.assert_allclose(C, C[::-1, ::-1], rtol=1e-9)
    # the neighbours at zero volts hold more of its charge than those that float
    assert row.capacitance < C[3, 3] / float(PIEZO.scale[2]) ** 2
    np.testing.assert_array_less(row.voltages[:3], row.voltages[1:4])


def test_strips_that_all_float_side_by_side_are_as_no_electrode() -> None:
    """The middle one takes the potential that tractions make where nothing is grounded, in the limit of fine ones."""
    electrode, errors = Electrode(PIEZO, 1), list[float]()
    k, weights = wavenumbers(PIEZO, 12.0, electrode.width)
    charge = electrode.rows(k)[:, 0, 1] * -np.exp(-(k**2) / 4)  # a bell of pressure, half as wide as the layer is thick
    bare = -np.sum(weights * charge / (k * stiffness(PIEZO, 1, k)[0])) / np.pi
    for pitch, share, floating in ((0.5, 0.5, 8), (0.25, 0.5, 16), (0.25, 0.2, 16)):
        row = Strips(PIEZO, 1, share * pitch, pitch, floating)
        read = np.sum(weights * charge * row.wave(k)) / np.pi
        errors.append(-read / (row.capacitance * float(PIEZO.scale[2]) ** 2) / bare - 1)
    assert abs(errors[0]) < 0.03
    assert abs(errors[1]) < 0.6 * abs(errors[0])  # metal that carries the field along itself, over half the pitch
    assert abs(errors[2]) < 2e-3


COVERED = Stack([Layer(PDMS, 1e-3, "grounded"), Layer(PVDF, 5e-5)])
FINGER: dict[str, Any] = {"radius": 0.01, "punch": "skin", "load": 20.0, "datum": 0.1, "electric": "insulating"}
READ: dict[str, Any] = FINGER | {"magnetic": "insulating", "body": COVERED, "collector": 2, "patch_size": 5e-4}


def charge(factors: dict[str, Any], name: str = "patch_charge_per_force") -> Array:
    return np.asarray(solver.solve(factors)[name].values)


def test_narrow_gaps_without_floating_strips_are_patches_of_a_full_electrode() -> None:
    ideal = charge(READ)
    gaps = [5e-6, 5e-7]
    found = [float(charge(READ | {"patch_pitch": 5e-4 + gap, "floating_neighbours": 0})) for gap in gaps]
    errors = np.abs(np.array(found) / ideal - 1)
    assert errors[1] < 2e-3  # by half the charge above the gaps
    assert errors[1] / errors[0] == pytest.approx(gaps[1] / gaps[0], rel=0.2)


def test_what_a_floating_strip_reads_is_its_charge_its_capacitance_and_its_voltage() -> None:
    step, pitch = 1e-6, 6e-4
    case = READ | {"patch_pitch": pitch, "floating_neighbours": 2}
    found = solver.solve(case)
    middle = float(found["patch_charge_per_force"])
    assert float(found["patch_voltage_per_load"] * found["patch_capacitance"]) == pytest.approx(-middle, rel=1e-12)
    # plates: the strip over the film, and a little for its edges
    plates = Electrode(COVERED, 2).capacitance
    assert 1.0 < float(found["patch_capacitance"]) / 5e-4 / plates < 1.2
    near = charge(case | {"patch_position": [pitch, pitch / 2 - step, pitch / 2 + step]})
    assert float(found["crosstalk"]) == pytest.approx(near[0] / middle, rel=1e-10)
    assert float(found["patch_charge_gradient"]) == pytest.approx((near[1] - near[2]) / step, rel=1e-4)
    many = charge(case | {"floating_neighbours": [0, 1, 2, 6]})
    assert abs(many[3] / many[2] - 1) < abs(many[1] / many[0] - 1)
