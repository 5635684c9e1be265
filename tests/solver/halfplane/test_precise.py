"""The half-plane: quantities and surface fields in 50 digits; fields inside, their integrals and largest values."""

import warnings
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from mpmath import isnan, mp, mpf
from scipy.optimize import brentq, fmin

import solver
from solver.arrays import Array
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.solution import body_of
from solver.fields import INTERIOR, INTERIOR_ON_REQUEST
from solver.halfplane.precision import TOLERATED, rounding
from solver.halfplane.speed import limiting_speed, transonic_speed
from solver.halfplane.surface import HalfPlane
from solver.material.constants import ANY_SIZE
from tests.solver.cases import AXIAL, CFO, PZT, STEEL, assert_agrees
from verification import digits
from verification.cases import CHARGED, SIH_SONG, constants
from verification.oracles import collocation, interior, precise
from verification.oracles.half_plane import half_plane
from verification.oracles.sample_materials import BARIUM_TITANATE, COBALT_FERRITE, isotropic
from verification.oracles.surface_response import surface_response

UP_TO_THE_EDGES = (-1e4, -3.17, -1 - 1e-7, -1 + 1e-7, -0.5, 0.0, 0.7, 1 - 1e-7, 1 + 1e-7, 1.49, 3.2, 1e4)


def check(material: solver.Material, positions: tuple[float, ...], **change: float) -> None:
    case = CHARGED | change
    exact = precise.solve(constants(material), positions=positions, **case)
    assert_agrees(solver.solve({"material": material, **case}, positions), exact)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", AXIAL)
def test_built_in_materials(name: str) -> None:
    check(solver.find(name), digits.X)


@pytest.mark.parametrize(
    ("name", "friction", "conducted"),
    [(SIH_SONG, 1.3, (1, 2)), (SIH_SONG, 0.0, (1,)), ("PZT-5H", 0.4, ()), ("PZT-5H", 1e-9, (2,))],
)
def test_conduction(name: str, friction: float, conducted: tuple[int, ...]) -> None:
    """A quantity that an insulating punch lacks is NaN by the oracle and absent from the solution."""
    case: dict[str, Any] = {"radius": 0.03, "load": 4e4, "friction": friction, "datum": 0.2}
    case |= {"charge": 1e-6 * (1 in conducted), "magnetic_charge": -2e-3 * (2 in conducted)}
    case |= {"electric" if i == 1 else "magnetic": "insulating" for i in (1, 2) if i not in conducted}
    exact = precise.solve(constants(solver.find(name)), positions=UP_TO_THE_EDGES, **case)
    computed = solver.solve({"material": name, **case}, UP_TO_THE_EDGES)
    absent = {quantity for quantity, value in exact.quantities.items() if isnan(value)}
    assert not absent & set(computed)
    known = {quantity: value for quantity, value in exact.quantities.items() if quantity not in absent}
    assert_agrees(computed, replace(exact, quantities=known, fields={}), 2e-13)
    assert_agrees(computed, replace(exact, quantities={}), 2e-12)


def test_fields_outside_the_very_edges() -> None:
    """Steel under steep friction has a small pressure exponent: rounding of 1/X would show in sigma_xx."""
    check(solver.find("steel"), (-1 - 1e-9, 1 + 1e-8, 1 + 1e-12), friction=10.0)


CASE = {"radius": 0.05, "load": 1e5, "friction": 0.3}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("short", [1e-3, 1e-9, 1e-12, 1e-15])
@pytest.mark.parametrize("name", ["steel", "PZT-5H"])
def test_the_estimate_follows_the_error_next_to_the_limiting_speed(name: str, short: float) -> None:
    material = solver.find(name)
    speed = np.asarray(limiting_speed(material) * (1 - short))
    exact = np.array(half_plane(constants(material), float(speed)).normal_compliance.tolist(), dtype=float)
    half = HalfPlane(material, speed)
    size = np.sqrt(np.abs(np.diag(exact)))
    error = float(np.max(np.abs(half.compliance - exact) / np.outer(size, size)))
    assert error <= max(30 * rounding(half), 1e-11)
    assert (rounding(half) > TOLERATED) == (short < 1e-6)


def test_lost_digits_are_warned_of_in_words() -> None:
    sheared = replace(solver.find("BaTiO3"), c44=np.asarray(43.0), name="sheared", any_size=ANY_SIZE)
    with pytest.warns(solver.PrecisionWarning, match="sheared: constants so far apart that rounding costs digits"):
        solver.solve({"material": sheared, **CASE})
    speed = float(limiting_speed(solver.find("steel"))) * (1 - 1e-14)
    with pytest.warns(solver.PrecisionWarning, match="steel: a speed so near the limiting one that"):
        solver.solve({"material": "steel", "speed": speed, **CASE})


def test_ordinary_materials_are_not_warned_of() -> None:
    with warnings.catch_warnings(action="error"):
        solver.solve({"material": AXIAL, **CASE, "load": 1e3})  # rubber stays in small strain
        solver.solve({"volume_fraction": np.linspace(0, 1, 5), "composite": ["fibrous", "laminate"], **CASE})


BOTH = np.array([True, True])


def test_limiting_speed_of_isotropic_solids_is_that_of_rayleigh_waves() -> None:
    for poisson in (0.0, 0.2, 0.3, 0.45):
        material = solver.Material.isotropic(200e9, poisson, rho=7850.0)
        shear = np.sqrt(float(material.c44) / 7850)
        ratio = (1 - 2 * poisson) / (2 - 2 * poisson)

        def rayleigh(v: float, ratio: float = ratio) -> float:
            return float((2 - v * v) ** 2 - 4 * np.sqrt((1 - v * v) * (1 - ratio * v * v)))

        expected = shear * brentq(rayleigh, 0.5, 1 - 1e-12, xtol=1e-15)
        assert float(limiting_speed(material, BOTH)) == pytest.approx(expected, rel=1e-12)
        assert float(transonic_speed(material)) == pytest.approx(shear, rel=1e-12)


def test_at_the_limiting_speed_the_restricted_tensor_is_singular() -> None:
    def stiffness(speed: mpf) -> mpf:
        N = half_plane(constants(solver.find(SIH_SONG)), float(speed)).normal_compliance
        return 1 / (N[0, 0] - (N[0, 1:3] * mp.inverse(N[1:3, 1:3]) * N[1:3, 0])[0])

    limit = float(limiting_speed(solver.find(SIH_SONG), BOTH))
    at_rest, below, above = (stiffness(mpf(v)) for v in (0.0, limit * (1 - 1e-9), limit * (1 + 1e-9)))
    assert below > 0 > above
    assert abs(below) < 1e-6 * at_rest


#: Ceramics with c13 where a pair of roots coalesces on the imaginary axis: the discriminant is zero.
TITANATE, FERRITE = BARIUM_TITANATE | {"c13": 73530337388.73566}, COBALT_FERRITE | {"c13": 185950658976.0411}
ALUMINIUM = isotropic(70e9, 0.33)


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "material",
    [
        TITANATE, TITANATE | {"c13": TITANATE["c13"] * (1 + 1e-7)}, FERRITE,
        *(ALUMINIUM | {"c33": ALUMINIUM["c33"] * (1 + offset)} for offset in (-1e-8, 0.0, 1e-15)),
        isotropic(70e9, 0.2) | {"g11": 8e-9, "g33": 8e-9},  # three roots p = i, two of them with one eigenvector
        isotropic(5e6, 0.4999),
    ],
)  # fmt: skip
def test_roots_that_coincide_or_nearly_do(material: dict[str, float]) -> None:
    check(solver.Material.from_mapping(material), (-3.0, -1.001, -0.999, 0.25, 0.999, 1.001, 50.0))


MADE = {"c11": 211e9, "c13": 407e9, "c33": 1230e9, "e31": -2.5, "e33": 22.0, "e15": 9.6, "f31": 235.0, "f33": 1180.0}
MADE |= {"f15": 130.0, "eps11": 2.3e-9, "eps33": 9.5e-9, "g11": 0.0, "g33": 5e-9, "mu11": 107e-6, "mu33": 16e-6}


def coupling(c44: float) -> float:
    """kap/lam by Schur complement of the oracle's compliance."""
    surface = surface_response(MADE | {"c44": c44})
    units = np.array([1.0, 1e10, 1e8])
    N, k = surface.normal_compliance / np.outer(units, units), surface.shear_coupling / units
    inverse = np.linalg.inv(N[1:, 1:])
    return float((k[0] - N[0, 1:] @ inverse @ k[1:]) / (N[0, 0] - N[0, 1:] @ inverse @ N[1:, 0]))


@cache
def crossing() -> float:
    """c44 at which kap is zero."""
    return float(brentq(coupling, 12e9, 60e9, xtol=1e-6, rtol=1e-15))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("offset", [0.0, 1e-9, -1e-13, 0.1])
def test_values_at_and_about_the_crossing(offset: float) -> None:
    material = solver.Material.from_mapping(MADE | {"c44": crossing() * (1 + offset)})
    check(material, (-20.0, -1.01, -0.99, -0.4, 0.3, 0.99, 1.01, 4.0), friction=1.5)


@pytest.mark.parametrize(("name", "share"), [(SIH_SONG, 0.999), ("steel", 0.6)])
def test_moving_punch_agrees_with_50_digits(name: str, share: float) -> None:
    positions = [-250.0, -1.7, -1.0001, -0.95, 0.2, 0.95, 1.0001, 4.0]
    case = CHARGED | {"friction": 0.6, "speed": float(limiting_speed(solver.find(name), BOTH)) * share}
    computed = solver.solve({"material": name, **case}, positions)
    exact = precise.solve(constants(solver.find(name)), **case, positions=positions)
    assert_agrees(computed, replace(exact, fields={}), 1e-10)
    for field, values in exact.fields.items():
        reference = np.array(values, float)
        scale = float(np.max(np.abs(reference)))
        np.testing.assert_allclose(computed[field], reference, rtol=1e-9, atol=1e-13 * scale, err_msg=field)


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


FIELD_KINDS = ("electric", "magnetic")
POTENTIALS = [f"{field}_potential" for field in FIELD_KINDS]


def test_differences_of_potentials_of_a_moving_punch_are_line_integrals_of_the_fields() -> None:
    """At rest they are those inside films on their own material, whose gradients are the fields."""
    case = {"material": "PZT-4", "radius": 0.1, "load": 1e5, "friction": 0.6, "electric": "insulating", "speed": 900.0}
    response = solver.solve(case)
    half_width = float(response["contact_trailing"] + response["contact_leading"]) / 2
    t, weights = np.polynomial.legendre.leggauss(200)
    (x0, y0), (x1, y1) = path = ((0.1, -5.0), (4.0, 0.0))
    x, y = (x0 + x1) / 2 + t * (x1 - x0) / 2, (y0 + y1) / 2 + t * (y1 - y0) / 2
    across = solver.solve_interior(case, x, [y0], fields=[f"{field}_field_x" for field in FIELD_KINDS])
    down = solver.solve_interior(case, [x1], y, fields=[f"{field}_field_y" for field in FIELD_KINDS])
    ends = [solver.solve_interior(case, [x], [y], fields=POTENTIALS).squeeze(drop=True) for x, y in path]
    for field in FIELD_KINDS:
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
