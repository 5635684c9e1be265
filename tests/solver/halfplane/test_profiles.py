"""Every profile against Gauss-Jacobi collocation, tangents against differences, and what is refused."""

from typing import Any

import numpy as np
import pytest

import solver
from verification.oracles import collocation, profile
from verification.oracles.collocated import fields, quantities
from verification.oracles.sample_materials import SIH_SONG as CONSTANTS
from verification.oracles.surface_response import reduced, surface_response

BASE: dict[str, Any] = {"material": "BaTiO3-CoFe2O4 50:50", "load": 1e5, "datum": 0.2}
POSITIONS = np.array([-1.7, -1.001, -0.95, 0.2, 0.95, 1.001, 4.0])
CONDUCTED = [(1, 2), (1,), (2,), ()]


#: g' = 2e-4 + 10 x + 1e9 x^3 from the corner.
CORNERED = (2e-4, 10.0, 0.0, 1e9)

CASES: dict[str, tuple[dict[str, Any], profile.Profile]] = {
    "flat": ({"profile": "flat", "width": 4e-4}, profile.flat(4e-4)),
    "wedge": ({"profile": "wedge", "slope": 2e-3}, profile.wedge(2e-3)),
    "half cylinder": (
        {"profile": "half_cylinder", "radius": 0.05, "corner": "trailing"}, profile.half_cylinder(0.05, "trailing")
    ),
    "quartic": (
        {"profile": solver.Profile.polynomial((0.0, 0.0, 0.0, 5e8), (True, True))},
        profile.Profile(lambda x: 5e8 * x**3),
    ),
    "one corner": (
        {"profile": solver.Profile.polynomial(CORNERED, (True, False))},
        profile.Profile(lambda x: 2e-4 + 10.0 * x + 1e9 * x**3, sharp_leading=0.0),
    ),
    "two corners": (
        {"profile": solver.Profile.polynomial((1e-5, 0.2, 1e3), (False, False), 4e-4)},
        profile.Profile(lambda x: 1e-5 + 0.2 * x + 1e3 * x**2, 2e-4, -2e-4),
    ),
}  # fmt: skip


def collocated(shape: profile.Profile, friction: float, conducted: tuple[int, ...], load: float) -> Any:
    surface = surface_response(CONSTANTS)
    charges = 1e-6 * (1 in conducted), -2e-3 * (2 in conducted)
    case = collocation.Problem(
        surface.normal_compliance, surface.shear_coupling, shape, friction, load, *charges, conducted
    )
    return collocation.solve(case), surface


@pytest.mark.sampled(10)
@pytest.mark.parametrize("conducted", CONDUCTED)
@pytest.mark.parametrize("friction", [0.0, 1e-12, 0.8])
@pytest.mark.parametrize("name", CASES)
def test_profile_agrees_with_collocation(name: str, friction: float, conducted: tuple[int, ...]) -> None:
    factors, shape = CASES[name]
    computed, surface = collocated(shape, friction, conducted, 1e5)
    kinds = {field: "conducting" if i in conducted else "insulating" for i, field in ((1, "electric"), (2, "magnetic"))}
    charges = {"charge": computed.problem.charge, "magnetic_charge": computed.problem.magnetic_charge}
    solved = solver.solve(BASE | factors | kinds | charges | {"friction": friction}, POSITIONS)
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
