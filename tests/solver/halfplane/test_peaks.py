"""Peaks of the body below depth 0.1 h against local searches from many starting points, and what they must obey."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import fmin, minimize_scalar

import solver
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.solution import body_of
from verification.cases import SIH_SONG

BASE: dict[str, Any] = {"radius": 0.05, "load": 1e5}

CASES: list[dict[str, Any]] = [
    {"material": "BaTiO3"},
    {"material": "CoFe2O4", "friction": 0.1, "charge": 3e-6},
    {"material": SIH_SONG, "friction": 0.3, "magnetic_charge": -4e-3},
    {"material": "PZT-4", "friction": 0.8, "charge": -5e-6},
    {"material": "steel", "friction": 0.02, "speed": 1500.0},
    {"material": SIH_SONG, "friction": 0.4, "electric": "insulating"},
    {"material": SIH_SONG, "friction": 0.5, "profile": "wedge", "slope": 2e-3},
    {"material": SIH_SONG, "friction": 0.2, "profile": "flat", "width": 4e-4, "slope": 5e-5},
]  # fmt: skip


def factors(case: dict[str, Any]) -> dict[str, Any]:
    whole = BASE | case
    return {k: v for k, v in whole.items() if k != "radius" or "profile" not in case}


def searched(case: dict[str, Any], field: str) -> tuple[float, float]:
    """Largest value of a field below depth 0.1 h and its depth over h, by simplices from a net of points."""
    body = body_of(Cases(checked(factors(case)), {}, ("BaTiO3", "CoFe2O4")))  # once for all points of a search

    def lowered(point: np.ndarray[Any, np.dtype[np.float64]]) -> float:
        place = point[:1], -0.1 - point[1:] ** 2
        return -float(body.interior(*place, [field])[field].item())

    across = np.concatenate([np.linspace(-1.6, 1.6, 65), [2.0, 3.0, 5.0, 8.0, 14.0, 20.0, -2.0, -3.0]])
    net = solver.solve_interior(factors(case), across, -0.1 * 1.3 ** np.arange(14), fields=[field])[field]
    flat = net.stack(point=("x", "y"))
    best = flat.isel(point=np.argsort(-flat.values)[:40:13])
    computed = []
    for x, y in best["point"].values:
        start = np.array([x, np.sqrt(max(-0.1 - y, 0.0))])
        simplex = start + np.array([[0.0, 0.0], [0.02, 0.0], [0.0, 0.05]])
        small = 1e-13 * float(np.max(np.abs(net)))
        top = fmin(lowered, start, xtol=1e-9, ftol=small, maxiter=2000, disp=False, initial_simplex=simplex)
        computed.append((-lowered(top), 0.1 + float(top[1]) ** 2))
    return max(computed)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("case", CASES, ids=lambda case: "-".join(map(str, case.values())))
def test_peaks_are_those_of_a_search(case: dict[str, Any]) -> None:
    computed = solver.solve(factors(case), peaks=True)
    half = (computed["contact_trailing"] + computed["contact_leading"]).item() / 2
    largest, depth = searched(case, "von_mises")
    assert computed["peak_von_mises"].item() == pytest.approx(largest, rel=1e-10)
    assert computed["peak_von_mises_depth"].item() == pytest.approx(depth * half, rel=2e-6)
    if case.get("friction"):
        assert computed["peak_principal_tension"].item() == pytest.approx(
            searched(case, "principal_tension")[0], rel=1e-9
        )


def test_frictionless_isotropic_contact_has_no_tension_and_the_peak_of_hertz() -> None:
    """Johnson, Contact Mechanics (1985), section 4.2: 0.300 p0 of shear at 0.786 a, from the fields on the axis."""
    steel = solver.Material.isotropic(200e9, 0.3)
    computed = solver.solve({"material": steel, **BASE}, peaks=True)
    p0, a = computed["peak_pressure"].item(), computed["contact_trailing"].item()

    def on_axis(z: float) -> float:
        root = np.hypot(1, z)
        xx, yy = -((1 + 2 * z * z) / root - 2 * z), -1 / root
        zz = 0.3 * (xx + yy)
        return float(np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2))

    depth = minimize_scalar(lambda z: -on_axis(z), bounds=(0.1, 2.0), options={"xatol": 1e-10}).x
    assert computed["peak_von_mises"].item() == pytest.approx(p0 * on_axis(float(depth)), rel=1e-10)
    assert computed["peak_von_mises_depth"].item() == pytest.approx(float(depth) * a, rel=1e-5)
    assert computed["peak_principal_tension"].item() == 0


@pytest.mark.parametrize("friction", [1e-2, 1e-3, 1e-4])
def test_little_friction_pulls_far_behind_the_punch(friction: float) -> None:
    """Flamant: (2 P/pi r)(eta cos - sin) at depth 0.1 h is largest at r = 0.2 h/eta, where it is 5 P eta^2/(pi h)."""
    steel = solver.Material.isotropic(200e9, 0.3)
    computed = solver.solve({"material": steel, **BASE, "friction": friction}, peaks=True)
    half = (computed["contact_trailing"] + computed["contact_leading"]).item() / 2
    expected = 5e5 * friction**2 / (np.pi * half)
    assert computed["peak_principal_tension"].item() == pytest.approx(expected, rel=20 * friction)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(20))
def test_no_point_of_a_dense_net_is_above_the_peak(seed: int) -> None:
    """Charges that rival the load make narrow peaks under the edges."""
    random = np.random.default_rng(seed)
    case = {"volume_fraction": random.uniform(), "friction": float(random.choice([0.0, random.uniform(0.0, 1.5)]))}
    case |= {"radius": 10 ** random.uniform(-2.3, -0.7), "load": 10 ** random.uniform(3.0, 5.5)}
    case |= {"charge": random.uniform(-4e-6, 4e-6), "magnetic_charge": random.uniform(-4e-3, 4e-3)}
    near = np.linspace(-0.1, 0.1, 81)
    across = np.concatenate([np.linspace(-8, 8, 161), 1 + near, -1 + near])
    fields = ["von_mises", "principal_tension"]
    net = solver.solve_interior(case, across, -0.1 * 1.15 ** np.arange(27), fields=fields)
    computed = solver.solve(case, peaks=True)
    for field, peak in zip(fields, ("peak_von_mises", "peak_principal_tension"), strict=True):
        highest = max(float(net[field].max()), 0.0)
        assert highest * (1 - 1e-12) <= computed[peak].item() <= 1.2 * highest + 1e-6 * float(net["von_mises"].max())


def test_a_search_does_not_depend_on_the_cases_solved_with_it() -> None:
    """Flat punches with charges have flat hills, on which a climb that goes on moves the value by 1e-5."""
    rng = np.random.default_rng(3)
    count = 12
    load = 10 ** rng.uniform(-6, 9, count)
    case: dict[str, Any] = {"material": "PZT-4", "profile": "flat"} | {
        "load": xr.DataArray(load, dims="case"),
        "width": xr.DataArray(10 ** rng.uniform(-6, 1, count), dims="case"),
        "friction": xr.DataArray(10 ** rng.uniform(-6, 0, count), dims="case"),
        "charge": xr.DataArray(load * 10 ** rng.uniform(-16, -9, count), dims="case"),
    }
    together = solver.solve(case, peaks=True)
    for number in range(count):
        alone = solver.solve(
            {k: float(v[number]) if isinstance(v, xr.DataArray) else v for k, v in case.items()}, peaks=True
        )
        for name in ("peak_von_mises", "peak_principal_tension"):
            value = float(together[name][number])
            assert value == pytest.approx(float(alone[name]), rel=1e-9, abs=1e-12 * load[number]), (name, number)
