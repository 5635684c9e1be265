"""Materials in Fourier space and the recursion of stacks against closed forms and refusals."""

import numpy as np
import pytest

import solver
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves

K = np.geomspace(0.01, 10.0, 25)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_isotropic_layer_on_a_rigid_base_is_the_closed_multiplier(poisson: float) -> None:
    stack = Stack((Layer(solver.Material.isotropic(7e10, poisson), 1.0),))
    compliance = stack.media[0].compliance[1, 1]
    computed = 1 + waves(stack, K)[0].difference[:, 1, 1] / compliance
    kappa, u = 3 - 4 * poisson, K
    exact = (2 * kappa * np.sinh(2 * u) - 4 * u) / (2 * kappa * np.cosh(2 * u) + 1 + kappa**2 + 4 * u**2)
    np.testing.assert_allclose(computed, exact, rtol=1e-11)


def test_stacks_are_equal_by_their_content() -> None:
    film = Stack([Layer("PZT-4", "20 um", "grounded")], "steel")
    assert film == Stack([Layer(solver.find("PZT-4"), 20e-6, "grounded")], solver.find("steel"))
    others = [
        Stack([Layer("PZT-4", "21 um", "grounded")], "steel"),
        Stack([Layer("PZT-4", "20 um", "bonded")], "steel"),
        Stack([Layer("PZT-4", "20 um", "grounded")]),
    ]
    assert len({film, *others}) == 1 + len(others)
