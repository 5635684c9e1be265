"""Multipliers of surfaces against a boundary value problem through the depth, planes and a closed form."""

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from solver.surface.contact import isotropic_half_space
from solver.surface.response import SurfaceBody, SurfaceLayer
from verification.cases import constants
from verification.oracles import sample_materials, surface

HALF_SPACE = np.array([np.inf])
CRYSTALS: dict[str, Array] = {
    "PZT-4": sample_materials.hexagonal(constants(solver.find("PZT-4"))),
    "LiNbO3": sample_materials.lithium_niobate(None),
    "36Y LiNbO3": sample_materials.lithium_niobate(36.0),
    "X quartz": sample_materials.quartz(),
}


def stiffness(name: str) -> Array:
    """Generalised stiffness without magnetic fields, (3, 4, 4, 3)."""
    return solver.find(name).stiffness_tensor()[:, :4, :4]


@pytest.mark.parametrize("name", CRYSTALS)
def test_multipliers_are_those_of_the_oracle(name: str) -> None:
    units = np.array([1.0, 1.0, 1.0, 1e10])
    scale = units[:, None] * units / 1e11
    angles, depths = np.array([0.0, 0.7, np.pi / 2]), np.array([1e-3, 0.3, 1.0, 4.0])
    film = SurfaceBody((SurfaceLayer(stiffness(name), 1.0),)).multiplier(depths, angles) / scale
    half_space = SurfaceBody((), stiffness(name)).multiplier(HALF_SPACE, angles)[0] / scale
    for computed, exact in (
        (half_space, surface.half_space(CRYSTALS[name], angles)),
        (film, surface.film(CRYSTALS[name], depths, angles)),
    ):
        np.testing.assert_allclose(computed, exact, rtol=0, atol=2e-8 * np.max(np.abs(exact)))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("LiNbO3", [13.0611, 13.3693 - 0.9122j]),
        # 216.597 + 98.110i and 226.715 of the theory, with permittivities of 730 and 635 times vacuum's
        ("tilt 30 deg PZT-4", [216.593 + 98.112j, 226.712]),
    ],
)
def test_charge_of_a_plane_punch_along_x_and_y(name: str, expected: list[complex]) -> None:
    Y = SurfaceBody((), stiffness(name)).multiplier(HALF_SPACE, np.array([0.0, np.pi / 2]))[0]
    np.testing.assert_allclose(-1e12 * Y[:, 3, 2] / Y[:, 3, 3], expected, atol=1e-3)


@pytest.mark.parametrize(("name", "charge"), [("LiNbO3", 5.30612), ("36Y LiNbO3", 23.30671), ("X quartz", 1.97141)])
def test_thin_film_has_the_charge_of_a_uniform_strain(name: str, charge: float) -> None:
    film = SurfaceBody((SurfaceLayer(stiffness(name), 1.0),))
    Y = film.multiplier(np.array([1e-3]), np.array([0.3]))[0, 0]
    assert abs(1e12 * (Y[3, 2] / Y[3, 3]).real) == pytest.approx(charge, abs=1e-4)


@pytest.mark.parametrize("names", [("PZT-4", "rigid"), ("BaTiO3", "silicon"), ("PZT-4", "copper", "silicon")])
def test_multiplier_of_a_stack_isotropic_about_its_normal_is_that_of_the_plane(names: tuple[str, ...]) -> None:
    *layers, base = names
    stack = Stack([Layer(name, 1e-4 / (n + 1)) for n, name in enumerate(layers)], base)
    k = np.geomspace(1e-3, 50, 12) / 1e-4
    top = waves(stack, k)[0]
    plane = (top.medium.compliance + top.difference) * stack.scale[:, None] * stack.scale
    body = SurfaceBody(
        [
            SurfaceLayer(stiffness(name), 1e-4 / (n + 1), 2 in stack.grounded[n], stack.conductors[n])
            for n, name in enumerate(layers)
        ],
        None if base == "rigid" else stiffness(base),
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


def test_only_bodies_isotropic_about_the_normal_count_as_such() -> None:
    assert [SurfaceBody((), stiffness(name)).isotropic for name in ("PZT-4", "tilt 1 deg PZT-4", "LiNbO3")] == [
        True, False, False,
    ]  # fmt: skip
