"""The correction of the mean: what it can represent it finds, and what it leaves of a case is what a refit leaves."""

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval

from surrogate import GridGP
from surrogate.face import model as face_model
from surrogate.gp import correction, imputation
from surrogate.gp.correction import correct, degrees
from surrogate.gp.factors import Factor
from surrogate.use.validation import validate
from tests.surrogate import functions

COUNTS = (16, 6, 5, 6, 3)


@pytest.mark.parametrize("weighted", [False, True])
def test_the_remainder_of_a_case_is_that_of_a_fit_to_the_others(
    weighted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(1)
    levels, rho = (7, 5), (0.2, 0.1)
    t, scale = rng.uniform(-1, 1, (2, 150)), rng.uniform(0.1, 3, 150)
    error = (np.sin(9 * t[0]) * np.exp(t[1]))[None]
    monkeypatch.setattr(correction, "LEAST_GAIN", 0.0 if weighted else np.inf)
    monkeypatch.setattr(correction, "_rough_scale", lambda left, t: scale)
    groups = np.concatenate([np.arange(100), np.full(20, 100), np.full(30, 101)])
    correction_, left = correct(error, t, levels, rho, groups)
    assert correction_ is not None
    terms = np.stack(
        [
            chebval(t[f], np.eye(n + 1)[n])
            * np.prod([chebval(x, np.eye(a + 1)[a]) for x, a in zip(t, row, strict=True)], 0)
            for f, n in enumerate(levels)
            for row in correction_.indices
        ],
        axis=1,
    )
    root = scale**-0.25 if weighted else np.ones(150)
    for case in (0, 17, 149):
        others = groups != groups[case]
        fitted = np.linalg.lstsq(terms[others] * root[others, None], (error[0] * root)[others], rcond=1e-12)[0]
        assert left[0, case] == pytest.approx(error[0, case] - terms[case] @ fitted, rel=1e-6)


def test_cases_beyond_the_most_are_held_out_from_the_regression(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(2)
    t = rng.uniform(-1, 1, (2, 500))
    error = np.stack([np.sin(9 * t[0]) * np.exp(t[1]), np.cos(7 * t[0] * t[1])])
    indices = degrees((0.2, 0.1), 500)
    assert indices is not None
    monkeypatch.setattr(correction, "MOST_CASES", 300)
    monkeypatch.setattr(face_model, "BLOCK", 64)
    correction_, left = correct(error, t, (7, 5), (0.2, 0.1), np.arange(500))
    assert correction_ is not None
    np.testing.assert_allclose(left[:, 300:], (error - correction_.values(t))[:, 300:], rtol=0, atol=1e-12)
    assert left.shape == error.shape


def test_an_error_that_no_term_explains_leaves_the_mean_alone() -> None:
    rng = np.random.default_rng(3)
    error = rng.standard_normal((2, 400))
    correction_, left = correct(error, rng.uniform(-1, 1, (2, 400)), (7, 5), (0.2, 0.1), np.arange(400))
    assert correction_ is not None
    assert not correction_.coefficients.any()
    np.testing.assert_array_equal(left, error)


def test_a_corrected_mean_is_far_better_on_fresh_cases_and_in_its_gradient() -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial(COUNTS))
    model.calibrate(functions.scattered(2000, seed=1))
    fresh = functions.scattered(2000, seed=2)
    table = validate(model, fresh, None).sel(output=["near_pole", "smooth", "ratio", "no_bias"])
    assert bool((table["rmse"] < 0.3 * table["raw_rmse"]).all())
    assert float((table["rmse"] / table["raw_rmse"]).median()) < 0.1
    points, true = functions.true_slopes(fresh[list(model.box)].isel(case=slice(200)), functions.INPUTS[0])
    plain, corrected = model.uncalibrated().gradient(points), model.gradient(points)
    for name in ("near_pole", "no_bias"):
        slopes = (gradient[name].sel(input=functions.INPUTS[0].name) for gradient in (plain, corrected))
        before, after = (float(np.abs(slope - true[name]).max()) for slope in slopes)
        assert after < 0.5 * before


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
