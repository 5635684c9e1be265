"""Cases that a factorial lacks are what its process expects."""

import numpy as np
import pytest

from surrogate.gp import imputation
from surrogate.gp.factors import Factor


def test_factors_that_do_not_tell_what_is_missing_are_filled_all_along() -> None:
    """The same as of the whole grid with the same kernel, where the hole is small enough to be filled in at once."""
    random = np.random.default_rng(3)
    factors = [Factor(n, 0.3) for n in (5, 4, 6)]
    values = random.normal(size=(5, 4, 6, 2))
    holes = np.zeros((5, 4, 6), dtype=bool)
    holes[3:, :, 4:] = True
    result = imputation.expected(factors, values, holes)
    turned = imputation.expected(
        [factors[k] for k in (1, 0, 2)], values.transpose(1, 0, 2, 3), holes.transpose(1, 0, 2)
    )
    filled = np.zeros((5, 4, 6, 2))
    filled[holes] = result
    np.testing.assert_allclose(filled.transpose(1, 0, 2, 3)[holes.transpose(1, 0, 2)], turned, rtol=1e-9)
    # K^-1 y is zero there: by dense matrices, which share no code
    K = np.ones((1, 1))
    for n, factor in zip((5, 4, 6), factors, strict=True):
        T = np.cos(np.arange(2 * n) * np.arccos(factor.t)[:, None])
        K = np.kron(K, T @ np.diag([1.0, *(0.3 ** np.arange(1, 2 * n))]) @ T.T)
    whole = np.where(holes[..., None], filled, values).reshape(-1, 2)
    left = np.linalg.solve(K, whole)[holes.ravel()]
    assert np.abs(left).max() < 1e-6 * np.abs(np.linalg.solve(K, whole)).max()


def test_more_than_can_be_filled_in_is_refused() -> None:
    factors = [Factor(60, 0.3), Factor(60, 0.3)]
    holes = np.add.outer(np.arange(60), np.arange(60)) > 55
    with pytest.raises(ValueError, match=r"places of the factors .* at most 2000 are filled in"):
        imputation.expected(factors, np.zeros((60, 60, 1)), holes)
