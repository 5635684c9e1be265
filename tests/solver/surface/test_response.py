"""Multipliers of surfaces against those of planes, closed forms and thin limits."""

import numpy as np
import pytest

from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from solver.surface.contact import isotropic_half_space
from solver.surface.kernel import NORMAL_PAIRS, kernel
from solver.surface.response import SurfaceBody, SurfaceLayer
from tests.solver.surface.crystals import film, hexagonal, lithium_niobate, tensor, tilted, y_cut

HALF_SPACE = np.array([np.inf])
ALONG = np.array([0.0, np.pi / 2])


def charge(Y: np.ndarray) -> np.ndarray:
    """Charge per force at zero potential [pC/N]."""
    return np.asarray(-1e12 * Y[..., 3, 2] / Y[..., 3, 3])


@pytest.mark.parametrize(
    ("stiffness", "expected"),
    [
        (lithium_niobate(), [13.0611, 13.3693 - 0.9122j]),
        # 216.597 + 98.110i and 226.715 of the theory, with permittivities of 730 and 635 times vacuum's
        (hexagonal("PZT-4", tilted(-30)), [216.593 + 98.112j, 226.712]),
    ],
)
def test_charge_of_a_plane_punch_along_x_and_y(stiffness: np.ndarray, expected: list[complex]) -> None:
    body = SurfaceBody((), stiffness)
    Y = body.multiplier(HALF_SPACE, ALONG)[0]
    np.testing.assert_allclose(charge(Y), expected, atol=1e-3)
    plain = Y / (body.scale[:, None] * body.scale)
    np.testing.assert_allclose(plain, np.conj(plain.swapaxes(-1, -2)), atol=1e-12)


@pytest.mark.parametrize(("axes", "expected"), [(np.eye(3), 5.30612), (y_cut(36), 23.30671)])
def test_thin_film_has_the_charge_of_a_uniform_strain(axes: np.ndarray, expected: float) -> None:
    Y = film(lithium_niobate(axes), 1.0).multiplier(np.array([1e-3]), np.array([0.3]))[0]
    np.testing.assert_allclose(charge(Y).real, expected, atol=1e-5)


@pytest.mark.parametrize("names", [("PZT-4", "rigid"), ("BaTiO3", "silicon"), ("PZT-4", "copper", "silicon")])
def test_multiplier_of_a_stack_isotropic_about_its_normal_is_that_of_the_plane(names: tuple[str, ...]) -> None:
    *layers, base = names
    stack = Stack([Layer(name, 1e-4 / (n + 1)) for n, name in enumerate(layers)], base)
    k = np.geomspace(1e-3, 50, 12) / 1e-4
    top = waves(stack, k)[0]
    plane = (top.medium.compliance + top.difference) * stack.scale[:, None] * stack.scale
    body = SurfaceBody(
        [
            SurfaceLayer(hexagonal(name, None), 1e-4 / (n + 1), 2 in stack.grounded[n], stack.conductors[n])
            for n, name in enumerate(layers)
        ],
        None if base == "rigid" else hexagonal(base),
        stack.conductors[-1],
    )
    Y = body.multiplier(k, np.array([0.3]))[:, 0, 2:4, 2:4]
    assert np.all(np.abs(Y.imag) < 1e-7 * np.abs(Y))
    # coincident roots of isotropic layers are split by 1e-5
    np.testing.assert_allclose(Y.real, plane[:, 1:3, 1:3], rtol=1e-7)


def test_isotropic_half_space_has_the_closed_form() -> None:
    modulus, poisson = 210e9, 0.3
    Y = isotropic_half_space(modulus, poisson).multiplier(HALF_SPACE, np.array([0.0]))[0, 0]
    assert Y[2, 2].real == pytest.approx(2 * (1 - poisson**2) / modulus, rel=1e-7)
    assert Y[2, 0].imag == pytest.approx((1 - 2 * poisson) * (1 + poisson) / modulus, rel=1e-7)


def test_turning_the_crystal_turns_the_multiplier() -> None:
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    k = np.array([0.3, 1.0, 4.0])
    straight = film(lithium_niobate(y_cut(128)), 1.0).multiplier(k, np.array([0.2]))[..., 2:4, 2:4]
    turned = film(lithium_niobate(turn @ y_cut(128)), 1.0).multiplier(k, np.array([0.2 + angle]))[..., 2:4, 2:4]
    np.testing.assert_allclose(turned, straight, rtol=1e-9)


def test_only_bodies_isotropic_about_the_normal_count_as_such() -> None:
    assert SurfaceBody((), hexagonal("PZT-4")).isotropic
    assert not SurfaceBody((), hexagonal("PZT-4", tilted(1))).isotropic
    assert not SurfaceBody((), lithium_niobate()).isotropic
    cubic = np.diag([166e9] * 3 + [80e9] * 3) + np.pad(64e9 * (1 - np.eye(3)), (0, 3))
    assert not SurfaceBody((), tensor(cubic, np.zeros((3, 6)), 1e-10 * np.eye(3))).isotropic


def test_cells_on_a_film_on_steel_influence_each_other_alike_in_every_direction() -> None:
    """Roots of steel coincide and are perturbed: what that adds to other directions is rounding."""
    steel = isotropic_half_space(206e9, 0.3)
    body = SurfaceBody((SurfaceLayer(hexagonal("PZT-4"), 1e-4),), steel.base)
    table = kernel(body, None, NORMAL_PAIRS, (16, 16), 2e-5, 2e-5)
    for pair in NORMAL_PAIRS:
        spectrum = np.fft.rfft2(np.fft.irfft2(table.spectra[pair], table.padded).T)
        assert np.max(np.abs(spectrum - table.spectra[pair])) < 1e-14 * np.max(np.abs(spectrum))
