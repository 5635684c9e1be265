"""An elastic punch on a half-plane: Hertz and Dundurs, the integral equation by quadrature, and the rigid limit."""

import numpy as np
import pytest

import solver
from solver.halfplane.contact import Contact
from solver.halfplane.fields import surface_fields
from solver.halfplane.profile import Profile
from solver.halfplane.quantities import Response
from solver.halfplane.sliding import Punch, Sliding
from solver.halfplane.surface import HalfPlane
from solver.material.constants import Material
from tests.solver.quadrature import rule
from verification.oracles.surface_response import surface_response

FIBROUS = solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.5)
STEEL = Punch.isotropic(210e9, 0.3)
RADIUS = np.array(0.05)
PROFILES = {
    "cylinder": Profile.cylinder(np.array(0.05)),
    "wedge": Profile.wedge(np.array(0.004), "trailing"),
    "half cylinder": Profile.half_cylinder(np.array(0.05)),
    "cubic": Profile.polynomial([1e-4, 15.0, 1e4, 2e7]),
}


def contact(
    material: Material, friction: float, punch: Punch, profile: Profile | None = None, load: float = 1e5
) -> Contact:
    sliding = Sliding(HalfPlane(material), np.array(friction), np.array([True, True]), punch)
    return Contact(sliding, profile or Profile.cylinder(RADIUS), np.array(load), np.array([2e-6, -3e-3]))


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.9])
def test_isotropic_bodies_are_those_of_the_textbooks(friction: float) -> None:
    """Johnson, Contact Mechanics: cot(pi alpha) = eta beta of Dundurs; Hertz's half-length without friction."""
    (E1, nu1), (E2, nu2) = (70e9, 0.22), (200e9, 0.3)
    computed = contact(Material.isotropic(E1, nu1), friction, Punch.isotropic(E2, nu2))
    G1, G2 = E1 / (2 * (1 + nu1)), E2 / (2 * (1 + nu2))
    beta = ((1 - 2 * nu1) / G1 - (1 - 2 * nu2) / G2) / (2 * (1 - nu1) / G1 + 2 * (1 - nu2) / G2)
    alpha = 0.5 - np.arctan(friction * beta) / np.pi
    assert float(computed.exponent) == pytest.approx(alpha, rel=1e-13)
    star = 1 / ((1 - nu1**2) / E1 + (1 - nu2**2) / E2)
    whole = np.sqrt(4 * RADIUS * 1e5 / (star * alpha * (1 - alpha) * np.pi))
    assert 2 * float(computed.half_width) == pytest.approx(float(whole), rel=1e-13)


@pytest.mark.parametrize("name", PROFILES)
def test_both_surfaces_fit_by_quadrature(name: str) -> None:
    """Slopes of body and punch, each from the Stroh eigenvectors of its own material, differ by that of the profile."""
    profile = PROFILES[name]
    computed = contact(FIBROUS, 0.3, STEEL, profile)
    R, X = rule(), np.array([-0.93, -0.41, 0.07, 0.55, 0.9])
    fields = surface_fields(computed, np.concatenate([R.X, X]))
    root = np.concatenate([R.root, np.sqrt(1 - X**2)])
    t = np.array([-fields.contact_pressure * root, fields.electric_displacement_y.regular,
                  fields.magnetic_induction_y.regular]).reshape(3, -1)  # fmt: skip
    regular, within = t[:, : R.X.size], t[:, R.X.size :] / np.sqrt(1 - X**2)
    quotient = (regular[:, None] - within[:, :, None] * R.root) / (R.X - X[:, None])
    H = (quotient @ R.weight + within * np.log((1 - X) / (1 + X))) / np.pi
    body = surface_response({k: v for k, v in FIBROUS.plain().items() if isinstance(v, float)})
    above = surface_response({k: v for k, v in Material.isotropic(210e9, 0.3).plain().items() if isinstance(v, float)})
    slope = 0.3 * body.shear_coupling[0] * within[0] + body.normal_compliance[0] @ H
    slope += -0.3 * above.shear_coupling[0] * within[0] + above.normal_compliance[0, 0] * H[0]  # turned upside down
    h, c = float(np.ravel(computed.half_width)[0]), float(np.ravel(computed.pressing.centre)[0])
    x = h * (X + c)
    required = sum(float(np.ravel(g)[0]) * x**k for k, g in enumerate(profile.slope))
    lost = 1e-11 if all(profile.smooth) else 1e-6  # of the rule, where a corner leaves the pressure unbounded
    np.testing.assert_allclose(slope, required, rtol=0, atol=lost * np.max(np.abs(required)))


def test_datum_of_the_punch_moves_the_depth_by_a_logarithm() -> None:
    case = contact(FIBROUS, 0.3, STEEL)
    first, two = (float(Response(case, np.array(0.2), np.array(L)).depth) for L in (0.05, 0.5))
    assert two - first == pytest.approx(float(STEEL.compliance) * 1e5 / np.pi * np.log(10), rel=1e-10)
