"""Intervals after calibration hold on fresh cases, alone and in sums of outputs and near points."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import linprog

from approximation.arrays import Array, Flags
from storage.netcdf import read_whole, write_whole
from surrogate import GridGP, Input, ScatterGP, load, save
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.conformal import calibrate, quantile_regression
from surrogate.intervals.copula import Copula, ends
from surrogate.intervals.distribution import PROBABILITIES, Normal, Tabulated
from surrogate.intervals.guard import sharing
from surrogate.use.validation import validate
from tests.surrogate import functions

Functions = Callable[[Mapping[str, xr.DataArray]], dict[str, xr.DataArray]]


def waves(x: Mapping[str, xr.DataArray]) -> dict[str, xr.DataArray]:
    """Another family than the one that the method was tuned on, again with a near-pole."""
    force, size = xr.apply_ufunc(np.log, x["force"] / 3e4), xr.apply_ufunc(np.log, x["size"] / 0.03)
    pole = 1 / (1.02 - x["mixture"] + 0.01 * x["angle"])
    return {
        "pole": pole * np.exp(-0.5 * force) * np.cos(x["angle"]) + x["bias"] * force,
        "bell": np.exp(-2 * (x["mixture"] - 0.4) ** 2) * (1 + 0.3 * size) / (1 + x["angle"] ** 2),
        "wave": np.sin(4 * x["mixture"] + 0.5 * size) * np.exp(0.3 * force) + x["bias"] * x["angle"],
    }


COUNTS = (10, 4, 4, 4, 2)


@cache
def calibrated(family: Functions, counts: tuple[int, ...], cases: int) -> GridGP:
    """A grid process of a family, calibrated on so many cases."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(functions, "outputs", family)
        model = GridGP(inputs=functions.INPUTS).fit(functions.factorial(counts))
        assert model.calibrate(functions.scattered(cases, seed=1)) is model
    return model


@pytest.mark.sampled(2)
@pytest.mark.parametrize("counts", [COUNTS, (24, 8, 6, 8, 2)])
@pytest.mark.parametrize("family", [functions.outputs, waves])
def test_every_level_holds_marginally_and_95_percent_everywhere(
    family: Functions, counts: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    model = calibrated(family, counts, 3000)
    monkeypatch.setattr(functions, "outputs", family)
    fresh = functions.scattered(20_000, seed=2)
    table = validate(model, fresh, None)
    # what rounding alone is left of has steps, and no distribution
    real = table.sel(output=table["rmse"] > 1e-14)
    for level in (0.5, 0.8, 0.9, 0.95, 0.99):
        # four standard errors of 3,000 and 20,000 cases, and the margin of a level
        room = 4 * np.sqrt(level * (1 - level) * (1 / 3000 + 1 / 20_000)) + 0.01
        np.testing.assert_allclose(real["level_coverage"].sel(level=level), level, rtol=0, atol=room)
    assert float(real["worst_decile_coverage"].min()) >= 0.88
    assert float(real["worst_corner_coverage"].min()) >= 0.82
    assert float(real["pit_distance"].max()) <= 0.05
    answer = model.predict(fresh[list(model.box)])
    for name in real["output"].values:
        one_std = float((np.abs(answer[name] - fresh[name]) <= answer[f"{name}_std"]).mean())
        assert 0.64 <= one_std <= 0.72


def test_calibrated_intervals_are_no_wider_than_they_must_be_and_shown_beside_the_raw_ones() -> None:
    fresh = functions.scattered(3000, seed=2)
    model = calibrated(functions.outputs, COUNTS, 3000)
    before = validate(model.uncalibrated(), fresh, None)
    assert "raw_coverage" not in before
    table = validate(model, fresh, None)
    for name in ("coverage", "level_coverage", "worst_decile_coverage", "crps", "pit", "pit_distance", "rmse"):
        np.testing.assert_array_equal(table[f"raw_{name}"], before[name])
        assert not np.array_equal(table[name], before[name])
    assert bool((table["crps"] < 0.5 * table["raw_crps"]).all())
    # the best constant interval: a Gaussian with the root-mean-square error everywhere
    constant: Any = 0.5642 * np.sqrt((table["error"] ** 2).mean("case"))
    assert bool((table["crps"] < 1.1 * constant).all())
    assert float(table["crps"].sel(output="near_pole")) < 0.7 * float(constant.sel(output="near_pole"))


@pytest.mark.parametrize("count", [40, 3000])
def test_levels_end_where_the_cases_end(count: int) -> None:
    model = calibrated(functions.outputs, COUNTS, count)
    points = functions.scattered(3, seed=5)[list(model.box)]
    most = min(1 - 2 / (count + 1), 0.999)
    assert bool((model.interval(points, most)["ratio_upper"] > model.interval(points, 0.9)["ratio_upper"]).all())
    with pytest.raises(
        ValueError, match=f"level 0.9999 is not between 0 and {most:.10g}, all that {count} calibration"
    ):
        model.interval(points, 0.9999)
    with pytest.raises(ValueError, match=f"q 0.99999 is not between .*, all that {count} calibration cases tell"):
        model.quantile(points, 0.99999)


@pytest.mark.parametrize("count", [60, *(pytest.param(larger, marks=pytest.mark.soak) for larger in (150, 500))])
def test_few_cases_still_give_right_marginal_coverage(count: int) -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial(COUNTS))
    shares = []
    for seed in range(5):
        model.calibrate(functions.scattered(count, seed=10 + seed))
        assert count > 60 or model.correction_ is None  # few cases leave the mean alone
        shares.append(validate(model, functions.scattered(3000, seed=2), None)["coverage"].values)
    # a beta distribution: the coverage given the cases spreads by about sqrt(0.95 * 0.05 / count)
    assert np.mean(shares) >= 0.94
    assert np.min(shares) >= 0.95 - 5 * np.sqrt(0.95 * 0.05 / count)


def test_a_scattered_model_is_calibrated_too() -> None:
    keep = ["mixture", "angle", "size", "ratio"]
    train, held, fresh = (functions.scattered(n, seed=s)[keep] for n, s in ((60, 0), (600, 1), (3000, 2)))
    model = ScatterGP(functions.INPUTS[:3]).fit(train).calibrate(held)
    table = validate(model, fresh, None)
    assert float(table["coverage"][0]) == pytest.approx(0.95, abs=0.03)


def test_fitting_again_forgets_the_calibration() -> None:
    data = functions.factorial((6, 4, 4, 3, 2))
    model = GridGP(inputs=functions.INPUTS).fit(data)
    points = functions.scattered(10, seed=5)[list(model.box)]
    raw = model.predict(points)
    assert not raw.equals(model.calibrate(functions.scattered(100, seed=1)).predict(points))
    xr.testing.assert_identical(model.fit(data).predict(points), raw)


def held(model: Calibration, t: Array, errors: Array) -> Flags:
    """Return True where the 95 % interval of a calibration without parts of a variance holds the error, (p, n)."""
    std = model.std(np.zeros_like(errors), t)
    lower, upper = model.distribution.ends(0.95)[..., None]
    return np.asarray((lower * std <= errors) & (errors <= upper * std))


def test_a_scale_that_waves_across_two_inputs_is_followed() -> None:
    """Oblique slabs hold; what no products of higher degree follow holds three quarters there."""
    random = np.random.default_rng(0)
    t = random.uniform(-1, 1, (3, 22_000))
    errors = random.normal(size=(1, t.shape[1])) * np.exp(1.5 * np.sin(4 * (t[0] - t[2]) + 0.5))
    learning = t[:, :6000]
    learnt = calibrate(errors[:, :6000], [np.zeros((1, 6000))], learning, sharing(learning))
    assert set(np.flatnonzero(learnt.trend_degree.max(axis=0) > 2)) >= {0, 2}
    assert int((learnt.trend_degree.astype(bool).sum(axis=1) > 1).sum()) == 27 + 3
    new, points = errors[:, 6000:], t[:, 6000:]
    inside = held(learnt, points, new)
    assert inside.mean() == pytest.approx(0.955, abs=0.012)
    along = points[0] - points[2]
    slabs = [(along >= low) & (along < low + 0.2) for low in np.linspace(-1.4, 1.2, 14)]
    assert min(inside[0, slab].mean() for slab in slabs) >= 0.9
    additive = replace(learnt, trend=np.where(learnt.trend_degree.astype(bool).sum(axis=1) > 1, 0.0, learnt.trend.T).T)
    alone = held(additive, points, new)[0]
    assert min(alone[slab].mean() for slab in slabs) < 0.8


def test_a_scale_stays_within_what_the_cases_showed() -> None:
    random = np.random.default_rng(1)
    t = np.tanh(random.normal(size=(2, 6000)) * [[0.3], [0.3]])  # next to nothing in the corners
    errors = random.normal(size=(1, 6000)) * np.exp(np.sin(3 * t.sum(axis=0)))
    learnt = calibrate(errors, [np.zeros((1, 6000))], t, sharing(t))
    corners = np.array([[-1.0, -1, 1, 1], [-1, 1, -1, 1]])
    std = learnt.std(np.zeros((1, 4)), corners)
    assert (std < 30).all()
    assert (std > 0.03).all()


def test_cases_that_share_places_count_as_places_in_parts_of_the_box() -> None:
    random = np.random.default_rng(2)
    few, distinct = np.repeat(random.uniform(-1, 1, (1, 60)), 50, axis=1), random.uniform(-1, 1, (1, 3000))
    t = np.concatenate([few, distinct])
    learnt = calibrate(random.normal(size=(1, 3000)), [np.zeros((1, 3000))], t, sharing(t))
    assert not learnt.guard.slabs[0].any()  # six places each
    assert not learnt.trend_degree.all(axis=1).any()  # no product of the two


def test_intervals_of_derivatives_hold_in_about_their_share() -> None:
    model = calibrated(functions.outputs, COUNTS, 3000)
    points, true = functions.true_slopes(functions.scattered(600, seed=2)[list(model.box)], functions.INPUTS[0])
    slopes = model.gradient(points, return_std=True).sel(input=functions.INPUTS[0].name)
    for name in ("near_pole", "smooth", "ratio"):
        held = (slopes[f"{name}_lower"] <= true[name]) & (true[name] <= slopes[f"{name}_upper"])
        assert 0.85 <= float(held.mean()) <= 1


def test_quantile_regression_agrees_with_linear_programming() -> None:
    rng = np.random.default_rng(0)
    A = np.stack([np.ones(600), *rng.normal(size=(3, 600))], axis=1)
    y = A @ [1.0, -2.0, 0.5, 0.0] + (1 + 0.5 * A[:, 1] ** 2) * rng.standard_t(4, size=600)
    for level in (0.5, 0.95):
        result = quantile_regression(A, y, level)
        cost = np.concatenate([np.zeros(4), np.full(600, level), np.full(600, 1 - level)])
        equal = np.concatenate([A, np.eye(600), -np.eye(600)], axis=1)
        best = linprog(cost, A_eq=equal, b_eq=y, bounds=[(None, None)] * 4 + [(0, None)] * 1200)
        residual = y - A @ result
        reached = float(np.sum(residual * (level - (residual < 0))))
        assert best.fun is not None
        assert reached <= best.fun * 1.005
        assert np.mean(residual <= 0) == pytest.approx(level, abs=0.012)


def test_two_clusters_of_errors_have_a_quantile() -> None:
    """Cases at two places, one of which the model knows a million times better."""
    random = np.random.default_rng(0)
    size = np.repeat([1e-9, 1e-3], 30)
    t = np.stack([np.repeat([-0.3, 0.6], 30), random.uniform(-1, 1, 60)])
    error = size * random.standard_normal(60)
    result = calibrate(error[None], [np.full((1, 60), 1e-6)], t, sharing(t))
    ends = result.distribution.ends(0.9) * result.std(np.full((1, 60), 1e-6), t)[0, 0]
    assert np.all(np.isfinite(ends))
    assert np.mean((ends[0] <= error) & (error <= ends[1])) >= 0.85


def test_a_constant_between_few_cases_is_a_quantile() -> None:
    """The gap below the largest of ten is wider than the smoothing, from whose middle no case is near."""
    y = np.random.default_rng(2).normal(size=10) ** 3
    (constant,) = quantile_regression(np.ones((10, 1)), y, 0.95)
    assert np.sort(y)[-2] <= constant <= 1.1 * y.max()


INPUTS = (Input("x", 0.0, 1.0), Input("y", 1.0, 3.0))


def truth(x: Any, y: Any) -> dict[str, Any]:
    """Outputs that share a near-pole, and one that does not."""
    pole, wave = 1 / (x + 0.1) ** y, np.cos(5 * x * y)
    return {"first": 3 + pole, "second": 2 + 0.7 * pole + 0.002 * wave, "other": np.exp(np.sin(4 * x * y) / y)}


def cases(count: int, seed: int) -> xr.Dataset:
    points = functions.drawn(INPUTS, count, seed)
    return points.assign(truth(points["x"], points["y"]))


@pytest.fixture(scope="module")
def model() -> GridGP:
    grid = functions.grid(INPUTS, (12, 8))
    return GridGP(inputs=INPUTS).fit(grid.assign(truth(grid["x"], grid["y"]))).calibrate(cases(3000, 1))


def test_closed_sums_reach_as_far_as_they_should(model: GridGP) -> None:
    fresh = cases(600, 8)
    X = np.stack([fresh["x"], fresh["y"]], axis=1)
    error = np.stack([fresh[name] for name in model.outputs_], axis=1) - model.predict_array(X)
    for weights in ([1.0, 1.0, 0.0], [0.4, -1.0, 0.0], [1.0, 0.0, -0.5]):
        ends_of_sums = np.array([model.ends_of_sum(x[None], np.array([weights])) for x in X])
        sums = error @ weights
        inside = np.mean((ends_of_sums[:, 0] <= sums) & (sums <= ends_of_sums[:, 1]))
        assert inside == pytest.approx(0.955, abs=4 * np.sqrt(0.95 * 0.05 / 600) + 0.01)


def test_lengths_are_those_that_errors_were_drawn_with() -> None:
    random, lengths = np.random.default_rng(0), np.array([0.15, 0.8])
    angles = random.uniform(0, np.pi, (2, 1500))
    square = sum(
        np.subtract.outer(angle, angle) ** 2 / length**2 for angle, length in zip(angles, lengths, strict=True)
    )
    scores = np.linalg.cholesky(np.exp(-0.5 * square) + 1e-8 * np.eye(1500)) @ random.normal(size=(1500, 8))
    result = Copula.of(scores.T, np.cos(angles)).lengths
    assert np.abs(np.log(result / lengths)).max() < 0.25


def test_sums_of_normal_errors_have_the_ends_of_the_normal_distribution() -> None:
    random = np.random.default_rng(1)
    correlation = np.array([[1, 0.9, -0.5], [0.9, 1, -0.3], [-0.5, -0.3, 1]])
    scores = np.linalg.cholesky(correlation) @ random.normal(size=(3, 1000))
    lengths = np.array([0.5])
    copula = replace(Copula.of(scores, random.uniform(-1, 1, (1, 1000))), lengths=lengths)
    normal = Tabulated(np.repeat(Normal().quantile(np.clip(PROBABILITIES, 5e-4, 1 - 5e-4)), 3, axis=1), 1000)
    t = np.cos([[1.0, 1.3, 2.9]])
    for sizes in (np.array([[1.0], [-1], [0.5]]), random.normal(size=(3, 3))):
        points = t[:, : sizes.shape[1]]
        near = np.exp(-0.5 * np.subtract.outer(np.arccos(points[0]), np.arccos(points[0])) ** 2 / lengths[0] ** 2)
        deviation = np.sqrt(np.einsum("pn,pq,nm,qm->", sizes, correlation, near, sizes))
        # a quantile of 1,000 rows at 0.025 has a standard error of 4 %
        np.testing.assert_allclose(
            ends(normal, copula, 0.95, sizes, points), [-1.96 * deviation, 1.96 * deviation], rtol=0.12
        )
    added = ends(normal, None, 0.95, np.array([[1.0], [-1], [0.5]]), t[:, :1])
    np.testing.assert_allclose(added, [-1.96 * 2.5, 1.96 * 2.5], rtol=0.02)  # the table is linear between levels


def test_a_file_of_before_is_read_and_adds_errors(model: GridGP, tmp_path: Path) -> None:
    save(model, tmp_path / "a.nc")
    write_whole(read_whole(tmp_path / "a.nc").drop_vars(["calibration_rank", "calibration_length"]), tmp_path / "b.nc")
    old, points = load(tmp_path / "b.nc"), {"x": [0.1, 0.6], "y": 2.0}
    xr.testing.assert_identical(old.interval(points), model.interval(points))
    sums = [np.abs(process.ends_of_sum(np.array([[0.1, 2.0]]), np.array([[1.0, -1, 0]]))) for process in (old, model)]
    assert (sums[0] > sums[1]).all()
