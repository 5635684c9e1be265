"""Every profile against Gauss-Jacobi collocation, tangents against differences, and what is refused."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from verification.oracles import collocation, profile
from verification.oracles.collocated import fields, quantities
from verification.oracles.sample_materials import SIH_SONG as CONSTANTS
from verification.oracles.surface_response import reduced, surface_response

BASE: dict[str, Any] = {"material": "BaTiO3-CoFe2O4 50:50", "load": 1e5, "datum": 0.2}
POSITIONS = np.array([-1.7, -1.001, -0.95, 0.2, 0.95, 1.001, 4.0])
CONDUCTED = [(1, 2), (1,), (2,), ()]


def cubic(x: Any) -> Any:
    return 3.0 * (x - 5e-5) + 2e9 * (x - 5e-5) ** 3


#: g' = 3 (x - x0) + 2e9 (x - x0)^3 with x0 = 5e-5, in powers of x.
CUBIC = (-3.0 * 5e-5 - 2e9 * 5e-5**3, 3.0 + 6e9 * 5e-5**2, -6e9 * 5e-5, 2e9)
#: g' = 2e-4 + 10 x + 1e9 x^3 from the corner.
CORNERED = (2e-4, 10.0, 0.0, 1e9)

CASES: dict[str, tuple[dict[str, Any], profile.Profile]] = {
    "cylinder": ({"radius": 0.05}, profile.cylinder(0.05)),
    "flat": ({"profile": "flat", "width": 4e-4}, profile.flat(4e-4)),
    "tilted": ({"profile": "flat", "width": 4e-4, "slope": 1e-4}, profile.flat(4e-4, 1e-4)),
    "wedge": ({"profile": "wedge", "slope": 2e-3}, profile.wedge(2e-3)),
    "wedge, trailing": (
        {"profile": "wedge", "slope": 2e-3, "corner": "trailing"},
        profile.wedge(2e-3, "trailing"),
    ),
    "half cylinder": ({"profile": "half_cylinder", "radius": 0.05}, profile.half_cylinder(0.05)),
    "half cylinder, trailing": (
        {"profile": "half_cylinder", "radius": 0.05, "corner": "trailing"},
        profile.half_cylinder(0.05, "trailing"),
    ),
    "quartic": (
        {"profile": solver.Profile.polynomial((0.0, 0.0, 0.0, 5e8), (True, True))},
        profile.Profile(lambda x: 5e8 * x**3),
    ),
    "own, smooth": ({"profile": solver.Profile.polynomial(CUBIC, (True, True))}, profile.Profile(cubic)),
    "own, one corner": (
        {"profile": solver.Profile.polynomial(CORNERED, (True, False))},
        profile.Profile(lambda x: 2e-4 + 10.0 * x + 1e9 * x**3, sharp_leading=0.0),
    ),
    "own, two corners": (
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


@pytest.mark.sampled(24)
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


@pytest.mark.parametrize("name", CASES)
def test_tangents_are_those_of_the_response(name: str) -> None:
    case = BASE | CASES[name][0] | {"friction": 0.4}
    step = 1e-4
    loads = 1e5 * (1 + step * np.array([-1.0, 0.0, 1.0]))

    def response(charges: dict[str, float]) -> xr.Dataset:
        return solver.solve(case | charges | {"load": loads})

    def by_load(tabled: xr.DataArray) -> float:
        return float(tabled[2] - tabled[0]) / (2 * step * 1e5)

    bare, charged = response({}), {"charge": 1e-6, "magnetic_charge": -2e-3}
    assert bare["voltage_per_load"][1].item() == pytest.approx(by_load(bare["voltage"]), rel=1e-7)
    assert bare["magnetic_potential_per_load"][1].item() == pytest.approx(by_load(bare["magnetic_potential"]), rel=1e-7)
    loaded = response(charged)
    for source, potential, blocked, short in (
        ("charge", "voltage", "blocked_load_per_volt", "charge_per_force"),
        ("magnetic_charge", "magnetic_potential", "blocked_load_per_ampere", "flux_per_force"),
    ):
        extra = response(charged | {source: charged[source] * 2})
        by_source = {n: float(extra[n][1] - loaded[n][1]) / charged[source] for n in ("depth", potential)}
        depth_rate, potential_rate = by_load(loaded["depth"]), by_load(loaded[potential])
        expected = by_source["depth"] / (potential_rate * by_source["depth"] - by_source[potential] * depth_rate)
        assert loaded[blocked][1].item() == pytest.approx(expected, rel=1e-6)
        closed = response({source: bare[short][1].item() * 1e5})
        assert abs(closed[potential][1].item()) < 1e-12 * abs(bare[potential][1].item())


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_flat_punch_tilts_as_the_moment_asks(friction: float) -> None:
    moment = 3.0
    case = BASE | {"profile": "flat", "width": 4e-4, "friction": friction}
    nodes, weights = np.polynomial.legendre.leggauss(400)
    angle = np.pi * (nodes + 1) / 2  # X = cos(angle) takes the singular edges away
    X, w = np.cos(angle), weights * np.pi / 2 * np.sin(angle)
    stated = solver.solve(case | {"moment": moment}, X)
    pressure = stated["contact_pressure"].values
    tolerance = 1e-10 if friction == 0 else 1e-3  # edges of other powers than -1/2
    assert 2e-4 * w @ pressure == pytest.approx(1e5, rel=tolerance)
    assert 2e-4**2 * w @ (X * pressure) == pytest.approx(moment, rel=10 * tolerance)
    # one slope gives the same contact, and the moment is linear in it
    low, high = (solver.solve(case | {"slope": s}, X)["contact_pressure"].values @ (X * w) * 4e-8 for s in (0.0, 1e-4))
    tilt = 1e-4 * (4e-8 * (X * w) @ pressure - low) / (high - low)
    same = solver.solve(case | {"slope": tilt}, X)
    np.testing.assert_allclose(stated["contact_pressure"], same["contact_pressure"], rtol=1e-9)


def test_profiles_along_an_axis_are_solved_each_by_itself() -> None:
    case = BASE | {"radius": 0.05, "slope": 1e-4, "width": 4e-4, "friction": [0.0, 0.3], "load": [5e4, 1e5]}
    kinds = ["wedge", "cylinder", "flat", "cylinder", "half_cylinder"]
    whole = solver.solve(case | {"profile": kinds}, [0.5, 2.0])
    assert list(whole["profile"].values) == kinds
    assert "peak_pressure" not in whole
    for i, kind in enumerate(kinds):
        needed = {"cylinder": ["radius"], "flat": ["width", "slope"], "wedge": ["slope"], "half_cylinder": ["radius"]}
        options = {k: v for k, v in case.items() if k not in ("radius", "width", "slope") or k in needed[kind]}
        first = solver.solve(options | {"profile": kind}, [0.5, 2.0])
        for name in whole.data_vars:
            np.testing.assert_array_equal(whole[name].isel(profile=i).transpose(*first[name].dims), first[name])


def test_a_flat_punch_may_tilt_until_the_pressure_leaves_an_edge() -> None:
    """Without friction that is at the slope lam P / (pi h)."""
    lam, _ = reduced(surface_response(CONSTANTS), 0.0)
    limit = lam * 1e5 / (np.pi * 2e-4)
    case = BASE | {"profile": "flat", "width": 4e-4, "friction": 0.0}
    edges = solver.solve(case | {"slope": limit * (1 - 1e-9)}, [-1 + 1e-6, 1 - 1e-6])["contact_pressure"].values
    assert 0 < edges[1] < 1e-5 * edges[0]
    with pytest.raises(solver.FactorError, match="tension"):
        solver.solve(case | {"slope": limit * (1 + 1e-9)})
