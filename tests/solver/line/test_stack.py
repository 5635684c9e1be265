"""Materials in Fourier space and the recursion of stacks against closed forms and refusals."""

import numpy as np
import pytest

import solver
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import sideways, waves
from tests.solver.line.films import BTO, FIBROUS

K = np.geomspace(0.01, 10.0, 25)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_isotropic_layer_on_a_rigid_base_is_the_closed_multiplier(poisson: float) -> None:
    stack = Stack((Layer(solver.Material.isotropic(7e10, poisson), 1.0),))
    compliance = stack.media[0].compliance[1, 1]
    computed = 1 + waves(stack, K)[0].difference[:, 1, 1] / compliance
    kappa, u = 3 - 4 * poisson, K
    exact = (2 * kappa * np.sinh(2 * u) - 4 * u) / (2 * kappa * np.cosh(2 * u) + 1 + kappa**2 + 4 * u**2)
    np.testing.assert_allclose(computed, exact, rtol=1e-11)


def test_insulated_base_sends_the_flux_sideways() -> None:
    stack = Stack((Layer(FIBROUS, 0.6, "bonded"), Layer(BTO, 0.4, magnetic="insulated")))
    k = np.array([1e-3, 1e-4])
    Y = stack.media[0].compliance[3, 3] + waves(stack, k)[0].difference[:, 3, 3]
    np.testing.assert_allclose(Y * k, sideways(stack), rtol=1e-5)
