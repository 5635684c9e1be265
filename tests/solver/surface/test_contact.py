"""Contacts in space against closed forms and one another."""

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

import solver
from solver.surface.contact import SurfaceContact, solve_contact
from solver.surface.response import SurfaceBody
from solver.surface.shape import Cone, Disc, Ellipsoid, RoughSphere, sphere


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
