"""Products of kernels on a grid: tensors of several outputs, the modes that are kept, and parameters out of range."""

import numpy as np
import pytest

from surrogate.gp.factors import Factor, Features
from surrogate.gp.productkernel import joined, significant, standardised, unit_variance


def test_outputs_are_joined_with_the_largest_factor_first() -> None:
    small, large = np.ones((2, 3)), 2 * np.ones((1, 4))
    order, tensor = joined([small, large])
    assert (order, tensor.shape) == ((1, 0), (4, 2, 2))
    assert tensor[:3, :, 0].tolist() == small.T.tolist()
    assert (tensor[3, :, 0].tolist(), tensor[:, 1, 1].tolist()) == ([0, 0], [0] * 4)


def test_coefficients_are_those_of_the_standardised_output() -> None:
    values, gram = np.array([1.0, 2.0, 6.0]), np.empty((3, 3))
    coefficients, offset, scale = standardised(values, [np.eye(3)], [gram])
    np.testing.assert_allclose(offset + scale * coefficients, values)
    np.testing.assert_allclose(gram, np.outer(coefficients, coefficients))
    assert significant(np.array([3.0, 1e-9]), [np.diag([9.0, 1e-18])], 1e-12).tolist() == [3.0]


def test_what_two_factors_leave_is_one_minus_what_both_know() -> None:
    known, unknown = np.array([0.7, 0.2]), np.array([0.3, 0.5])
    features = [Features(np.zeros((1, 2)), known + unknown, unknown)] * 2
    left = unit_variance(np.ones((2, 1)), features, np.ones((2, 1)))
    both = known + unknown + 1
    np.testing.assert_allclose(left[0], both**2 - (both - unknown) ** 2, rtol=1e-14)


@pytest.mark.parametrize("rho", [0.0, 1.0, -0.5])
def test_a_decay_out_of_range_is_refused(rho: float) -> None:
    with pytest.raises(ValueError, match="rho must lie between 0 and 1"):
        Factor(4, rho)
