"""Fields inside the half-plane and their largest values: 50-digit eigenvectors, line integrals, dense searches."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import fmin, minimize_scalar

import solver
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.solution import body_of
from solver.fields import INTERIOR, INTERIOR_ON_REQUEST
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
    steel = solver.find("steel")
    constants = {name: float(getattr(steel, name)) for name in ("c11", "c12", "c13", "c33", "c44", "rho")}
    constants |= {"eps11": 1e-10 * (1 + 1e-4), "eps33": 1e-10, "e33": 1e-3, "f15": 1e-2, "g11": 1e-14}
    constants["c44"] *= 1 + 1e-10
    return solver.Material.from_mapping(constants)


#: Cases that the group of 50 digits of the verification lacks.
CASES = {
    "nearly isotropic": (nearly_isotropic(), 0.0, (1, 2)),
    "nearly at the limit": (solver.find("PZT-5H"), 1970.0, (1, 2)),
    "two near each other": (solver.find("PZT-4"), 0.0, (1,)),
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
    material = solver.find("CoFe2O4")
    shapes: dict[str, tuple[dict[str, Any], collocation.Profile]] = {
        "flat": ({"width": 4e-4, "slope": 5e-5}, collocation.flat(4e-4, 5e-5)),
        "wedge": ({"slope": 2e-3, "corner": corner}, collocation.wedge(2e-3, corner)),
        "half_cylinder": ({"radius": 0.05, "corner": corner}, collocation.half_cylinder(0.05, corner)),
    }
    factors, shape = shapes[kind]
    surface = surface_response(constants(material))
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
    case: dict[str, Any] = {"material": material, "profile": kind, "load": 1e5, "friction": 0.5}
    case |= {"charge": 1e-6, "magnetic_charge": 1e-3}
    assert_close(at_points(case | factors, points), dict(zip(names, np.transpose(rows), strict=True)), 1e-10)


BOTH = ("electric", "magnetic")
POTENTIALS = [f"{field}_potential" for field in BOTH]


@pytest.mark.parametrize(
    ("case", "path"),
    [
        ({"volume_fraction": 0.5, "radius": 0.05, "friction": 0.3, "charge": 1e-6, "magnetic_charge": -1e-3},
         ((0.2, -0.4), (1.7, -0.05))),
        ({"volume_fraction": 0.3, "profile": "flat", "width": 0.01, "friction": 0.5, "charge": 2e-6, "datum": 3.0},
         ((-1.4, -0.3), (-30.0, -8.0))),
        ({"material": "PZT-4", "radius": 0.1, "friction": 0.6, "electric": "insulating", "speed": 900.0},
         ((0.1, -5.0), (4.0, 0.0))),
    ],
    ids=["cylinder", "flat", "moving"],
)  # fmt: skip
def test_differences_of_potentials_are_line_integrals_of_the_fields(
    case: dict[str, Any], path: tuple[tuple[float, float], tuple[float, float]]
) -> None:
    case = case | {"load": 1e5}
    response = solver.solve(case)
    half_width = float(response["contact_trailing"] + response["contact_leading"]) / 2
    t, weights = np.polynomial.legendre.leggauss(200)
    (x0, y0), (x1, y1) = path
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

SEARCHED: list[dict[str, Any]] = [
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
@pytest.mark.parametrize("case", SEARCHED, ids=lambda case: "-".join(map(str, case.values())))
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
