"""Families of functions with known singularities: their kinks and predicted errors."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebgauss, chebvander
from numpy.typing import NDArray

from surrogate.levels.decay import Decay, decay_of

Array = NDArray[np.float64]
Family = Callable[[Array, float], Array]


def judged(family: Family, count: int) -> Decay:
    x = np.sort(chebgauss(count)[0])
    values = np.stack([family(x, a) for a in np.linspace(-0.9, 0.9, 9)])
    coefficients = np.abs(np.linalg.solve(chebvander(x, count - 1), values.T)).max(axis=1)
    return decay_of(coefficients / np.ptp(values))


KINKED: tuple[Family, ...] = (
    lambda x, a: np.abs(x - 0.6 * a) * (1 + 0.3 * x),
    lambda x, a: np.maximum(np.sin(3 * x + a), np.cos(2 * x)),
    lambda x, a: np.maximum(x - 0.5 * a, 0) ** 2,
)
ANALYTIC: tuple[Family, ...] = (
    lambda x, a: np.exp(2 * a * x), lambda x, a: np.exp(0.7 * (x + a)) ** 0.3, lambda x, a: 1 / (x + 1.1 + 0.05 * a),
    lambda x, a: np.sin(4 * x + a), lambda x, a: np.log(x + 1.05), lambda x, a: np.sqrt(x + 1.05 + 0.01 * a),
)  # fmt: skip


@pytest.mark.parametrize("count", [9, 17, 40])
def test_kinks_are_found_and_analytic_functions_are_not_taken_for_kinked(count: int) -> None:
    assert [judged(family, count).algebraic for family in (*KINKED, *ANALYTIC)] == [True] * 3 + [False] * 6


@pytest.mark.parametrize("count", [9, 12, 17, 40])
@pytest.mark.parametrize(
    "family",
    [
        lambda x, a: 1 / (x + 1.1),
        lambda x, a: np.exp(2 * x),
        lambda x, a: np.cosh(2 * x),
        lambda x, a: np.sinh(2 * x),
        lambda x, a: 1 / (1 + 4 * x**2),
        lambda x, a: np.log(x + 1.2),
    ],
)
def test_the_predicted_error_covers_that_of_interpolation_without_waste(family: Family, count: int) -> None:
    decay = judged(family, count)
    fine = np.linspace(-1, 1, 2001)
    for levels in (6, 10, 15, 22, 30):
        x = np.sort(chebgauss(levels)[0])
        weights = np.linalg.solve(chebvander(x, levels - 1), family(x, 0.0))
        error = np.abs(chebvander(fine, levels - 1) @ weights - family(fine, 0.0)).max() / np.ptp(family(fine, 0.0))
        if error > 1e-11 and levels <= 2 * count:
            assert error <= decay.error(levels), levels
        if levels <= count and error > 1e-10:
            assert decay.error(levels) <= 50 * error, levels


def test_affine_functions_are_found_by_their_noise_alone() -> None:
    assert judged(lambda x, a: 3 + a * x, 3).affine
    assert judged(lambda x, a: 3 + a * x, 9).affine
    assert judged(lambda x, a: np.exp(x), 2).affine
    assert not judged(lambda x, a: 3 + a * x + 1e-9 * x**2, 3).affine
    assert judged(lambda x, a: 3 + a * x, 3).error(2) == 0
