"""Steady sliding on films: an isotropic layer in closed form, the half-plane's own speeds, inertia inside, refusals."""

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.halfplane.profile import Profile
from solver.line.contact import FilmContact
from solver.line.table import table
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from solver.stack.speed import critical_speed
from tests.solver.line.films import BTO, STEEL, cases, interior_fields

MIX = solver.find("BaTiO3-CoFe2O4 50:50")


def moving_layer(E: float, nu: float, rho: float, speed: float, k: Array) -> Array:
    """k u_y per sigma_yy on an isotropic layer of unit thickness on a rigid base, by Lame's potentials; (k,)."""
    G = E / (2 * (1 + nu))
    long_ = np.sqrt(2 * G * (1 - nu) / (1 - 2 * nu) / rho)
    a, b = np.sqrt(1 - (speed / long_) ** 2), np.sqrt(1 - speed**2 * rho / G)
    computed = []
    for q in k:
        # phi = A cosh qa(y+1) + B sinh, i psi = C cosh qb(y+1) + D sinh;  i u_x = -q phi - d(i psi)/dy
        rows = []
        for y in (0.0, 1.0):
            ca, sa, cb, sb = np.cosh(q * a * y), np.sinh(q * a * y), np.cosh(q * b * y), np.sinh(q * b * y)
            across = np.array([ca, sa, b * sb, b * cb])
            along = np.array([a * sa, a * ca, cb, sb])
            shear = G * q * np.array([2 * a * sa, 2 * a * ca, (1 + b * b) * cb, (1 + b * b) * sb])
            normal = G * q * np.array([(1 + b * b) * ca, (1 + b * b) * sa, 2 * b * sb, 2 * b * cb])
            rows.append((across, along, shear, normal))
        (bottom, under, _, _), (_, top, shear, normal) = rows
        terms = np.linalg.solve(np.array([bottom, under, shear, normal]), [0.0, 0.0, 0.0, 1.0])
        computed.append(q * top @ terms)
    return np.array(computed)


@pytest.mark.parametrize("speed", [300.0, 1500.0, 2800.0])
def test_isotropic_layer_on_a_rigid_base_is_that_of_lame_s_potentials(speed: float) -> None:
    k, E, nu, rho = np.array([0.2, 1.0, 3.0, 8.0]), 2e11, 0.3, 7850.0
    isotropic = solver.Material.isotropic(E, nu, name="steel")
    steel = solver.Material(**{**vars(isotropic), "rho": np.array(rho)})
    stack = Stack((Layer(steel, 1.0),), speed=speed)
    Y = stack.media[0].compliance + waves(stack, k)[0].difference
    np.testing.assert_allclose(Y[:, 1, 1] * stack.scale[1] ** 2, moving_layer(E, nu, rho, speed, k), rtol=1e-10)


@pytest.mark.parametrize("conducts", [(True, True), (True, False), (False, False)])
def test_critical_speed_of_a_film_on_its_own_material_is_the_half_plane_s(conducts: tuple[bool, bool]) -> None:
    stack = Stack((Layer(MIX, 1.0, "bonded", "bonded"),), MIX)
    assert critical_speed(stack, conducts) == pytest.approx(float(solver.limiting_speed(MIX, conducts)), rel=1e-7)


def test_forces_inside_are_those_of_the_inertia() -> None:
    """d sigma_xx/dx + d sigma_xy/dy = rho V^2 d(strain_xx)/dx in film and base; D_y stays free of it."""
    speed, step = 1800.0, 1e-3
    stack = Stack((Layer(BTO, 2e-4, "bonded"),), STEEL, speed)
    tabled = table(stack, 0.3, least=0.5, most=2.0, nodes=8)
    film = FilmContact(tabled, Profile.cylinder(np.array(0.05)), cases(1e5), np.zeros((1, 2)), np.array(1.0))
    offsets, stencil = np.linspace(-2 * step, 2 * step, 5), np.array([1, -8, 0, 8, -1]) / (12 * step)
    names = ("stress_xx", "stress_xy", "strain_xx", "electric_displacement_x", "electric_displacement_y")
    edge = 2e-4 / float(film.half_width[0])
    for depth, density in ((0.6 * edge, BTO.rho), (edge + 0.4, STEEL.rho)):
        v = interior_fields(film, 0.4 + offsets, -depth + offsets, names)[0]
        along, down = v[:, 2] @ stencil, v[:, :, 2] @ stencil
        inertia = float(density) * speed**2 * along[2]
        assert abs(inertia) > 1e-3 * abs(along[0])
        assert along[0] + down[1] == pytest.approx(inertia, rel=1e-5)
        assert along[3] == pytest.approx(-down[4], rel=1e-5)
