"""Cases that a factorial lacks are what its process expects."""

import numpy as np
import pytest
import xarray as xr

from approximation.arrays import Array
from surrogate import GridGP, Input
from surrogate.gp import imputation
from surrogate.gp.factors import Factor


def smooth(a: Array, b: Array, c: Array) -> Array:
    return np.exp(0.6 * a + 0.4 * b) / (1.6 + 0.7 * c + 0.3 * a) + np.sin(1.2 * a * b)


def test_a_grid_without_a_corner_is_as_good_where_it_has_cases() -> None:
    """Oracle: the function itself. The bound of the whole grid's error holds beside the hole too, ten times of it."""
    inputs = [Input(name, -1, 1) for name in "abc"]
    levels = [input_.levels(count) for input_, count in zip(inputs, (12, 11, 10), strict=True)]
    axes = np.meshgrid(*levels, indexing="ij")
    holes = axes[0] + axes[1] + 0.3 * axes[2] > 1.25
    assert 0.13 < holes.mean() < 0.14
    exact = smooth(*axes)
    whole = xr.Dataset({"y": (("a", "b", "c"), exact)}, coords=dict(zip("abc", levels, strict=True)))
    lacking = xr.Dataset({"y": whole["y"].where(~holes)}, coords=whole.coords)
    model, best = imputation.fit(lambda: GridGP(inputs=inputs), lacking, holes), GridGP(inputs=inputs).fit(whole)
    nodes = np.stack([axis.ravel() for axis in axes], -1)
    size = np.ptp(exact)
    answer = model.predict_array(nodes)[:, 0].reshape(holes.shape)
    np.testing.assert_allclose(answer[~holes], exact[~holes], rtol=0, atol=1e-12 * size)  # it interpolates
    X = np.random.default_rng(0).uniform(-1, 1, (4000, 3))
    inside = X[:, 0] + X[:, 1] + 0.3 * X[:, 2] < 1.25
    errors = [np.abs(input_.predict_array(X)[:, 0] - smooth(*X.T))[inside] / size for input_ in (model, best)]
    assert errors[1].max() < 5e-6  # what 12 x 11 x 10 levels can tell
    assert errors[0].max() < 1.5 * errors[1].max()
    assert np.median(errors[0]) < 1.5 * np.median(errors[1])


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
