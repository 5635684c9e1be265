"""Point contacts: fields inside, on the surface and at sliding edges against textbooks, balance and integrals."""

from functools import cache
from itertools import product
from math import comb
from typing import Any

import mpmath
import numpy as np
import pytest
import xarray as xr
from scipy.linalg import expm
from scipy.optimize import minimize_scalar
from scipy.special import jv

import solver
from solver.arrays import Array
from solver.halfplane.surface import HalfPlane
from solver.material.constants import Material
from solver.point import electrodes, inside
from solver.point.profile import Shape, halfspace_form, halfspace_peak
from solver.point.table import PointKind, PointWindow
from solver.stack.fourier import Medium
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from solver.stack.wavenumbers import strip, wavenumbers
from tests.solver.cases import BTO, CFO, FIBROUS, STEEL

BALL: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}
COAT: dict[str, Any] = {"thickness": 8e-5, "surroundings": "insulated", "base": "steel"}
NU = 0.3
ISOTROPIC = Material.isotropic(200e9, NU, name="isotropic")


def fields_inside(case: dict[str, Any], x: list[float], y: list[float], fields: list[str] | None = None) -> xr.Dataset:
    return solver.solve_interior(case, x, y, fields=fields)


@pytest.mark.parametrize("body", [{}, COAT | {"thickness": 1.2e-4}], ids=["half-space", "film"])
def test_fields_are_in_balance_and_obey_the_material(body: dict[str, Any]) -> None:
    """Differences: parts that do not depend on the angle balance in space; stresses and fields obey the material.

    Mirrored points separate the parts of 1 and of cos(angle).
    """
    step, X, Y = 5e-4, 0.7, -0.6
    case = BALL | {"friction": 0.3} | body
    positions = [-X - step, -X, -X + step, X - step, X, X + step]
    fields = fields_inside(case, positions, [Y - step, Y, Y + step])

    def parts(name: str, mirrored: int = 1) -> tuple[Any, Any]:
        """Parts of 1 and of cos(angle) over (y, x) about X; -1 for a component along r, which x is opposite to."""
        values = fields[name].values.squeeze()
        right, left = values[:, 3:], mirrored * values[:, 2::-1]
        return (right + left) / 2, (right - left) / 2

    def dr(values: Any) -> float:
        return float(values[1, 2] - values[1, 0]) / (2 * step)

    def dy(values: Any) -> float:
        return float(values[2, 1] - values[0, 1]) / (2 * step)

    radial, hoop, normal = (parts(f"stress_{name}") for name in ("xx", "zz", "yy"))
    shear, displacement = parts("stress_xy", -1), parts("electric_displacement_x", -1)
    size = float(np.abs(fields["stress_yy"]).max())
    first = 0  # without friction nothing depends on the angle
    assert abs(dr(radial[first]) + dy(shear[first]) + (radial[first] - hoop[first])[1, 1] / X) < 1e-4 * size
    assert abs(dr(shear[first]) + dy(normal[first]) + shear[first][1, 1] / X) < 1e-4 * size
    up = parts("electric_displacement_y")
    flux = float(np.abs(up[first]).max())
    assert abs(dr(displacement[first]) + dy(up[first]) + displacement[first][1, 1] / X) < 1e-4 * flux
    field_r, field_y = parts("electric_field_x", -1), parts("electric_field_y")
    for part in (0, 1):  # the curl of the electric field is zero in both
        assert abs(dy(field_r[part]) - dr(field_y[part])) < 1e-4 * float(np.abs(field_y[part]).max())
    m = BTO
    positions = [0.7, -0.3]
    strained = ["strain_xx", "strain_yy", "strain_xy"]
    at_points = fields_inside(case, positions, [Y], strained).squeeze(), fields_inside(case, positions, [Y]).squeeze()
    xx, yy, xy = (at_points[0][name].values for name in strained)
    stress, E, D = at_points[1], at_points[1]["electric_field_y"].values, at_points[1]["electric_displacement_y"]
    zz = (stress["stress_yy"].values - m.c33 * yy + m.e33 * E) / m.c13 - xx
    for name, along, other in (("stress_xx", xx, zz), ("stress_zz", zz, xx)):
        np.testing.assert_allclose(stress[name], m.c11 * along + m.c12 * other + m.c13 * yy - m.e31 * E, rtol=1e-9)
    np.testing.assert_allclose(D, m.e31 * (xx + zz) + m.e33 * yy + m.eps33 * E, rtol=1e-9, atol=1e-9 * flux)
    along = stress["electric_field_x"].values
    np.testing.assert_allclose(stress["stress_xy"], 2 * m.c44 * xy - m.e15 * along, rtol=1e-9)


def test_stresses_of_a_film_are_integrals_of_its_system() -> None:
    """On a rigid base: its 8 x 8 system by matrix exponentials, and the pressure's own transform, over k."""
    h, x, y = 1e-4, 0.8, -0.7
    case = BALL | COAT | {"thickness": h, "base": "rigid", "electric": "insulating", "magnetic": "insulating"}
    a = float(solver.solve(case)["contact_radius"])
    medium = Medium(BTO, Medium(BTO, np.ones(4)).halfplane.scale)
    angle, shares = np.polynomial.legendre.leggauss(80)
    angle, shares = np.pi / 4 * (1 + angle), np.pi / 4 * shares
    s = np.sin(angle)
    pressure = solver.solve(case, s)["contact_pressure"].values
    k, weights = np.polynomial.legendre.leggauss(120)
    k, weights = 20 * (1 + k), 20 * weights  # over h: beyond, exponentials of the reference lose their digits
    transform = jv(0, np.outer(k, s) * a / h) @ (shares * np.cos(angle) * s * pressure)
    depth, integral = -y * a / h, 0.0
    for q, weight, t in zip(k, weights, transform, strict=True):
        down = expm(-q * medium.system)  # of [k u; t] from the surface to the base: u = 0 there
        traction = np.array([0.0, -t * medium.scale[1], 0.0, 0.0])
        surface = np.concatenate([np.linalg.solve(down[:4, :4], -down[:4, 4:] @ traction), traction])
        state = expm(-q * depth * medium.system) @ surface
        integral += weight * q * (a / h) ** 2 * state[5] / medium.scale[1] * jv(0, q * x * a / h)
    solved = float(fields_inside(case, [x], [y], ["stress_yy"])["stress_yy"].squeeze())
    assert solved == pytest.approx(integral, rel=2e-8)


CHARGED: dict[str, Any] = BALL | {"material": FIBROUS, "friction": 0.3, "total_charge": 1e-9, "total_flux": 1e-9}


END: dict[str, Any] = {"profile": "disc", "width": 2e-4}
SLID = {"half-space": CHARGED, "film": CHARGED | COAT, "disc": CHARGED | END, "disc on a film": CHARGED | END | COAT}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", SLID.values(), ids=SLID)
def test_potentials_fall_as_the_fields_say_and_are_the_punch_s_on_the_contact(case: dict[str, Any]) -> None:
    """Central differences, near the surface and deep; at 0.01 a and above the half-space's part is closed."""
    case, step = {name: value for name, value in case.items() if name != "radius" or "width" not in case}, 3e-4
    punch = solver.solve(case)
    a = float(punch["contact_radius"])
    for kind, strength in (("electric", punch["voltage"]), ("magnetic", punch["magnetic_potential"])):
        potential, along, across = f"{kind}_potential", f"{kind}_field_x", f"{kind}_field_y"
        for X, Y in ((-0.4, -0.02), (1.4, -0.02), (0.6, -0.3)):
            points = [X - step, X, X + step], [Y - step, Y, Y + step]
            fields = fields_inside(case, *points, [potential, along, across])
            values = fields[potential].values.squeeze() / (2 * step * a)
            field = [fields[name].values.squeeze()[1, 1] for name in (along, across)]
            falls = [values[1, 0] - values[1, 2], values[0, 1] - values[2, 1]]
            np.testing.assert_allclose(falls, field, atol=1e-5 * float(np.hypot(*field)), rtol=0)
        surface = fields_inside(case, [-0.7, 0.0, 0.95], [0.0], [potential])[potential].values.ravel()
        np.testing.assert_allclose(surface, float(strength), rtol=2e-9)


def test_von_mises_below_a_ball_is_huber_s() -> None:
    """On the axis, where sigma_rr and sigma_yy are closed; the depth is that of the top."""
    solution = solver.solve(BALL | {"material": ISOTROPIC}, peaks=True)
    top = minimize_scalar(
        lambda z: -abs(1.5 / (1 + z**2) - (1 + NU) * (1 - z * np.arctan(1 / z))),
        bounds=(0.3, 0.7), method="bounded", options={"xatol": 1e-9},
    )  # fmt: skip
    assert float(solution["peak_von_mises"] / solution["peak_pressure"]) == pytest.approx(-top.fun, rel=1e-9)
    assert float(solution["peak_von_mises_depth"] / solution["contact_radius"]) == pytest.approx(top.x, rel=1e-6)


FILM: dict[str, Any] = BALL | {"thickness": 1e-4, "surroundings": "insulated", "base": "steel"}


@pytest.mark.parametrize("elastic", [False, True])
def test_half_space_shifts_by_half_the_plane_s_angle(*, elastic: bool) -> None:
    """c = -(a/pi) eta kappa/lambda, of a rigid punch and of one with 210 GPa and nu = 0.3."""
    punch = {"punch_modulus": 210e9, "punch_poisson": 0.3} if elastic else {}
    solution, half = solver.solve(BALL | {"friction": 0.3} | punch), HalfPlane(BTO)
    N = half.compliance + elastic * np.diag([2 * (1 - 0.3**2) / 210e9, 0.0, 0.0])
    k = half.friction_coupling + elastic * np.array([1.3 * 0.4 / 210e9, 0.0, 0.0])
    angle = 0.3 * float(np.linalg.inv(N)[0] @ k)
    assert float(solution["contact_offset"] / solution["contact_radius"]) == pytest.approx(-angle / np.pi, rel=1e-12)


def test_below_an_electrode_it_shifts_as_a_body_whose_surface_is_grounded() -> None:
    """phi = 0 on the surface takes D_y out of N and k; half-spaces are films of the base's own material."""
    bonded = {"thickness": 4e-5, "surroundings": "insulated", "base": "BaTiO3", "interface_electric": "bonded"}
    solution = solver.solve(BALL | bonded | {"friction": 0.3, "electrode": "top", "magnetic": "insulating"})
    half = HalfPlane(BTO)
    (N, k), phi = (half.compliance, half.friction_coupling), 1
    turned = k[0] - k[phi] * N[0, phi] / N[phi, phi]
    angle = 0.3 * turned / (N[0, 0] - N[0, phi] ** 2 / N[phi, phi])
    assert float(solution["contact_offset"] / solution["contact_radius"]) == pytest.approx(-angle / np.pi, rel=1e-12)


@pytest.mark.parametrize("case", [BALL, FILM], ids=["half-space", "film"])
def test_pressure_next_to_the_edge_falls_as_a_root_of_the_distance(case: dict[str, Any]) -> None:
    """To the first order the root's exponent adds a logarithm; sums over depths of 1e-5 had no digits within 1e-4."""
    distance = np.array([1e-6, 1e-4, 1e-2])
    for side in (-1, 1):
        solution = solver.solve(case | {"friction": 0.3}, side * (1 - distance))
        over_root = solution["contact_pressure"].values.ravel() / np.sqrt(distance)
        assert abs(np.diff(over_root, 2)[0]) < 0.03 * over_root[1]


POWER: dict[str, Any] = {"material": "BaTiO3", "profile": "power", "exponent": 4.0, "coefficient": 1e8, "force": 10.0}
RAISED = FILM | {"force": 30.0, "base": "polyimide"}  # largest at 0.7 a


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", [BALL, POWER, POWER | {"exponent": 2.5, "coefficient": 1e3}, RAISED],
                         ids=["ball", "power", "kinked power", "film"])  # fmt: skip
def test_largest_pressure_is_that_of_the_fields_on_the_surface(case: dict[str, Any]) -> None:
    """The fields are computed inside and continued to the surface: another way from the same densities."""
    sliding = case | {"friction": 0.3}
    coarse = np.linspace(-0.98, 0.98, 50)
    best = coarse[np.argmax(solver.solve(sliding, coarse)["contact_pressure"].values.ravel())]
    near = best + 0.04 * np.cos(np.pi * np.arange(9) / 8)
    pressure = solver.solve(sliding, near)["contact_pressure"].values.ravel()
    series = np.polynomial.chebyshev.Chebyshev.fit(near, pressure, 8)
    top = float(np.max(series(best + 0.04 * np.linspace(-1, 1, 20001))))
    assert float(solver.solve(sliding)["peak_pressure"]) == pytest.approx(top, rel=1e-8)


def test_a_sharp_apex_bears_what_it_bears_at_rest() -> None:
    blunt = solver.solve(POWER | {"exponent": 1.5, "coefficient": 1.0, "friction": np.array([0.0, 0.3])})
    assert float(blunt["peak_pressure"][1]) == float(blunt["peak_pressure"][0])


@pytest.mark.parametrize("exponent", [4, 6, 10])
def test_pressure_is_largest_beside_the_centre_above_the_exponent_2(exponent: int) -> None:
    # int_r^1 t^(e-1) / sqrt(t^2 - r^2) dt of an even exponent is a polynomial in x = sqrt(1 - r^2)
    half = exponent // 2 - 1
    x = np.linspace(0, 1, 200001)
    values = sum(comb(half, k) * (1 - x**2) ** (half - k) * x ** (2 * k + 1) / (2 * k + 1) for k in range(half + 1))
    exact = exponent * Shape(exponent).rise * np.max(values)
    assert halfspace_peak(Shape(exponent)) == pytest.approx(exact, rel=1e-9)


AIR: dict[str, Any] = BALL | {"magnetic": "insulating", "surroundings": "air"}
EDGES: dict[str, dict[str, Any]] = {
    "half-space": BALL,
    "film": FILM,
    "half-space in air": AIR,
    "film in air": AIR | {"thickness": 1e-4, "base": "rigid", "force": 37.0},
    "charged composite in air": AIR | {"material": FIBROUS, "total_charge": 2e-10, "magnetic": "conducting"},
}


@pytest.mark.parametrize("name", EDGES)
def test_tension_beside_the_trailing_edge_is_that_of_the_fields_inside(name: str) -> None:
    """Sums over b and waves, extrapolated to the edge, against moments and rates."""
    case, air = EDGES[name] | {"friction": 0.3}, "air" in name
    gaps = (4e-4 if air else 1e-3) * 2.0 ** np.arange(5 if air else 4)
    stresses = solver.solve_interior(case, 1 + gaps, [0.0], fields=["stress_xx"])["stress_xx"].values.ravel()
    rows = gaps[:, None] ** (0.5 * np.arange(len(gaps)))  # what friction adds falls as a root
    edge = float(solver.solve(case)["trailing_tension"])
    assert np.linalg.solve(rows, stresses)[0] == pytest.approx(edge, rel=1e-3 if air else 2e-4)


PUNCHES: list[dict[str, Any]] = [
    {"profile": "sphere", "radius": 5e-3},
    {"profile": "cone", "slope": 0.1},
    {"profile": "disc", "width": 1e-4},
    {"profile": "power", "exponent": 3.5, "coefficient": 1e6},
]
LOADS = {"force": 10.0, "total_charge": 2e-9, "total_flux": 1e-6}
COATED = {"thickness": 1e-4, "surroundings": "insulated", "base": "rigid"}


def solved(case: dict[str, Any], positions: Array) -> dict[str, Array]:
    """Quantities and fields; tractions as (sigma_yy, D_y, B_y) besides."""
    values = {str(name): value.values for name, value in solver.solve(case, positions).items()}
    names = ("contact_pressure", "electric_displacement", "magnetic_induction")
    return values | {"tractions": np.stack([-values[names[0]], values[names[1]], values[names[2]]])}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("punch", PUNCHES, ids=lambda punch: punch["profile"])
@pytest.mark.parametrize("body", [{}, COATED], ids=["half-space", "film"])
def test_tractions_carry_the_loads(punch: dict[str, Any], body: dict[str, Any]) -> None:
    # r = a sin(angle) takes the edge's singularity away, the square in the angle most of an apex's
    nodes, weights = np.polynomial.legendre.leggauss(80)
    angle = np.pi / 2 * ((nodes + 1) / 2) ** 2
    weights = weights * np.pi / 4 * (nodes + 1)
    fields = solved({"material": FIBROUS} | punch | body | LOADS, np.sin(angle))
    ring = 2 * np.pi * fields["contact_radius"] ** 2 * np.sin(angle) * np.cos(angle) * weights
    loads = -fields["tractions"] @ ring / np.array([LOADS[name] for name in ("force", "total_charge", "total_flux")])
    np.testing.assert_allclose(loads, 1.0, rtol=1e-12)


@pytest.mark.parametrize("exponent", [0.4, 1.6])
def test_the_pressure_grows_towards_the_middle_as_in_50_digits(exponent: float) -> None:
    """F = int_0^x (1 - x^2 + v^2)^(e/2 - 1) dv, x = sqrt(1 - r^2), by quadrature in mpmath."""
    places = [1e-9, 1e-6, 1e-3, 0.5, 0.99]
    shape = Shape(exponent)
    ours = halfspace_form(shape, np.sqrt(1 - np.square(places)), np.array(places)) / (shape.rise * exponent)
    with mpmath.workdps(50):
        for r, value in zip(map(mpmath.mpf, places), ours, strict=True):
            breaks = [mpmath.mpf(0), *(r * 10**n for n in range(10) if r * 10**n < 0.9), mpmath.sqrt(1 - r**2)]
            exact = mpmath.quad(lambda v, r=r: (r**2 + v**2) ** (mpmath.mpf(exponent) / 2 - 1), breaks)
            assert value == pytest.approx(float(exact), rel=1e-12), r


SLIDING_BALL: dict[str, Any] = {"profile": "sphere", "radius": 5e-3, "friction": 0.2, "magnetic": "insulating"}
SLIDING_FILM: dict[str, Any] = SLIDING_BALL | {
    "material": "BaTiO3",
    "thickness": 1e-4,
    "surroundings": "insulated",
    "base": "steel",
}
BODY = Stack([Layer(solver.find("glass"), 1e-4, "grounded"), Layer(solver.find("BaTiO3"), 1e-4)])


def answers() -> list[np.ndarray]:
    """Fields near the surface and deep, and charges of patches, of several cases."""
    x, y = [-1.2, 0.3, 0.8], [0.0, -1e-3, -0.02, -0.4, -1.5]
    fields = solver.solve_interior(
        SLIDING_FILM | {"force": [1.0, 2.0, 5.0]}, x, y, fields=["stress_xx", "electric_field_y"]
    )
    patch = {"collector": 2, "patch_size": 2e-4, "patch_position": [5e-5, -1e-4], "patch_pitch": 3e-4}
    read = solver.solve(SLIDING_BALL | {"force": [1.0, 2.0], "body": BODY} | patch)
    names = ("patch_charge_per_force", "crosstalk", "patch_charge_gradient", "electrode_pressure")
    return [fields[name].values for name in fields.data_vars] + [read[name].values for name in names]


def test_blocks_of_any_size_give_the_same_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = answers()
    monkeypatch.setattr(electrodes, "_VALUES_AT_ONCE", 5000)
    for name, size in (("_ENTRIES", 512), ("_PLACES", 2), ("_COLUMNS", 2)):
        monkeypatch.setattr(inside, name, size)
    for small, large in zip(answers(), whole, strict=True):
        np.testing.assert_allclose(small, large, rtol=0, atol=1e-11 * float(np.abs(large).max()))


BONDED = Stack([Layer(FIBROUS, 1.0, "bonded")], CFO)
RIGID_BASE, ON_STEEL = Stack([Layer(BTO, 1.0)]), Stack([Layer(FIBROUS, 1.0)], STEEL)
TWO_LAYERS = Stack([Layer(BTO, 1.0, "grounded"), Layer(CFO, 0.4)], STEEL)


@cache
def by_abel(stack: Stack, a: float, exponent: float, points: int = 200) -> tuple[Array, Array]:
    """Loads and edge strengths of u0 and of (r/a)^e, by N pi/2 f + int K f = G and Gauss's rule; (3, 4) each.

    With t(k) = int_0^a f(s) cos(ks) ds, Abel's transform of the displacement is int Y t(k) cos(kx) dk. Neither the
    functions nor the test of the solver are used; its multiplier is, which the plane's tests know.
    """
    k, weights = wavenumbers(stack, 2 * a, strip(stack))
    N, delta = stack.media[0].compliance[1:, 1:], waves(stack, k)[0].difference[:, 1:, 1:]
    nodes, rule = np.polynomial.legendre.leggauss(points)
    x, rule = a * np.append((1 + nodes) / 2, 1.0), a * rule / 2  # the edge besides, where no mass is
    cosines = np.cos(x[:, None] * k)
    K = np.einsum("xk,k,kij,sk->xisj", cosines, weights, delta, cosines[:-1], optimize=True)
    G = np.zeros((x.size, 3, 4))
    G[:, :, :3] = np.eye(3)
    G[:, 0, 3] = Shape(exponent).rise * (x / a) ** exponent
    size = 3 * points
    system = np.kron(np.eye(points), np.pi / 2 * N) + (K[:-1] * rule[:, None]).reshape(size, size)
    f = np.linalg.solve(system, G[:-1].reshape(size, 4)).reshape(points, 3, 4)
    edge = np.linalg.solve(np.pi / 2 * N, G[-1] - np.einsum("isj,s,sjd->id", K[-1], rule, f))
    return 2 * np.pi * np.einsum("s,sid->id", rule, f), edge


@pytest.mark.sampled(8)
@pytest.mark.parametrize("stack", [RIGID_BASE, ON_STEEL, BONDED, TWO_LAYERS], ids="abcd")
@pytest.mark.parametrize(("a", "exponent"), list(product([0.01, 0.7, 4.0, 9.5], [2.0, 1.0, 0.0])))
def test_loads_and_edges_are_those_of_abel_s_equation(stack: Stack, a: float, exponent: float) -> None:
    point_kind = PointKind(stack, (True, True), Shape(exponent))
    window = PointWindow(point_kind, int(np.floor(2 * np.log10(a))))
    stiffness = point_kind.stiffness(window.read(np.array([np.log(a)])))
    loads, edges = by_abel(stack, a, exponent)
    for ours, exact in ((a * stiffness.loads[0], loads), (stiffness.edges[0], edges)):
        size = np.max(np.abs(exact), 0)
        np.testing.assert_allclose(ours / size, exact / size, atol=1e-9 if exponent == 1.0 else 1e-11)
