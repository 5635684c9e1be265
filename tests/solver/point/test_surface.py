"""Points on films: loads and Hankel's integrals of the surface fields, Abel's equation, blocks of any size."""

from functools import cache
from itertools import product
from typing import Any

import mpmath
import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.point import electrodes, inside
from solver.point.profile import Shape, halfspace_form
from solver.point.table import PointKind, PointWindow
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from solver.stack.wavenumbers import strip, wavenumbers
from tests.solver.cases import BTO, CFO, FIBROUS, STEEL

PUNCHES: list[dict[str, Any]] = [
    {"profile": "sphere", "radius": 5e-3},
    {"profile": "cone", "slope": 0.1},
    {"profile": "disc", "width": 1e-4},
    {"profile": "power", "exponent": 3.5, "coefficient": 1e6},
]
CHARGED = {"force": 10.0, "total_charge": 2e-9, "total_flux": 1e-6}
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
    fields = solved({"material": FIBROUS} | punch | body | CHARGED, np.sin(angle))
    ring = 2 * np.pi * fields["contact_radius"] ** 2 * np.sin(angle) * np.cos(angle) * weights
    loads = -fields["tractions"] @ ring / np.array([CHARGED[name] for name in ("force", "total_charge", "total_flux")])
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


BALL: dict[str, Any] = {"profile": "sphere", "radius": 5e-3, "friction": 0.2, "magnetic": "insulating"}
FILM: dict[str, Any] = BALL | {"material": "BaTiO3", "thickness": 1e-4, "surroundings": "insulated", "base": "steel"}
BODY = Stack([Layer(solver.find("glass"), 1e-4, "grounded"), Layer(solver.find("BaTiO3"), 1e-4)])


def answers() -> list[np.ndarray]:
    """Fields near the surface and deep, and charges of patches, of several cases."""
    x, y = [-1.2, 0.3, 0.8], [0.0, -1e-3, -0.02, -0.4, -1.5]
    fields = solver.solve_interior(FILM | {"force": [1.0, 2.0, 5.0]}, x, y, fields=["stress_xx", "electric_field_y"])
    patch = {"collector": 2, "patch_size": 2e-4, "patch_position": [5e-5, -1e-4], "patch_pitch": 3e-4}
    read = solver.solve(BALL | {"force": [1.0, 2.0], "body": BODY} | patch)
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
