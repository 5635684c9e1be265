"""Kinks that are named: exact on both sides, intervals that hold, derivatives, files and what is refused."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import surrogate
from surrogate import GridGP, Input, SplitGP
from surrogate.use.sensitivity import sobol

X, Y = Input("x", 0.0, 1.0), Input("y", 0.1, 10.0, "log")


def bent(x: xr.DataArray, y: xr.DataArray) -> dict[str, xr.DataArray]:
    """A bend and a jump along x, a bend along y, each of what is no polynomial on either side."""
    smooth = np.exp(x) * np.log(y)
    return {"bend": abs(x - 0.37) * np.exp(0.5 * x) + smooth, "jump": (x > 0.37) * np.cos(x) + abs(np.log(y / 2)) * x}


def scattered(count: int, seed: int) -> xr.Dataset:
    random = np.random.default_rng(seed)
    u = random.uniform(-1, 1, (2, count))
    cases = xr.Dataset({one.name: ("case", one.from_unit(t)) for one, t in zip((X, Y), u, strict=True)})
    return cases.assign(bent(cases.x, cases.y))


def fitted(counts: dict[str, int]) -> SplitGP:
    model = SplitGP([X, Y], {"x": [0.37], "y": [2.0]})
    grid = xr.Dataset(coords=model.levels(counts))
    return model.fit(grid.assign(bent(grid.x, grid.y)))


def largest(model: surrogate.GaussianProcess, cases: xr.Dataset) -> dict[str, float]:
    mean = model.predict({"x": cases.x, "y": cases.y}, return_std=False)
    return {name: float(abs(mean[name] - cases[name]).max() / np.ptp(cases[name].values)) for name in ("bend", "jump")}


def test_a_kink_that_is_named_costs_no_digits() -> None:
    model, fresh = fitted({"x": 10, "y": 6}), scattered(2000, 1)
    assert (model.cases_, model.levels({"x": 10, "y": 6})["x"].size) == (20 * 12, 20)
    assert max(largest(model, fresh).values()) < 1e-11
    grid = xr.Dataset(coords={"x": X.levels(20), "y": Y.levels(12)})  # as many levels, not split
    whole = largest(GridGP(inputs=[X, Y]).fit(grid.assign(bent(grid.x, grid.y))), fresh)
    assert whole["bend"] > 1e-3
    assert whole["jump"] > 0.1


def test_held_out_cases_correct_every_side_and_intervals_hold() -> None:
    model, fresh = fitted({"x": 4, "y": 3}), scattered(3000, 2)
    before = largest(model, fresh)
    model.calibrate(scattered(3000, 3))
    assert all(after < 0.2 * before[name] for name, after in largest(model, fresh).items())
    ends = model.interval({"x": fresh.x, "y": fresh.y})
    for name in before:
        held = (ends[f"{name}_lower"] <= fresh[name]) & (fresh[name] <= ends[f"{name}_upper"])
        for side in (fresh.x < 0.37, fresh.x > 0.37, fresh.y < 2, fresh.y > 2):
            assert 0.92 < float(held.where(side, drop=True).mean()) < 0.98
    assert model.uncalibrated().calibration_ is None
    assert largest(model.uncalibrated(), fresh) == before


def test_derivatives_are_those_of_each_side() -> None:
    model = fitted({"x": 12, "y": 8})
    points = np.array([[0.2, 1.0], [0.9, 1.5], [0.6, 7.0]])
    found = model.gradient_array(points)
    for (x, y), slopes in zip(points, found, strict=True):
        side, above = np.sign(x - 0.37), np.sign(np.log(y / 2))
        bend = np.exp(0.5 * x) * (side + 0.5 * abs(x - 0.37)) + np.exp(x) * np.log(y)
        jump = -np.sin(x) * (side > 0) + abs(np.log(y / 2))
        np.testing.assert_allclose(slopes[:, 0], [bend, jump], rtol=1e-8)
        np.testing.assert_allclose(slopes[:, 1], [np.exp(x) / y, above * x / y], rtol=1e-8)
    model.calibrate(scattered(500, 4))
    assert (model.gradient({"x": 0.5, "y": 1.0}, return_std=True)["bend_std"].sel(input="x") > 0).all()


def test_files_and_parts_give_the_same_answers(tmp_path: Path) -> None:
    model = fitted({"x": 5, "y": 4}).calibrate(scattered(800, 5))
    surrogate.save(model, tmp_path / "split.nc")
    again, points = surrogate.load(tmp_path / "split.nc"), np.array([[0.37, 2.0], [0.1, 9.0], [0.9, 0.2]])
    for own, other in zip(model.interval_array(points), again.interval_array(points), strict=True):
        np.testing.assert_allclose(other, own, rtol=1e-13)
    assert isinstance(again, SplitGP)
    assert again.kinks == {"x": (0.37,), "y": (2.0,)}
    np.testing.assert_allclose(
        model.only(["jump"]).interval_array(points)[0][:, 0], model.interval_array(points)[0][:, 1], atol=1e-11
    )


def test_shares_of_the_variance_are_those_of_the_kinked_outputs() -> None:
    table = sobol(fitted({"x": 10, "y": 6}))
    middles = (np.arange(400) + 0.5) / 200 - 1
    x, y = (xr.DataArray(one.from_unit(middles), dims=one.name) for one in (X, Y))
    for name, values in bent(x, y).items():
        for own, other in (("x", "y"), ("y", "x")):
            share = float(values.mean(other).var() / values.var())
            assert float(table["first_order"].sel(output=name, input=own)) == pytest.approx(share, abs=0.02)


@pytest.mark.parametrize(
    ("kinks", "message"),
    [
        ({}, "at least one kink"),
        ({"z": [0.5]}, "kinks of 'z', which is no input; the inputs are x, y"),
        ({"x": [0.0]}, r"kinks of 'x': 0 must differ and lie inside of \[0, 1\]"),
        ({"x": [0.5, 0.5]}, "must differ"),
    ],
)
def test_bad_kinks_are_refused_in_one_line(kinks: dict[str, list[float]], message: str) -> None:
    with pytest.raises(ValueError, match=message) as caught:
        SplitGP([X, Y], kinks)
    assert "\n" not in str(caught.value)


def test_levels_of_the_whole_range_are_refused() -> None:
    grid = xr.Dataset(coords={"x": X.levels(8), "y": Y.levels(6)})
    with pytest.raises(ValueError, match="Chebyshev-Gauss levels"):
        SplitGP([X, Y], {"x": [0.37]}).fit(grid.assign(bent(grid.x, grid.y)))
