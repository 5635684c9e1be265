"""Films against Abel's integral equation, published values, limits, and a film of its base's own material."""

from functools import cache
from itertools import product

import numpy as np
import pytest

from solver.arrays import Array
from solver.line.powerlaw import constants_of
from solver.line.windows import Coat, Kind
from solver.point.profile import Shape
from solver.point.quantities import quantities
from solver.point.table import PointKind, PointWindow
from solver.stack.reflection import waves
from solver.stack.wavenumbers import strip, wavenumbers
from tests.solver.point.points import BTO, CFO, FIBROUS, STEEL, film, of_coats, on_film

BONDED = film(FIBROUS, CFO, electric="bonded")
TWO_LAYERS = of_coats((Coat(constants_of(BTO), 1.0, "grounded"), Coat(constants_of(CFO), 0.4)), STEEL)


@cache
def by_abel(kind: Kind, a: float, exponent: float, points: int = 200) -> tuple[Array, Array]:
    """Loads and edge strengths of u0 and of (r/a)^e, by N pi/2 f + int K f = G and Gauss's rule; (3, 4) each.

    With t(k) = int_0^a f(s) cos(ks) ds, Abel's transform of the displacement is int Y t(k) cos(kx) dk. Neither the
    functions nor the test of the solver are used; its multiplier is, which the plane's tests know.
    """
    stack = kind.stack()
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
@pytest.mark.parametrize("kind", [film(BTO), film(FIBROUS, STEEL), BONDED, TWO_LAYERS], ids="abcd")
@pytest.mark.parametrize(("a", "exponent"), list(product([0.01, 0.7, 4.0, 9.5], [2.0, 1.0, 0.0])))
def test_loads_and_edges_are_those_of_abel_s_equation(kind: Kind, a: float, exponent: float) -> None:
    point_kind = PointKind(kind, (True, True), Shape(exponent))
    window = PointWindow(point_kind, int(np.floor(2 * np.log10(a))))
    stiffness = point_kind.stiffness(window.read(np.array([np.log(a)])))
    loads, edges = by_abel(kind, a, exponent)
    for ours, exact in ((a * stiffness.loads[0], loads), (stiffness.edges[0], edges)):
        size = np.max(np.abs(exact), 0)
        np.testing.assert_allclose(ours / size, exact / size, atol=1e-9 if exponent == 1.0 else 1e-11)


def test_figures_of_the_theory() -> None:
    radii = np.array([0.2, 1.0, 5.0])
    kind = PointKind(film(BTO), (True, True), Shape(2.0))
    forces = [1.728509e11, 2.154751e11, 6.906319e11]
    pressed = on_film(kind.film, 1.0, 2.0, 0.5, forces * radii**3)
    np.testing.assert_allclose(pressed.grounded.radius, radii, rtol=3e-7)
    np.testing.assert_allclose(
        quantities(pressed)["charge_per_force"], [162.6588e-12, 142.2051e-12, 119.1587e-12], rtol=4e-7
    )
    np.testing.assert_allclose(
        -pressed.grounded.displacement[:, 0] / radii**2, [0.888477, 0.646322, 0.524082], rtol=1e-6
    )
