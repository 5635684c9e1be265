"""The collocation oracle against the 50-digit one, against the equations that it solves and in its convergence."""

import numpy as np
import pytest

from verification.oracles import collocation, profile
from verification.oracles.sample_materials import SIH_SONG
from verification.oracles.surface_response import Array, SurfaceResponse, reduced, surface_response
from verification.oracles.weighted_chebyshev import end_proof_nodes

CONDUCTED = [(1, 2), (1,), (2,), ()]


def problem(
    shape: profile.Profile, friction: float, conducted: tuple[int, ...] = (1, 2), speed: float = 0.0
) -> tuple[collocation.Problem, SurfaceResponse]:
    surface = surface_response(SIH_SONG, speed)
    case = collocation.Problem(
        N=surface.normal_compliance,
        k=surface.shear_coupling,
        profile=shape,
        friction=friction,
        load=1e5,
        charge=1e-6 if 1 in conducted else 0.0,
        magnetic_charge=-2e-3 if 2 in conducted else 0.0,
        conducted=conducted,
    )
    return case, surface


SHAPES = {
    "cylinder": profile.cylinder(0.05),
    "circle": profile.circle(0.05),
    "flat": profile.flat(4e-4),
    "tilted": profile.flat(4e-4, 1e-4),
    "wedge": profile.wedge(2e-3),
    "wedge, trailing": profile.wedge(2e-3, "trailing"),
    "half_cylinder": profile.half_cylinder(0.05),
    "half_cylinder, trailing": profile.half_cylinder(0.05, "trailing"),
}


@pytest.mark.sampled(10)
@pytest.mark.parametrize("conducted", CONDUCTED)
@pytest.mark.parametrize("name", SHAPES)
def test_collocation_satisfies_the_equations_off_its_points(name: str, conducted: tuple[int, ...]) -> None:
    case, _ = problem(SHAPES[name], 0.8, conducted)
    contact = collocation.solve(case)
    np.testing.assert_allclose(contact.totals, [-1e5, -case.charge, -case.magnetic_charge], rtol=1e-12)
    X = np.array([-0.83, -0.2, 0.11, 0.67])
    t, right, left, weight = contact.tractions(X), *end_proof_nodes()
    samples = contact._tractions(right, left)
    quotient = (samples[:, None, :] - t[:, :, None]) / ((left - right) / 2 - X[:, None])
    transform = (quotient @ weight + t * np.log((1 - X) / (1 + X))) / np.pi
    answer = case.friction * case.k[:, None] * t[0] + case.N @ transform
    answer[0] -= case.profile.slope((contact.trailing - contact.leading) / 2 + contact.half_width * X)
    size = np.abs(case.N) @ np.abs(transform)
    rows = [0, *conducted]
    assert np.max(np.abs(answer / size)[rows]) < 1e-11


@pytest.mark.parametrize("friction", [0.0, 0.8])
def test_profiles_with_corners_have_the_pressures_of_section_4(friction: float) -> None:
    X = np.array([-0.999, -0.3, 0.4, 0.999])
    for name, pressure in {"flat": flat, "wedge": wedge, "half_cylinder": half_cylinder}.items():
        case, surface = problem(SHAPES[name], friction)
        contact = collocation.solve(case)
        lam, alpha = reduced(surface, friction)
        x = (contact.trailing - contact.leading) / 2 + contact.half_width * X
        expected, load = pressure(x, contact.trailing, lam, alpha)
        assert load == pytest.approx(1e5, rel=1e-12)
        np.testing.assert_allclose(-contact.tractions(X)[0], expected, rtol=1e-11, err_msg=name)


def flat(x: Array, a: float, _: float, alpha: float) -> tuple[Array, float]:
    """Sadowsky's pressure where alpha = 1/2."""
    return 1e5 * np.sin(np.pi * alpha) / np.pi * (a - x) ** (alpha - 1) * (x + a) ** -alpha, 1e5


def wedge(x: Array, a: float, lam: float, alpha: float) -> tuple[Array, float]:
    """Slope m, corner at x = 0: Qn = -sin(pi alpha) m/lam, load pi alpha m a/lam."""
    return np.sin(np.pi * alpha) / lam * 2e-3 * (a - x) ** alpha * x**-alpha, np.pi * alpha * 2e-3 * a / lam


def half_cylinder(x: Array, a: float, lam: float, alpha: float) -> tuple[Array, float]:
    """Corner at x = 0: Qn = -sin(pi alpha)/(lam R) (x + alpha a), load pi alpha (1 + alpha) a^2/(2 lam R)."""
    pressure = np.sin(np.pi * alpha) / (lam * 0.05) * (x + alpha * a) * (a - x) ** alpha * x**-alpha
    return pressure, np.pi * alpha * (1 + alpha) * a**2 / (2 * lam * 0.05)
