"""Fields inside the half-plane and their largest values: 50-digit eigenvectors, line integrals, dense searches."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import fmin

import solver
from solver.arrays import Array
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.solution import body_of
from solver.fields import INTERIOR, INTERIOR_ON_REQUEST
from tests.solver.cases import CFO, PZT, STEEL
from verification.cases import SIH_SONG, constants
from verification.oracles import collocation, interior
from verification.oracles.surface_response import surface_response

POINTS = [(0.0, -0.7), (0.9, -0.1), (-1.2, -0.1), (3.0, -5.0), (1.0, -0.02), (-200.0, -30.0)]
ALL = [*INTERIOR, *INTERIOR_ON_REQUEST]
GROUPS = ("stress", "electric_displacement", "magnetic_induction", "electric_field", "magnetic_field", "strain")


def at_points(factors: dict[str, Any], points: list[tuple[float, float]], **options: Any) -> xr.Dataset:
    """Interior fields at scattered points, along the dimension ``point``."""
    parts = [solver.solve_interior(factors, [x], [y], **options).squeeze(("x", "y"), drop=True) for x, y in points]
    return xr.concat(parts, "point")


def assert_close(computed: xr.Dataset, expected: dict[str, Any], rtol: float) -> None:
    """Each component at each point to rtol of the largest of its kind there, or of its largest anywhere in rounding."""
    for group in GROUPS:
        names = [name for name in expected if name.startswith(group)]
        if not names:
            continue
        sizes = np.max(np.abs([np.asarray(expected[name]) for name in names]), axis=0)
        for name in names:
            error = np.abs(computed[name].values - np.asarray(expected[name]))
            assert np.all(error <= rtol * sizes + 1e-300), (name, error / (sizes + 1e-300))


def nearly_isotropic() -> solver.Material:
    """Roots i within 1e-6, 1e-5 and 1e-4: too close for eigenvectors, too far for a degenerate formula."""
    constants = {name: float(getattr(STEEL, name)) for name in ("c11", "c12", "c13", "c33", "c44", "rho")}
    constants |= {"eps11": 1e-10 * (1 + 1e-4), "eps33": 1e-10, "e33": 1e-3, "f15": 1e-2, "g11": 1e-14}
    constants["c44"] *= 1 + 1e-10
    return solver.Material.from_mapping(constants)


#: Cases that the group of 50 digits of the verification lacks.
CASES = {
    "nearly isotropic": (nearly_isotropic(), 0.0, (1, 2)),
    "nearly at the limit": (solver.find("PZT-5H"), 1970.0, (1, 2)),
    "two near each other": (PZT, 0.0, (1,)),
}


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", CASES)
def test_fields_agree_with_50_digit_eigenvectors(name: str) -> None:
    material, speed, conducted = CASES[name]
    case: dict[str, Any] = {"radius": 0.05, "load": 1e5, "friction": 0.4}
    case |= {"charge": 1e-6 * (1 in conducted), "magnetic_charge": 1e-3 * (2 in conducted), "speed": speed}
    exact = interior.solve(constants(material), POINTS, **case, conducted=conducted)
    kinds = {field: "conducting" if i in conducted else "insulating" for i, field in ((1, "electric"), (2, "magnetic"))}
    computed = at_points({"material": material, **case, **kinds}, POINTS, fields=ALL)
    assert_close(computed, exact, 2e-11 if speed > 1900 else 1e-12)


@pytest.mark.parametrize(("kind", "corner"), [("flat", "leading"), ("wedge", "trailing"), ("half_cylinder", "leading")])
def test_profiles_agree_with_quadrature_of_collocated_tractions(kind: str, corner: str) -> None:
    shapes: dict[str, tuple[dict[str, Any], collocation.Profile]] = {
        "flat": ({"width": 4e-4, "slope": 5e-5}, collocation.flat(4e-4, 5e-5)),
        "wedge": ({"slope": 2e-3, "corner": corner}, collocation.wedge(2e-3, corner)),
        "half_cylinder": ({"radius": 0.05, "corner": corner}, collocation.half_cylinder(0.05, corner)),
    }
    factors, shape = shapes[kind]
    surface = surface_response(constants(CFO))
    contact = collocation.solve(
        collocation.Problem(surface.normal_compliance, surface.shear_coupling, shape, 0.5, 1e5, 1e-6, 1e-3)
    )
    points = [(0.3, -0.3), (-1.0, -0.25), (1.4, -0.8)]
    units = np.array([1.0, 1.0, 1e10, 1e8])
    Q, R, T = (units[:, None] * block * units / 1e11 for block in (surface.Q, surface.R, surface.T))
    N1, N2 = -np.linalg.solve(T, R.T), np.linalg.inv(T)
    roots, vectors = np.linalg.eig(np.block([[N1, N2], [-R @ N1 - Q, N1.T]]))
    upper = roots.imag > 0
    p, A, B = roots[upper], vectors[:4, upper], vectors[4:, upper]
    right, left, weight = collocation.end_proof_nodes()
    tractions = contact._tractions(right, left)
    tractions = np.vstack([0.5 * tractions[0], tractions]) * units[:, None]
    s = (left - right) / 2
    rows = []
    for x, y in points:
        g = [-(tractions * weight) @ (1 / (s - (x + root * y))) / (2j * np.pi) for root in p]
        f = np.array([np.linalg.solve(B, g_k)[k] for k, g_k in enumerate(g)])
        t_2, t_1 = 2 * np.real(B @ f) / units, -2 * np.real(B @ (p * f)) / units
        electric = -2 * np.real(A @ f)[2] * units[2] / 1e11
        rows.append([t_1[0], t_2[1], t_2[0], t_1[2], t_2[2], t_1[3], t_2[3], electric])
    names = ["stress_xx", "stress_yy", "stress_xy", "electric_displacement_x", "electric_displacement_y"]
    names += ["magnetic_induction_x", "magnetic_induction_y", "electric_field_x"]
    case = {"material": CFO, "profile": kind, "load": 1e5, "friction": 0.5, "charge": 1e-6, "magnetic_charge": 1e-3}
    assert_close(at_points(case | factors, points), dict(zip(names, np.transpose(rows), strict=True)), 1e-10)


BOTH = ("electric", "magnetic")
POTENTIALS = [f"{field}_potential" for field in BOTH]


def test_differences_of_potentials_of_a_moving_punch_are_line_integrals_of_the_fields() -> None:
    """At rest they are those inside films on their own material, whose gradients are the fields."""
    case = {"material": "PZT-4", "radius": 0.1, "load": 1e5, "friction": 0.6, "electric": "insulating", "speed": 900.0}
    response = solver.solve(case)
    half_width = float(response["contact_trailing"] + response["contact_leading"]) / 2
    t, weights = np.polynomial.legendre.leggauss(200)
    (x0, y0), (x1, y1) = path = ((0.1, -5.0), (4.0, 0.0))
    x, y = (x0 + x1) / 2 + t * (x1 - x0) / 2, (y0 + y1) / 2 + t * (y1 - y0) / 2
    across = solver.solve_interior(case, x, [y0], fields=[f"{field}_field_x" for field in BOTH])
    down = solver.solve_interior(case, [x1], y, fields=[f"{field}_field_y" for field in BOTH])
    ends = [solver.solve_interior(case, [x], [y], fields=POTENTIALS).squeeze(drop=True) for x, y in path]
    for field in BOTH:
        integral = weights @ across[f"{field}_field_x"].values[0] * (x1 - x0) / 2
        integral += weights @ down[f"{field}_field_y"].values[:, 0] * (y1 - y0) / 2
        first, last = (float(end[f"{field}_potential"]) for end in ends)
        size = max(abs(first), abs(last), 1e-30)
        assert last - first == pytest.approx(-half_width * integral, rel=1e-9, abs=1e-11 * size)


BASE: dict[str, Any] = {"radius": 0.05, "load": 1e5}
SIH: dict[str, Any] = {"material": SIH_SONG, "load": 1e5}
#: Bodies and punches whose peaks are searched for; charges that rival the load make narrow peaks under the edges.
SEARCHED: dict[str, dict[str, Any]] = {
    "magnetic charge": BASE | SIH | {"friction": 0.3, "magnetic_charge": -4e-3},
    "steep friction": BASE | {"material": "PZT-4", "friction": 0.8, "charge": -5e-6},
    "moving": BASE | {"material": "steel", "friction": 0.2, "speed": 1500.0},
    "electric insulator": BASE | SIH | {"friction": 0.4, "electric": "insulating"},
    "wedge": SIH | {"friction": 0.5, "profile": "wedge", "slope": 2e-3},
    "tilted": SIH | {"friction": 0.2, "profile": "flat", "width": 4e-4, "slope": 5e-5},
    "no friction": {"volume_fraction": 0.3, "radius": 0.02, "load": 3e4, "charge": 3e-6, "magnetic_charge": -3e-3},
    "small": {"volume_fraction": 0.8, "radius": 6e-3, "load": 2e3, "friction": 1.2, "charge": -2e-6},
}  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", SEARCHED)
def test_peaks_are_above_every_point_of_a_dense_net_and_those_of_a_search_from_the_highest(name: str) -> None:
    """Simplices from the highest points of the net, over X and the root of the depth below 0.1 h."""
    case = SEARCHED[name]
    body = body_of(Cases(checked(case), {}, ("BaTiO3", "CoFe2O4")))  # once for all points of a search
    computed = solver.solve(case, peaks=True)
    half = (computed["contact_trailing"] + computed["contact_leading"]).item() / 2
    near = np.linspace(-0.1, 0.1, 81)
    across = np.concatenate([np.linspace(-8, 8, 161), [14.0, 20.0], 1 + near, -1 + near])
    fields = ["von_mises", "principal_tension"]
    net = solver.solve_interior(case, across, -0.1 * 1.15 ** np.arange(27), fields=fields)
    small = 1e-13 * float(net["von_mises"].max())
    for field in fields:
        flat = net[field].stack(point=("x", "y"))
        highest, peak = float(flat.max()), computed[f"peak_{field}"].item()
        assert max(highest, 0.0) * (1 - 1e-12) <= peak
        if highest <= 0:
            assert peak <= 1e7 * small
            continue

        def lowered(point: Array, field: str = field) -> float:
            return -float(body.interior(point[:1], -0.1 - point[1:] ** 2, [field])[field].item())

        tops = []
        for x, y in flat["point"].values[np.argsort(-flat.values)[:40:20]]:
            start = np.array([x, np.sqrt(max(-0.1 - y, 0.0))])
            simplex = start + np.array([[0.0, 0.0], [0.02, 0.0], [0.0, 0.05]])
            top = fmin(lowered, start, xtol=1e-9, ftol=small, maxiter=2000, disp=False, initial_simplex=simplex)
            tops.append((-lowered(top), 0.1 + float(top[1]) ** 2))
        assert peak == pytest.approx(max(tops)[0], rel=1e-10 if field == "von_mises" else 1e-9)
        if field == "von_mises":
            assert computed["peak_von_mises_depth"].item() == pytest.approx(max(tops)[1] * half, rel=2e-6)


@pytest.mark.parametrize("friction", [1e-2, 1e-3, 1e-4])
def test_little_friction_pulls_far_behind_the_punch(friction: float) -> None:
    """Flamant: (2 P/pi r)(eta cos - sin) at depth 0.1 h is largest at r = 0.2 h/eta, where it is 5 P eta^2/(pi h)."""
    steel = solver.Material.isotropic(200e9, 0.3)
    computed = solver.solve({"material": steel, **BASE, "friction": friction}, peaks=True)
    half = (computed["contact_trailing"] + computed["contact_leading"]).item() / 2
    expected = 5e5 * friction**2 / (np.pi * half)
    assert computed["peak_principal_tension"].item() == pytest.approx(expected, rel=20 * friction)


def test_a_search_does_not_depend_on_the_cases_solved_with_it() -> None:
    """Flat punches with charges have flat hills, on which a climb that goes on moves the value by 1e-5."""
    rng, count = np.random.default_rng(3), 12
    load = 10 ** rng.uniform(-6, 9, count)
    width, friction, charge = (10 ** rng.uniform(*decades, count) for decades in ((-6, 1), (-6, 0), (-16, -9)))
    columns = {"load": load, "width": width, "friction": friction, "charge": load * charge}
    case: dict[str, Any] = {"material": "PZT-4", "profile": "flat"}
    together = solver.solve(
        case | {name: xr.DataArray(values, dims="case") for name, values in columns.items()}, peaks=True
    )
    for number in range(count):
        row = {name: float(values[number]) for name, values in columns.items()}
        alone = solver.solve(case | row, peaks=True)
        for name in ("peak_von_mises", "peak_principal_tension"):
            value = float(together[name][number])
            assert value == pytest.approx(float(alone[name]), rel=1e-9, abs=1e-12 * load[number]), (name, number)
