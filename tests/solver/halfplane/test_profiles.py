"""Every profile against Gauss-Jacobi collocation, tangents against differences, and what is refused."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from numpy.typing import NDArray

import solver
from solver.halfplane.contact import Contact
from solver.halfplane.profile import Profile
from solver.halfplane.quantities import Response
from solver.halfplane.sliding import Punch, Sliding
from solver.halfplane.surface import HalfPlane
from solver.material.constants import ANY_SIZE, Material
from tests.solver.cases import FIBROUS
from tests.solver.strategies import constants, loads, property_based
from verification import cases
from verification.integral_equations import PUNCHES
from verification.oracles import collocation
from verification.oracles.collocation import fields, quantities
from verification.oracles.sample_materials import SIH_SONG as CONSTANTS
from verification.oracles.surface_response import reduced, surface_response

BASE: dict[str, Any] = {"material": cases.SIH_SONG, "load": 1e5, "datum": 0.2}
POSITIONS = np.array([-1.7, -1.001, -0.95, 0.2, 0.95, 1.001, 4.0])
CONDUCTED = [(1, 2), (1,), (2,), ()]
#: Punches of the verification, and those that it lacks, for the solver and for the collocation.
CASES: dict[str, tuple[dict[str, Any], collocation.Profile]] = {
    **{name: PUNCHES[name] for name in ("flat", "wedge", "half-cylinder, corner trailing")},
    "quartic": (
        {"profile": solver.Profile.polynomial((0.0, 0.0, 0.0, 5e8), (True, True))},
        collocation.Profile(lambda x: 5e8 * x**3),
    ),
    "one corner": (
        {"profile": solver.Profile.polynomial((2e-4, 10.0, 0.0, 1e9), (True, False))},
        collocation.Profile(lambda x: 2e-4 + 10.0 * x + 1e9 * x**3, sharp_leading=0.0),
    ),
    "two corners": (
        {"profile": solver.Profile.polynomial((1e-5, 0.2, 1e3), (False, False), 4e-4)},
        collocation.Profile(lambda x: 1e-5 + 0.2 * x + 1e3 * x**2, 2e-4, -2e-4),
    ),
}  # fmt: skip


@pytest.mark.sampled(10)
@pytest.mark.parametrize("conducted", CONDUCTED)
@pytest.mark.parametrize("friction", [0.0, 1e-12, 0.8])
@pytest.mark.parametrize("name", CASES)
def test_profile_agrees_with_collocation(name: str, friction: float, conducted: tuple[int, ...]) -> None:
    factors, shape = CASES[name]
    surface, charges = surface_response(CONSTANTS), (1e-6 * (1 in conducted), -2e-3 * (2 in conducted))
    N, k = surface.normal_compliance, surface.shear_coupling
    computed = collocation.solve(collocation.Problem(N, k, shape, friction, 1e5, *charges, conducted))
    kinds = {field: "conducting" if i in conducted else "insulating" for i, field in ((1, "electric"), (2, "magnetic"))}
    charged = dict(zip(("charge", "magnetic_charge"), charges, strict=True))
    solved = solver.solve(BASE | factors | kinds | charged | {"friction": friction}, POSITIONS)
    expected = quantities(computed, surface, 0.2)
    expected["pressure_exponent"] += shape.sharp_trailing is not None  # of the smooth edge, not of the corner
    if "peak_pressure" in solved:
        expected["peak_pressure"] = -np.min(computed.tractions(np.linspace(-0.9999, 0.9999, 400_001))[0])
    compared = set(expected) & set(solved.data_vars)
    assert {"contact_trailing", "contact_leading", "depth"} <= compared
    for quantity in compared:
        scale = computed.half_width if quantity.startswith("contact") else 0.0
        value = solved[quantity].item()
        tolerance = 1e-9 if quantity == "peak_pressure" else 1e-11  # a peak read from a fine grid
        assert value == pytest.approx(expected[quantity], rel=tolerance, abs=1e-12 * scale), quantity
    for field, values in fields(computed, surface, POSITIONS).items():
        scale = float(np.max(np.abs(values)))
        np.testing.assert_allclose(solved[field], values, rtol=1e-10, atol=1e-11 * scale, err_msg=field)


def test_a_flat_punch_may_tilt_until_the_pressure_leaves_an_edge() -> None:
    """Without friction that is at the slope lam P / (pi h)."""
    lam, _ = reduced(surface_response(CONSTANTS), 0.0)
    limit = lam * 1e5 / (np.pi * 2e-4)
    case = BASE | {"profile": "flat", "width": 4e-4, "friction": 0.0}
    edges = solver.solve(case | {"slope": limit * (1 - 1e-9)}, [-1 + 1e-6, 1 - 1e-6])["contact_pressure"].values
    assert 0 < edges[1] < 1e-5 * edges[0]
    with pytest.raises(solver.FactorError, match="tension"):
        solver.solve(case | {"slope": limit * (1 + 1e-9)})


Array = NDArray[np.float64]
STEEL = {"punch_modulus": 210e9, "punch_poisson": 0.3}
ELASTIC: dict[str, Any] = STEEL | {
    "material": FIBROUS, "load": 1e5, "friction": 0.3, "charge": 2e-6, "magnetic_charge": -3e-3
}  # fmt: skip
_STEPS = np.linspace(-3.1, 3.1, 241)
_SHARE = 1 / (1 + np.exp(-np.pi * np.sinh(_STEPS)))
#: Double-exponential rule in the angle, X = cos(angle): 241 nodes integrate fields of friction up to 4 to rounding.
_ANGLE = np.pi * _SHARE
_X, _ROOT = np.clip(np.cos(_ANGLE), -1 + 2**-53, 1 - 2**-53), np.sin(_ANGLE)
_WEIGHT = (_STEPS[1] - _STEPS[0]) * np.pi * np.cosh(_STEPS) * _ANGLE * (1 - _SHARE)
_INSIDE = np.array([-0.93, -0.41, 0.07, 0.55, 0.9])


def tractions(case: dict[str, Any]) -> tuple[Array, Array, Array]:
    """Tractions (sigma_xy, sigma_yy, D_y, B_y) at ``_INSIDE``, their Hilbert transforms there, and x."""
    out = solver.solve(case, np.concatenate([_X, _INSIDE]), regular=True)
    root = np.concatenate([_ROOT, np.sqrt(1 - _INSIDE**2)])
    rows = [out.shear_traction * root, -out.contact_pressure * root]
    rows += [out.electric_displacement_y_regular, out.magnetic_induction_y_regular]
    t = np.stack([row.values for row in rows])
    regular, values = t[:, : _X.size], t[:, _X.size :] / root[_X.size :]
    quotient = (regular[:, None] - values[:, :, None] * _ROOT) / (_X - _INSIDE[:, None])
    # the singularity is taken out of the principal value
    transforms = (quotient @ _WEIGHT + values * np.log((1 - _INSIDE) / (1 + _INSIDE))) / np.pi
    a, b = out.contact_trailing.item(), out.contact_leading.item()
    return values, transforms, (a - b) / 2 + (a + b) / 2 * _INSIDE


@property_based
@given(c=constants(), case=loads())
def test_the_integral_equations_hold(c: dict[str, Any], case: dict[str, Any]) -> None:
    surface = surface_response({"g11": 0.0, "g33": 0.0} | c)
    values, transforms, x = tractions({"material": Material(**c, any_size=ANY_SIZE), **case})
    N, k = surface.normal_compliance, surface.shear_coupling
    residual = np.outer(k, values[0]) + N @ transforms[1:]
    residual[0] -= x / case["radius"]
    size = np.abs(N) @ np.max(np.abs(values[1:]), axis=1) + np.abs(k) * np.max(np.abs(values[0]))
    assert np.all(np.abs(residual) <= 1e-11 * size[:, None])


@pytest.mark.parametrize(
    ("profile", "slope", "lost"),
    [
        ({"radius": 0.05}, (0.0, 20.0), 1e-11),
        # the rule loses digits where a corner leaves the pressure unbounded
        ({"profile": "wedge", "slope": 0.004, "corner": "trailing"}, (-0.004,), 1e-6),
        ({"profile": solver.Profile.polynomial([1e-4, 15.0, 1e4, 2e7])}, (1e-4, 15.0, 1e4, 2e7), 1e-11),
    ],
    ids=["cylinder", "wedge", "cubic"],
)
def test_surfaces_of_body_and_elastic_punch_fit(profile: dict[str, Any], slope: tuple[float, ...], lost: float) -> None:
    """Slopes of body and punch, each from the Stroh eigenvectors of its material, differ by that of the profile."""
    materials = FIBROUS, Material.isotropic(210e9, 0.3)
    values, transforms, x = tractions(ELASTIC | profile)
    body, punch = (surface_response(cases.constants(m)) for m in materials)
    fits = body.shear_coupling[0] * values[0] + body.normal_compliance[0] @ transforms[1:]
    fits += punch.normal_compliance[0, 0] * transforms[1] - punch.shear_coupling[0] * values[0]  # upside down
    required = sum(c * x**k for k, c in enumerate(slope))
    np.testing.assert_allclose(fits, required, rtol=0, atol=lost * np.max(np.abs(required)))


@pytest.mark.parametrize("friction", [0.0, 0.9])
def test_isotropic_bodies_are_those_of_the_textbooks(friction: float) -> None:
    """Johnson, Contact Mechanics: cot(pi alpha) = eta beta of Dundurs; Hertz's half-length without friction."""
    (E1, nu1), (E2, nu2) = (70e9, 0.22), (200e9, 0.3)
    case = {"material": Material.isotropic(E1, nu1), "punch_modulus": E2, "punch_poisson": nu2, "friction": friction}
    computed = solver.solve(case | {"radius": 0.05, "load": 1e5})
    G1, G2 = E1 / (2 * (1 + nu1)), E2 / (2 * (1 + nu2))
    beta = ((1 - 2 * nu1) / G1 - (1 - 2 * nu2) / G2) / (2 * (1 - nu1) / G1 + 2 * (1 - nu2) / G2)
    alpha = 0.5 - np.arctan(friction * beta) / np.pi
    assert computed.pressure_exponent.item() == pytest.approx(alpha, rel=1e-13)
    star = 1 / ((1 - nu1**2) / E1 + (1 - nu2**2) / E2)
    width = (computed.contact_trailing + computed.contact_leading).item()
    assert width == pytest.approx(np.sqrt(4 * 0.05 * 1e5 / (star * alpha * (1 - alpha) * np.pi)), rel=1e-13)


def test_datum_of_an_elastic_punch_moves_the_depth_by_a_logarithm() -> None:
    punch = Punch.isotropic(210e9, 0.3)
    sliding = Sliding(HalfPlane(FIBROUS), np.array(0.3), np.array([True, True]), punch)
    contact = Contact(sliding, Profile.cylinder(np.array(0.05)), np.array(1e5), np.array([2e-6, -3e-3]))
    near, far = (float(Response(contact, np.array(0.2), np.array(datum)).depth) for datum in (0.05, 0.5))
    assert far - near == pytest.approx(float(punch.compliance) * 1e5 / np.pi * np.log(10), rel=1e-10)
