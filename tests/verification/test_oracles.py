"""The oracles: 50 digits against the equations; nested punches against closed forms and the point solver."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mpmath import log, matrix, mp, mpf, pi
from scipy.special import ellipe, ellipk

import solver
from tests.solver.cases import BTO, PZT
from verification.cases import constants
from verification.oracles.contact import Contact, Sliding
from verification.oracles.half_plane import WORK_DIGITS, HalfPlane, half_plane
from verification.oracles.quadrature import integral
from verification.oracles.sample_materials import SIH_SONG, hexagonal, lithium_niobate
from verification.oracles.surface import Press, body, film, half_space, tensor

CERAMIC, TITANATE = (hexagonal(constants(material)) for material in (PZT, BTO))


def principal_value(f: Callable[[mpf, mpf], mpf], u: mpf) -> mpf:
    """(1/pi) PV int f(s)/(s-x) ds with the singularity taken out; u = (a - x)/l."""
    value = f(u, 1 - u)
    return (integral(lambda s, t: (f(s, t) - value) / (u - s)) + value * log(u / (1 - u))) / pi


def without_kap(half: HalfPlane) -> HalfPlane:
    """The half-plane with k1 = n.d, where D_y and B_y of theory section 3 have the form 0/0."""
    local = half.local.copy()
    local[1, 0] -= Sliding(half, mpf(0), mpf("0.05"), (1, 2)).reduction[3]
    return replace(half, local=local)


@pytest.mark.parametrize(("conducted", "friction", "digits"), [((1, 2), 1.5, 60), ((1,), 0.0, 60), ((1, 2), 0.7, 38)])
def test_tractions_satisfy_the_integral_equations_and_the_balances(
    conducted: tuple[int, ...], friction: float, digits: int
) -> None:
    """The last of a half-plane with a removable singularity."""
    with mp.workdps(WORK_DIGITS):
        half, tolerance = half_plane(SIH_SONG), mpf(10) ** -digits
        surface = Sliding(half if digits > 50 else without_kap(half), mpf(friction), mpf("0.05"), conducted)
        charges = [mpf(c) if i in surface.conducted else mpf(0) for i, c in ((1, "1e-6"), (2, "-2e-3"))]
        contact = Contact(surface, mpf(10) ** 5, *charges)
        N, k = surface.half.normal_compliance, surface.half.shear_coupling
        parts = [lambda s, t, i=i: contact.tractions(s, t)[i] for i in (1, 2, 3)]
        totals = [
            contact.width * integral(part) if i in (0, *surface.conducted) else mpf(0) for i, part in enumerate(parts)
        ]
        for total, applied in zip(totals, (contact.load, *charges), strict=True):
            assert abs(total + applied) <= tolerance * abs(applied)
        u, held = mpf("0.31"), (0, *surface.conducted)
        tractions, closed = contact.tractions(u, 1 - u)[1:], contact.transforms_inside(u, 1 - u)[1:]
        numeric = matrix([principal_value(p, u) if i in held else mpf(0) for i, p in enumerate(parts)])
        assert all(abs(c - n) <= tolerance * abs(n) for c, n in zip(closed, numeric, strict=True))
        answer = surface.friction * tractions[0] * matrix(k) + N * numeric
        x = contact.width * (1 - surface.alpha - u)
        for i in held:
            size = max(abs(N[i, j] * numeric[j]) for j in range(3)) + abs(x / surface.radius)
            assert abs(answer[i] - (x / surface.radius if i == 0 else 0)) < tolerance * size


def test_a_sphere_on_an_isotropic_body_is_hertz_s() -> None:
    """Stroh's triple root is nothing to integrals over the angle."""
    shear, lame = 80e9, 120e9
    stiffness = np.diag([2.0, 2, 2, 1, 1, 1]) * shear
    stiffness[:3, :3] += lame
    whole = tensor(stiffness, np.zeros((3, 6)), 1e-10 * np.eye(3))
    state = Press(body(whole), (200.0, 200.0), 10.0, harmonics=2).contact()
    modulus = 4 * shear * (lame + shear) / (lame + 2 * shear)  # E/(1 - nu^2)
    radius = (3 * 10.0 * 5e-3 / (4 * modulus)) ** (1 / 3)
    assert state.semi_axes == pytest.approx([radius, radius], rel=1e-7)
    assert state.depth == pytest.approx(radius**2 / 5e-3, rel=1e-9)
    assert state.central_pressure == pytest.approx(3 * 10.0 / (2 * np.pi * radius**2), rel=1e-7)


@pytest.mark.parametrize("ratio", [2.0, 3.0])
def test_an_ellipse_is_hertz_s_with_one_charge_per_force(ratio: float) -> None:
    whole, force, long = CERAMIC, 10.0, 1e-4
    closed = np.linalg.inv(half_space(whole, 0.0)[0].real[2:, 2:])
    modulus, m, short = 2e11 * closed[0, 0], 1 - 1 / ratio**2, long / ratio
    peak = 3 * force / (2 * np.pi * long * short)
    factor = 2 * peak * short / (modulus * m * long**2)
    curvatures = factor * (ellipk(m) - ellipe(m)), factor * (ratio**2 * ellipe(m) - ellipk(m))
    state = Press(body(whole), curvatures, force, harmonics=3).contact()
    assert state.semi_axes == pytest.approx([long, short], rel=1e-6)  # the series of the ellipse ends at 1e-7
    assert state.depth == pytest.approx(peak * short * ellipk(m) / modulus, rel=1e-7)
    assert state.charge / force == pytest.approx(closed[1, 0] / closed[0, 0] * 1e-10, rel=1e-6)


def test_a_film_on_its_material_is_a_half_space() -> None:
    """The electrode between is not seen by heights where nothing is piezoelectric."""
    whole = lithium_niobate(36.0)
    whole[:, :3, 3] = whole[:, 3, :3] = 0.0
    expected = half_space(whole, 0.4)[0]
    np.testing.assert_allclose(film(whole, 0.7, 0.4, whole)[0, 0][:3, :3], expected[:3, :3], atol=1e-10)


@pytest.mark.parametrize("reach", [1.0, 8.0])
def test_a_ball_on_a_film_is_the_point_solver_s(reach: float) -> None:
    """In air the charge beyond the reach is missing: 2e-5 of all of it at 8 radii."""
    state = Press(body(CERAMIC, thickness=1e-4), (200.0, 200.0), 4.0, reach, end=5e-3, harmonics=2).contact()
    ball = {"material": "PZT-4", "thickness": 1e-4, "base": "rigid", "profile": "sphere", "radius": 5e-3, "force": 4.0}
    expected = solver.solve(ball | {"surroundings": "insulated" if reach == 1 else "air", "total_charge": state.charge})
    assert state.charge / 4.0 == pytest.approx(float(expected["charge_per_force"]), rel=5e-5)
    assert state.semi_axes == pytest.approx(np.full(2, float(expected["contact_radius"])), rel=3e-6)
    assert state.misfit < 1e-6


def test_a_sliding_ball_presses_less_with_the_square_of_friction() -> None:
    """docs/limits.md: at one depth -7.5e-4 of force and -1.6e-3 of charge at 0.3; both go as the depth's power 3/2."""
    still, slow, fast = (
        Press(body(TITANATE, friction), (200.0, 200.0), 10.0).contact() for friction in (0.0, 0.3, 0.6)
    )
    deeper = [(still.depth / state.depth) ** 1.5 for state in (slow, fast)]
    force = [ratio - 1 for ratio in deeper]
    charge = [ratio * state.charge / still.charge - 1 for ratio, state in zip(deeper, (slow, fast), strict=True)]
    assert force[0] == pytest.approx(-7.5e-4, rel=0.02)
    assert charge[0] == pytest.approx(-1.606e-3, rel=0.01)
    for neglected in (force, charge):
        assert neglected[1] / neglected[0] == pytest.approx(4, rel=0.1)
    assert slow.centre[0] < 0
    assert fast.centre[0] / slow.centre[0] == pytest.approx(2, rel=0.01)


#: The solver's grids agree within 1e-3; the largest error measured is 1.1e-3, of a charge at a friction of 0.6.
GRID = 2e-3


BALL = {"profile": "sphere", "radius": 5e-3}
ROUND = {"profile": "ellipsoid", "radius_x": 5e-3, "radius_y": 5e-3, "surroundings": "insulated"}
FILM = {"material": "PZT-4", "thickness": 1e-4, "base": "rigid"}
CUT = {"material": "LiNbO3", "cut": "rotated Y", "cut_angle": np.radians(36)}
#: An ellipsoid on a film, a ball that slides, solved to every order of friction, and one on a cut in air.
IN_SPACE: dict[str, tuple[Callable[[], Press], dict[str, Any]]] = {
    "ellipsoid": (lambda: Press(body(CERAMIC, thickness=1e-4), (200.0, 50.0), 4.0, harmonics=3),
                  ROUND | FILM | {"radius_y": 20e-3}),
    "sliding": (lambda: Press(body(TITANATE, 0.6), (200.0, 200.0), 10.0),
                ROUND | {"material": "BaTiO3", "friction": 0.6}),
    "cut": (lambda: Press(body(lithium_niobate(36.0)), (200.0, 200.0), 10.0, reach=60.0, end=5e-3, harmonics=2),
            BALL | CUT | {"surroundings": "air"}),
}  # fmt: skip


@pytest.mark.parametrize("name", IN_SPACE)
def test_contacts_in_space_are_the_solver_s(name: str) -> None:
    press, factors = IN_SPACE[name]
    state = press().contact()
    charged = factors | {"force": state.press.force, "total_charge": state.charge, "grid_error": 0.01}
    solved = solver.solve(charged, outputs=["charge_per_force", "depth", "contact_area"])
    assert float(solved["charge_per_force"]) == pytest.approx(state.charge / state.press.force, rel=GRID)
    assert float(solved["depth"]) == pytest.approx(state.depth, rel=GRID)
    area = np.pi * abs(np.linalg.det(state.axes))
    assert float(solved["contact_area"]) == pytest.approx(area, rel=2e-2)  # cells that the edge cuts
