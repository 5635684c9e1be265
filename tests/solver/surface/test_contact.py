"""Contacts in space and multipliers of surfaces against closed forms, planes and a boundary value problem."""

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

import solver
from solver.arrays import Array
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from solver.surface.contact import SurfaceContact, isotropic_half_space, solve_contact
from solver.surface.response import SurfaceBody, SurfaceLayer
from solver.surface.shape import Cone, Disc, Ellipsoid, RoughSphere, sphere
from verification.cases import constants
from verification.oracles import sample_materials, surface


def half_space(material: str, cut: str = "") -> SurfaceBody:
    return SurfaceBody((), solver.find(material).stiffness_tensor(cut)[:, :4, :4])


PZT = half_space("PZT-4")


def modulus(body: SurfaceBody) -> float:
    """Effective modulus of contacts at zero potential [Pa]."""
    Y = body.multiplier(np.array([np.inf]), np.array([0.0]))[0, 0].real
    return float(2 / (Y[2, 2] - Y[2, 3] ** 2 / Y[3, 3]))


def per_force(contact: SurfaceContact) -> float:
    """Charge per force [pC/N]."""
    return 1e12 * contact.charge / float(contact.force[2])


@pytest.mark.parametrize("punch", [None, (70e9, 0.33)])
def test_sphere_on_a_half_space_is_hertz(punch: tuple[float, float] | None) -> None:
    """The compliance of an elastic punch adds to that of the surface."""
    depth = 1e-6
    contact = solve_contact(PZT, sphere(5e-3), depth=depth, punch=punch, air=None, cells=64)
    stiff = modulus(PZT) if punch is None else 1 / (1 / modulus(PZT) + (1 - punch[1] ** 2) / punch[0])
    assert contact.force[2] == pytest.approx(4 / 3 * stiff * np.sqrt(5e-3) * depth**1.5, rel=2e-4)
    assert per_force(contact) == pytest.approx(250.10013, rel=1e-7)  # whatever the grid
    assert contact.area == pytest.approx(np.pi * 5e-3 * depth, rel=2e-3)
    np.testing.assert_allclose(contact.lengths, 2 * np.sqrt(5e-3 * depth), rtol=5e-3)


def test_ellipsoid_is_hertz() -> None:
    """Load and peak of an elliptic contact of semi-axes 10 to 1."""
    a, ratio, peak, Es = 1e-4, 10, 1e8, modulus(PZT)
    b, e2 = a / ratio, 1 - 1 / ratio**2
    K, E = ellipk(e2), ellipe(e2)
    factor = peak / Es * b / (a**2 * e2)
    radii = 1 / (2 * factor * (K - E)), 1 / (2 * factor * (ratio**2 * E - K))
    contact = solve_contact(PZT, Ellipsoid(*radii), depth=peak / Es * b * K, air=None, cells=128)
    assert contact.force[2] == pytest.approx(2 / 3 * np.pi * a * b * peak, rel=2e-4)
    assert contact.peak_pressure == pytest.approx(peak, rel=5e-4)


def test_cone_and_disc_have_their_closed_forms() -> None:
    Es = modulus(PZT)
    cone = solve_contact(PZT, Cone(0.01), force=1.0, air=None, cells=64)
    assert cone.depth == pytest.approx(np.sqrt(np.pi * 0.01 / (2 * Es)), rel=1e-3)
    disc = solve_contact(PZT, Disc(1e-4), force=1.0, air=None, cells=128)
    assert disc.depth == pytest.approx(1 / (2 * Es * 1e-4), rel=1e-3)


@pytest.mark.parametrize(
    ("material", "cut", "charge"),
    [("LiNbO3", "", 13.213), ("LiNbO3", "36Y", 15.93), ("LiNbO3", "128Y", 13.60), ("PZT-4", "tilt 30 deg", 222.0)],
)
def test_charge_of_a_cut_is_its_stroke(material: str, cut: str, charge: float) -> None:
    contact = solve_contact(half_space(material, cut), sphere(1.0), depth=1e-4, cells=48)
    force, induced = contact.tangent
    stroke = -1e12 * force[1] / force[0]
    assert stroke == pytest.approx(charge, rel=4e-3)  # the reference's air ends at twice the contact
    assert per_force(contact) == pytest.approx(stroke, rel=4e-3)
    # a gap that closes at the edge takes charge, which linear reciprocity leaves out: up to 1 % where air is thin
    assert 1e12 * induced[0] / force[0] == pytest.approx(stroke, rel=1.2e-2)


def test_a_sliding_sphere_loses_load_and_charge_to_the_second_order() -> None:
    rest, slow, fast = (
        solve_contact(half_space("BaTiO3"), sphere(1.0), depth=1e-4, friction=eta, air=None, cells=64)
        for eta in (0.0, 0.3, 0.6)
    )
    # windows differ by 2 %, which changes forces by some 3e-5; grids of 128 and 192 cells give -7.70e-4 and -3.04e-3
    assert slow.force[2] / rest.force[2] - 1 == pytest.approx(-7.62e-4, abs=8e-5)
    assert fast.force[2] / rest.force[2] - 1 == pytest.approx(-2.99e-3, abs=8e-5)
    assert slow.charge / rest.charge - 1 == pytest.approx(-1.38e-3, rel=0.1)  # like its edge cells


def test_charge_varies_smoothly_with_the_load_and_turns_with_the_crystal() -> None:
    film = SurfaceBody((SurfaceLayer(half_space("PZT-4").stiffnesses[0], 1e-4),))
    forces = 4.0 * 1.03 ** np.arange(5)
    charges = np.log([per_force(solve_contact(film, sphere(5e-3), force=f, cells=64, end=5e-3)) for f in forces])
    assert np.ptp(np.diff(charges)) < 4e-4  # between neighbours that differ by 1e-3
    along, across = (
        solve_contact(half_space("PZT-4", cut), sphere(5e-3), force=4.0, cells=32)
        for cut in ("tilt 30 deg", "euler -90 30 180")
    )
    assert across.charge == pytest.approx(along.charge, rel=1e-6)


def test_rough_spheres_have_their_roughness_on_every_grid_and_another_surface_each() -> None:
    deviations, lowest = [], []
    for number in range(8):
        rough = RoughSphere(20e-3, 10e-9, 1e-4, 1e-5, number)
        for cells in (200, 311):
            x = np.linspace(-1e-3, 1e-3, cells)
            deviations.append(np.std(rough.gap(x[:, None], x) - sphere(20e-3).gap(x[:, None], x)))
        lowest.append(rough.gap(np.zeros(1), np.zeros(1))[0] / 10e-9)
    # an area of 20 longest wavelengths a side holds some 400 hills, whose mean square scatters by 2/sqrt(400)
    np.testing.assert_allclose(deviations, 10e-9, rtol=0.1)
    assert np.std(lowest) > 0.3


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
