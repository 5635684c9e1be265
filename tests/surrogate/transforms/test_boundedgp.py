"""Outputs with bounds: means, intervals, quantiles and draws stay within them and hold."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.special import expit

from approximation.arrays import Array
from surrogate import BoundedGP, FactorialRegressor, GridGP, Input, load, save

INPUTS = (Input("x", -1.0, 1.0), Input("y", 0.5, 2.0))
BOUNDS = {"share": (0.0, 1.0), "size": (0.0, np.inf), "below": (-np.inf, 3.0)}


def truth(x: Array, y: Array) -> dict[str, Array]:
    exponent = 9 * x * y + 1 / (x + 1.2)
    return {
        "share": expit(exponent),
        "size": np.exp(-exponent),
        "below": 3 - np.exp(np.sin(3 * x) * 4 * y),
        "free": x * y,
    }


def cases(count: int, seed: int) -> xr.Dataset:
    random = np.random.default_rng(seed)
    x, y = random.uniform(-1, 1, count), random.uniform(0.5, 2, count)
    return xr.Dataset({name: ("case", column) for name, column in {"x": x, "y": y, **truth(x, y)}.items()})


def grid() -> xr.Dataset:
    x, y = INPUTS[0].levels(7), INPUTS[1].levels(4)
    return xr.Dataset({name: (("x", "y"), values) for name, values in truth(x[:, None], y).items()}, {"x": x, "y": y})


@pytest.fixture(scope="module")
def model() -> BoundedGP:
    return BoundedGP(GridGP(inputs=INPUTS), BOUNDS).fit(grid()).calibrate(cases(1500, 1))


def test_all_that_is_said_stays_within_the_bounds_and_holds(model: BoundedGP) -> None:
    fresh = cases(1000, 2)
    points = fresh[["x", "y"]]
    X = np.stack([fresh["x"], fresh["y"]], axis=1)
    ends = model.interval(points, 0.95)
    lower, upper = model.interval_array(X, 0.95)
    drawn, wide = model.sample(points, 20, 0, together=False), model.interval(points, 0.99)
    for k, name in enumerate(model.outputs_):
        low, high = BOUNDS.get(name, (-np.inf, np.inf))
        mean, true = model.predict(points)[name], fresh[name]
        for bounded in (mean, wide[f"{name}_lower"], wide[f"{name}_upper"], drawn[name]):
            assert ((low <= bounded) & (bounded <= high)).all()
        held = float(((ends[f"{name}_lower"] <= true) & (true <= ends[f"{name}_upper"])).mean())
        assert held == pytest.approx(0.955, abs=4 * np.sqrt(0.05 * 0.95 / 1000) + 0.01)
        np.testing.assert_allclose(lower[:, k], ends[f"{name}_lower"], rtol=1e-12)
        np.testing.assert_allclose(upper[:, k], ends[f"{name}_upper"], rtol=1e-12)
        np.testing.assert_allclose(model.quantile(points, 0.025)[name], ends[f"{name}_lower"], rtol=1e-12)


def test_a_model_from_a_file_is_not_fitted_again(model: BoundedGP, tmp_path: Path) -> None:
    save(model, tmp_path / "a.nc")
    with pytest.raises(ValueError, match="a model from a file is not fitted again"):
        load(tmp_path / "a.nc").fit(cases(3, 0))


def test_values_and_bounds_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="bounds of 'share': 1 must be less than 0"):
        BoundedGP(GridGP(), {"share": (1, 0)})
    x, y = INPUTS[0].levels(4), INPUTS[1].levels(4)
    grid = xr.Dataset({"share": (("x", "y"), np.full((4, 4), 1.5))}, {"x": x, "y": y})
    with pytest.raises(ValueError, match=re.escape("output 'share' is 1.5, which is not between 0 and 1")):
        BoundedGP(GridGP(inputs=INPUTS), {"share": (0, 1)}).fit(grid)
    with pytest.raises(ValueError, match="bounds of 'none', which is not in the data set"):
        BoundedGP(GridGP(inputs=INPUTS), {"none": (0, 1)}).fit(grid)


@pytest.mark.parametrize("count", [25, 30])
def test_the_estimator_keeps_bounds(count: int) -> None:
    random = np.random.default_rng(0)
    X = random.uniform(-1, 1, (count, 1))
    y = expit(8 * X[:, 0])
    model = FactorialRegressor("scattered", bounds=(0, 1)).fit(X, y)
    points = np.linspace(-1, 1, 200)[:, None]
    mean, std = model.predict(points, return_std=True)
    assert ((mean > 0) & (mean < 1)).all()
    assert (std >= 0).all()
    np.testing.assert_allclose(mean, expit(8 * points[:, 0]), atol=1e-2)
    with pytest.raises(ValueError, match="output 'y' is 0, which is not between 0 and 1"):
        FactorialRegressor(bounds=(0, 1)).fit(X, np.zeros(count))
