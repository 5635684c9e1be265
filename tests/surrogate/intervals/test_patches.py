"""Boxes about cases that were asked for: intervals there are as narrow as errors allow, and those elsewhere stay."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from approximation.arrays import Array
from storage.netcdf import read_whole
from surrogate import GridGP, Input, load, save
from surrogate.data.points import EVEN
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.patches import Patches

INPUTS = (Input("x", 0, 1), Input("y", 1, 2))
AT, AROUND = np.array([[0.4], [-0.2]]), 0.08


def cases(t: Array, drawn: int = 1) -> xr.Dataset:
    points = {own.name: xr.DataArray(own.from_unit(row), dims="case") for own, row in zip(INPUTS, t, strict=True)}
    return outputs(points).assign_coords({EVEN: ("case", np.full(t.shape[1], drawn, np.int8))})


def outputs(points: dict[str, xr.DataArray]) -> xr.Dataset:
    x, y = points["x"], points["y"]
    return xr.Dataset({"near_pole": 1 / (1.15 - x + 0.2 * y), "wave": np.sin(5 * x * y), **points})


def fitted(drawn: int) -> GridGP:
    """Beside 600 even cases 200 about one place, which the calibration is told to be of one kind."""
    grid = {own.name: xr.DataArray(own.levels(6), dims=own.name) for own in INPUTS}
    model = GridGP(inputs=INPUTS).fit(outputs(grid).assign_coords(grid))
    even = np.random.default_rng(0).uniform(-1, 1, (2, 600))
    return model.calibrate(xr.concat([cases(even), cases(about(200, 1), drawn)], "case"))


def about(count: int, seed: int) -> Array:
    return AT + np.random.default_rng(seed).uniform(-AROUND, AROUND, (2, count))


@pytest.fixture(scope="module")
def patched() -> GridGP:
    return fitted(-1)


def told(model: GridGP, t: Array) -> tuple[Array, Array]:
    """Share of the true values that are held, and mean widths."""
    fresh = cases(t)
    lower, upper = model.interval_array(np.stack([fresh[own.name].values for own in INPUTS], -1))
    true = np.stack([fresh[name].values for name in model.outputs_], -1)
    return ((lower <= true) & (true <= upper)).mean(axis=0), (upper - lower).mean(axis=0)


def test_intervals_about_the_place_are_as_narrow_as_they_may_be(patched: GridGP) -> None:
    plain = fitted(0)
    held, width = told(patched, about(2000, 2))
    # of 200 cases the share that is held has a standard deviation of 0.015, that of 2,000 fresh ones 0.005
    assert ((held >= 0.90) & (held <= 0.995)).all()
    assert (width < 0.6 * told(plain, about(2000, 2))[1]).all()
    everywhere = np.random.default_rng(3).uniform(-1, 1, (2, 2000))
    held = told(patched, everywhere)[0]
    assert ((held >= 0.92) & (held <= 0.98)).all()


def test_a_patch_is_a_box_about_its_cases_and_elsewhere_nothing_is_added(patched: GridGP) -> None:
    patches = patches_of(patched)
    assert patches.low.shape == (1, 2)
    np.testing.assert_allclose(patches.low[0], AT[:, 0] - AROUND, atol=0.01)
    np.testing.assert_allclose(patches.high[0], AT[:, 0] + AROUND, atol=0.01)
    beyond = AT + np.array([[0.1, 0.0], [0.0, -0.1]])
    assert not patches.at(beyond).any()
    np.testing.assert_array_equal(patches.at(AT)[:, 0], patches.scale[0])


def test_few_cases_and_cases_far_apart_make_no_patch() -> None:
    numbers = np.arange(7)
    assert not len(Patches.about(about(7, 0), numbers, 2).low)
    apart = np.stack([np.linspace(-1, 1, 9), np.zeros(9)])
    assert not len(Patches.about(apart, np.arange(9), 2).low)
    # 30 cases at three places of a table tell as much as three
    assert not len(Patches.about(about(30, 0), np.arange(30) % 3, 2).low)


def test_where_patches_overlap_the_wider_interval_counts() -> None:
    low, high = np.array([[-1.0, -1.0], [-0.5, -0.5]]), np.array([[0.0, 0.0], [0.5, 0.5]])
    both = Patches(low, high, np.array([[-2.0, 1.0], [-1.0, -3.0]]))
    t = np.array([[-0.7, -0.2, 0.3, 0.8], [-0.7, -0.2, 0.3, 0.8]])
    np.testing.assert_array_equal(both.at(t), [[-2, -1, -1, 0], [1, 1, -3, 0]])


def test_a_point_alone_a_file_and_fewer_outputs_know_of_patches(patched: GridGP, tmp_path: Path) -> None:
    X = patched.physical(np.concatenate([about(4, 5), -about(4, 5)], axis=1))
    mean, std = patched.predict_array(X, return_std=True)
    alone = np.concatenate([patched.predict_array(x[None], return_std=True)[1] for x in X])
    np.testing.assert_allclose(alone, std, rtol=1e-9)
    np.testing.assert_allclose(patched.only(["wave"]).predict_array(X, return_std=True)[1][:, 0], std[:, 1], rtol=1e-9)
    save(patched, tmp_path / "model.nc")
    for own, kept in zip(load(tmp_path / "model.nc").predict_array(X, return_std=True), (mean, std), strict=True):
        np.testing.assert_array_equal(own, kept)
    stored = read_whole(tmp_path / "model.nc")
    wrong = stored.assign(calibration_patch_low=stored["calibration_patch_high"] + 1)
    with pytest.raises(ValueError, match="patches of the calibration do not fit"):
        Calibration.restore(wrong, 2, 2, 2)


def patches_of(model: GridGP) -> Patches:
    assert model.calibration_ is not None
    assert model.calibration_.patches is not None
    return model.calibration_.patches
