"""The scattered engine against scikit-learn used by hand, and its refusals."""

import re
import warnings
from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from surrogate import Input, ScatterGP
from surrogate.gp.scattergp import REACH, KernelName
from tests.surrogate.dense import stationary

Array = NDArray[np.float64]
INPUTS = (Input("x", -1.0, 1.0, units="m"), Input("y", 1.0, 100.0, "log"))


def cases(count: int, seed: int = 0) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-1, 1, count), 10 ** rng.uniform(0, 2, count)
    return xr.Dataset(
        {
            "x": ("case", x),
            "y": ("case", y),
            "f": ("case", np.sin(2 * x) + np.log(y), {"units": "K"}),
            "g": ("case", 50 + np.sin(3 * x * np.log(y) / 5)),
        }
    )


def radial(kernel: str, u: Array, v: Array) -> Array:
    """Correlation of points in several coordinates: that of a single one, at the distance."""
    r = np.sqrt(((u[:, None] - v) ** 2).sum(axis=2))
    return stationary(kernel, 1.0)(np.zeros(1), r.ravel()).reshape(r.shape)


@pytest.mark.parametrize("kernel", ["rbf", "matern32", "matern52"])
def test_the_variance_of_a_derivative_is_that_of_a_dense_difference_quotient(kernel: KernelName) -> None:
    data, held, step = cases(40), cases(10, seed=1), 1e-3
    model = ScatterGP(kernel, INPUTS, nugget=1e-2).fit(data)
    slopes = model.gradient(held[["x", "y"]], return_std=True)
    t = np.stack([input_.to_unit(data[input_.name]) for input_ in INPUTS], axis=1) / REACH
    points = np.stack([input_.to_unit(held[input_.name]) for input_ in INPUTS], axis=1)
    for p, name in enumerate(("f", "g")):
        theta = np.exp(model.regressors_[p].kernel_.theta)
        factor = cho_factor(theta[0] * radial(kernel, t / theta[1:], t / theta[1:]) + 1e-2 * np.eye(len(t)))
        for k, input_ in enumerate(INPUTS):
            ends = np.concatenate([points + step * np.eye(2)[k], points - step * np.eye(2)[k]]) / REACH / theta[1:]
            cross = theta[0] * radial(kernel, ends, t / theta[1:])
            C = theta[0] * radial(kernel, ends, ends) - cross @ cho_solve(factor, cross.T)
            want = (np.diag(C)[:10] + np.diag(C)[10:] - 2 * np.diag(C[:10, 10:])) / (2 * step) ** 2
            std = slopes[f"{name}_std"].sel(input=input_.name).values / input_.unit_slope(held[input_.name].values)
            size = data[name].values.std() ** 2
            np.testing.assert_allclose(
                std**2, size * want, rtol=2e-2 if kernel == "matern32" else 1e-3, atol=1e-6 * size
            )


@pytest.mark.parametrize("kernel", ["rbf", "matern32", "matern52"])
def test_prediction_is_that_of_a_dense_process(kernel: KernelName) -> None:
    data = cases(40)
    model = ScatterGP(kernel, INPUTS, nugget=1e-4).fit(data)
    held = cases(25, seed=1)
    answer = model.predict(held[["x", "y"]])
    t = np.stack([input_.to_unit(data[input_.name]) for input_ in INPUTS], axis=1) / REACH
    points = np.stack([input_.to_unit(held[input_.name]) for input_ in INPUTS], axis=1)
    for p, name in enumerate(("f", "g")):
        theta = np.exp(model.regressors_[p].kernel_.theta)
        a, b = t / theta[1:], points / REACH / theta[1:]
        values = data[name].values
        offset, scale = values.mean(), values.std()
        factor = cho_factor(theta[0] * radial(kernel, a, a) + 1e-4 * np.eye(len(a)))
        cross = theta[0] * radial(kernel, b, a)
        mean = offset + scale * cross @ cho_solve(factor, (values - offset) / scale)
        variance = theta[0] - np.einsum("ij,ji->i", cross, cho_solve(factor, cross.T))
        np.testing.assert_allclose(answer[name], mean, rtol=0, atol=1e-8 * np.ptp(values))
        np.testing.assert_allclose(
            answer[f"{name}_std"] ** 2, scale**2 * variance, rtol=0, atol=1e-9 * scale**2 * theta[0]
        )
    assert answer["f"].attrs["units"] == "K"


def test_it_learns_smooth_functions_and_reads_roles_off_the_outputs() -> None:
    model = ScatterGP("rbf", outputs=["f", "g"]).fit(cases(60))
    assert list(model.box) == ["x", "y"]
    inside = cases(60).isel(case=slice(30))
    assert model.score(inside) > 0.999999


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
    (1, lambda t: np.sin(3 * t[:, 0])),
    (1, lambda t: 1 / (1 + 4 * t[:, 0] ** 2)),
    (2, lambda t: np.sin(3 * t[:, 0]) + t[:, 1] ** 2),
    (2, lambda t: np.exp(t[:, 0]) * np.cos(2 * t[:, 1])),
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
        for count in (20, 40, 60):
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


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda d: d.drop_vars("y"), "'y' is not in the data set"),
        (lambda d: d.assign(f=d.f.where(d.x < 0.5)), "'f' is not finite in"),
        (lambda d: d.assign(x=d.x * 10), "outside its range [-1, 1] m"),
        (lambda d: d.assign(f=d.f.expand_dims(t=2)), "'f' must be numbers over one dimension"),
        (lambda d: d.assign(f=("other", np.ones(3))), "'f' is over 'other'"),
    ],
)
def test_bad_cases_are_refused_in_one_line(change: object, says: str) -> None:
    assert callable(change)
    with pytest.raises(ValueError, match=re.escape(says)) as caught:
        ScatterGP(inputs=INPUTS).fit(change(cases(10)))
    assert "\n" not in str(caught.value)


def test_roles_must_be_told() -> None:
    with pytest.raises(ValueError, match="give inputs="):
        ScatterGP().fit(cases(10))
