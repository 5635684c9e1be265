"""The scattered engine against scikit-learn used by hand, and its refusals."""

import warnings
from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from surrogate import Input, ScatterGP
from surrogate.gp import scattergp
from surrogate.gp.scattergp import DEGREE, REACH
from tests.refusals import assert_refused
from tests.surrogate import functions

Array = NDArray[np.float64]
INPUTS = (Input("x", -1.0, 1.0, units="m"), Input("y", 1.0, 100.0, "log"))


def cases(count: int, seed: int = 0) -> xr.Dataset:
    data = functions.drawn(INPUTS, count, seed)
    x, y = data["x"].values, data["y"].values
    f, g = np.sin(2 * x) + np.log(y), 50 + np.sin(3 * x * np.log(y) / 5)
    return data.assign(f=("case", f, {"units": "K"}), g=("case", g))


def correlation(theta: Array, a: Array, b: Array) -> Array:
    """The kernel of points (n, 2) and (m, 2) by its sum, of parameters (variance, two of T_1, two decays, noise)."""
    kernel = np.full((len(a), len(b)), theta[0])
    for x, y, first, rho in zip(a.T, b.T, theta[1:3], theta[3:5], strict=True):
        weights = np.append(1.0, first * rho ** np.arange(DEGREE))
        kernel *= (chebvander(x, DEGREE) * weights) @ chebvander(y, DEGREE).T
    return kernel


@pytest.fixture(scope="module")
def model() -> ScatterGP:
    return ScatterGP(INPUTS, nugget=1e-4).fit(cases(40))


def dense_posterior(theta: Array, t: Array, values: Array, points: Array) -> tuple[Array, Array]:
    """Mean and covariance of a function without noise at points (m, 2), given values (n,) at t (n, 2)."""
    K = correlation(theta, t, t) + (1e-4 + theta[-1]) * np.eye(len(t))
    cross = correlation(theta, points, t)
    weights = np.linalg.solve(K, cross.T)
    return weights.T @ values, correlation(theta, points, points) - cross @ weights


def test_predictions_and_variances_of_derivatives_are_those_of_a_dense_process(model: ScatterGP) -> None:
    data, held, step = cases(40), cases(25, seed=1), 1e-3
    answer, slopes = model.predict(held[["x", "y"]]), model.gradient(held[["x", "y"]], return_std=True)
    t = np.stack([input_.to_unit(data[input_.name]) for input_ in INPUTS], axis=1) / REACH
    points = np.stack([input_.to_unit(held[input_.name]) for input_ in INPUTS], axis=1)
    for p, name in enumerate(("f", "g")):
        theta = np.exp(model.regressors_[p].kernel_.theta)
        values = data[name].values
        offset, scale = values.mean(), values.std()
        mean, C = dense_posterior(theta, t, (values - offset) / scale, points / REACH)
        np.testing.assert_allclose(answer[name], offset + scale * mean, rtol=0, atol=1e-8 * np.ptp(values))
        variance = scale**2 * (np.diag(C) + theta[-1])
        widened = answer[f"{name}_std"].values ** 2 / variance  # by the same factor everywhere
        np.testing.assert_allclose(widened, widened[0], rtol=1e-5)
        assert widened[0] > 1 - 1e-5
        for k, input_ in enumerate(INPUTS):
            ends = np.concatenate([points + step * np.eye(2)[k], points - step * np.eye(2)[k]]) / REACH
            _, C = dense_posterior(theta, t, values, ends)
            difference = np.diag(C)[:25] + np.diag(C)[25:] - 2 * np.diag(C[:25, 25:])
            want = scale**2 * widened[0] * difference / (2 * step) ** 2
            std = slopes[f"{name}_std"].sel(input=input_.name).values / input_.unit_slope(held[input_.name].values)
            np.testing.assert_allclose(std**2, want, rtol=1e-3, atol=1e-6 * scale**2)
    assert answer["f"].attrs["units"] == "K"


def test_it_learns_smooth_functions_and_reads_roles_off_the_outputs() -> None:
    assert_refused(ValueError, "give inputs=", ScatterGP().fit, cases(10))
    model = ScatterGP(outputs=["f", "g"]).fit(cases(60))
    assert list(model.box) == ["x", "y"]
    inside = cases(60).isel(case=slice(30))
    assert model.score(inside) > 0.9999


def test_many_cases_are_answered_by_the_kernel_of_some(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scattergp, "SUBSET", 100)
    data = cases(400)
    noisy = data.assign(f=data["f"] + 0.05 * np.random.default_rng(5).normal(size=400), c=("case", np.full(400, 3.0)))
    model, fresh = ScatterGP(INPUTS).fit(noisy), cases(500, seed=6)
    answer = model.predict(fresh[["x", "y"]])
    assert float(np.sqrt(((answer["f"] - fresh["f"]) ** 2).mean())) < 0.02  # below the noise
    np.testing.assert_allclose(answer["f_std"], 0.05, rtol=0.3)
    np.testing.assert_allclose(answer["c"], 3.0, rtol=1e-12)
    monkeypatch.setattr(scattergp, "MOST", 399)
    assert_refused(ValueError, "400 scattered cases are more than 399", ScatterGP(INPUTS).fit, noisy)


def test_few_cases_without_noise_err_no_more_than_by_scikit_learn_s_process() -> None:
    def truth(t: Array) -> Array:
        return np.asarray(np.log(1.08 + t[:, 0]) * (1 + 0.5 * t[:, 1]) + np.exp(t[:, 1] * t[:, 2]))

    t, fresh = np.random.default_rng(0).uniform(-1, 1, (80, 3)), np.random.default_rng(1).uniform(-1, 1, (500, 3))
    box = [Input(name, -1.0, 1.0) for name in "abc"]
    data = xr.Dataset(
        {**{input_.name: ("case", row) for input_, row in zip(box, t.T, strict=True)}, "f": ("case", truth(t))}
    )
    ours = ScatterGP(inputs=box).fit(data).predict_array(fresh)[:, 0]
    kernel = ConstantKernel(1.0, (1e-4, 1e5)) * RBF(np.ones(3), (1e-2, 1e3))
    with warnings.catch_warnings():  # of a search that ends at the rounding of its target
        warnings.simplefilter("ignore", ConvergenceWarning)
        theirs = GaussianProcessRegressor(kernel, alpha=1e-10, normalize_y=True).fit(t, truth(t)).predict(fresh)
    errors = [float(np.abs(mean - truth(fresh)).max()) for mean in (ours, theirs)]
    assert errors[0] < errors[1]


FUNCTIONS: list[tuple[int, Callable[[Array], Array]]] = [
    (1, lambda t: 1 / (1 + 4 * t[:, 0] ** 2)),
    (2, lambda t: np.sin(3 * t[:, 0]) + t[:, 1] ** 2),
    (2, lambda t: np.abs(t[:, 0] - 0.2) * t[:, 1]),
    (3, lambda t: np.exp(t[:, 0]) * np.cos(2 * t[:, 1]) * (1 + 0.3 * t[:, 2])),
    (3, lambda t: 1 / (2.5 + t[:, 0] + 0.8 * t[:, 1] + 0.5 * t[:, 2])),
]


def held(model: ScatterGP, truth: Callable[[Array], Array], points: Array) -> tuple[float, float]:
    """Share of 95 % intervals that hold the truth, and the median standard deviation."""
    mean, std = model.predict_array(points, return_std=True, extrapolate=True)
    return float((np.abs(mean[:, 0] - truth(points)) <= 1.96 * std[:, 0]).mean()), float(np.median(std))


def test_intervals_of_few_cases_hold_inside_and_grow_outside() -> None:
    inside, outside = [], []
    for number, (d, truth) in enumerate(FUNCTIONS):
        random, box = np.random.default_rng(number), [Input(name, -1.0, 1.0) for name in "abc"[:d]]
        points, beyond = random.uniform(-1, 1, (300, d)), random.uniform(-1.2, 1.2, (2000, d))
        beyond = beyond[np.abs(beyond).max(axis=1) > 1]
        for count in (20, 60):
            t = random.uniform(-1, 1, (count, d))
            data = {input_.name: ("case", column) for input_, column in zip(box, t.T, strict=True)}
            model = ScatterGP(inputs=box).fit(xr.Dataset(data | {"f": ("case", truth(t))}))
            inside.append(held(model, truth, points)[0])
            share, near = held(model, truth, beyond)
            outside.append(share)
            far = held(model, truth, 2 * beyond)[1]
            assert far > near > held(model, truth, points)[1]
    # 0.26 to 0.95 inside and 0.05 outside were the fault
    assert np.mean(inside) > 0.88
    assert np.mean(outside) > 0.85
    assert min(outside) > 0.4
