"""Integrals of kernels against charges beside a contact: one rule for all targets against quadrature that adapts."""

import numpy as np
import pytest
from scipy.integrate import quad

from solver.gap.densities import Densities
from solver.gap.grid import Grid, Rules, spans
from solver.line.kernel import kernel
from solver.stack.layers import Stack
from tests.solver.gap.airy import PZT, on_steel

GRID = Grid.up_to(200.0)
CHANNEL = 3  # K of (phi, phi)


def _adaptive(h: float, target: float, stack: Stack, reach: float) -> float:
    """Adaptive integral of the density exp(-theta) over the finite panels."""
    wide = kernel(stack, reach, by_distance=True)
    mix = np.eye(19)[:, CHANNEL : CHANNEL + 1]

    def integrand(theta: float) -> float:
        distance = np.array([h * (target - np.cosh(theta))])
        return float(wide.at(distance, mix)[0, 0] * np.exp(-theta) * np.sinh(theta))

    near = float(np.arccosh(max(target, 1.0)))
    return sum(
        quad(integrand, low, high, epsabs=0, epsrel=1e-11, limit=400, points=[near] if low < near < high else None)[0]
        for low, high in zip(GRID.ends[:-1], GRID.ends[1:], strict=True)
    )


@pytest.mark.parametrize(("h", "target"), [(0.1, 1.02), (0.1, -150.0), (20.0, 1.3), (20.0, -0.3)])
def test_rules_and_pieces_are_quadrature_that_adapts(h: float, target: float) -> None:
    """1e-9: densities are of degree 6 on a panel, exp(-theta) to 1e-9 on the widest."""
    stack = on_steel(PZT)
    reach = 1e4 * kernel(stack, 1.0).width
    wide = kernel(stack, reach, by_distance=True)
    integrals = Densities(GRID, wide).integrals(h, np.array([target]), np.eye(19)[:, CHANNEL : CHANNEL + 1])
    finite = GRID.slice(GRID.panels - 1).start
    ours = float(integrals[0, 0, :finite] @ np.exp(-GRID.theta[:finite]))
    assert ours == pytest.approx(_adaptive(h, target, stack, reach), rel=1e-8)


def test_singularity_next_to_an_interval_is_seen() -> None:
    start, stop = np.array([0.0]), np.array([1.0])
    nodes = spans(start, stop)[0]
    rule = Rules(np.array([0]), start, stop, nodes, np.ones((1, nodes.shape[1], 1)))
    assert rule.rough(np.array([0.5 + 0.3j]))[0]
    assert not rule.rough(np.array([0.5 + 1.5j]))[0]


def test_long_distances_do_not_see_where_the_spectrum_ends() -> None:
    """An octave far away, its spectrum ended smoothly, and the same from zero on, where it is not: to rounding."""
    stack = on_steel(PZT)
    far, whole = (kernel(stack, 600.0, by_distance=separate) for separate in (True, False))
    x = np.geomspace(60.0, 599.0, 60)
    scale = np.max(np.abs(whole.positive.series[:, 0]), 0)
    np.testing.assert_allclose(far.at(x), whole.at(x), rtol=0, atol=1e-12 * np.max(scale))
