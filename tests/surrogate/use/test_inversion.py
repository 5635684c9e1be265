"""Inversion against closed forms, and the edge beyond which cases are refused."""

from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy import stats

from approximation.arrays import Array
from approximation.chebyshev import gauss_points
from surrogate import GridGP, Input, OutOfBoxError, load, save
from surrogate.data.inputs import unit_coordinates
from surrogate.face.region import OutOfRegionError, Region
from surrogate.use import feasibility
from surrogate.use.inversion import Inversion

INPUTS = [Input("a", -2.0, 3.0), Input("b", 0.1, 10.0, "log"), Input("c", 0.0, 1.0)]


def model(second: str) -> GridGP:
    """A model of u = a + c and v = log b (linear), or v = (log b + a / 2)^2 (folded: two answers)."""
    levels = {input_.name: input_.levels(n) for input_, n in zip(INPUTS, (6, 8, 2), strict=True)}
    a, b, c = (xr.DataArray(values, dims=name, coords={name: values}) for name, values in levels.items())
    v = np.log(b) if second == "linear" else (np.log(b) + a / 2) ** 2
    data = xr.Dataset({"u": (a + c + 0 * b), "v": v + 0 * a + 0 * c}).transpose("a", "b", "c")
    return GridGP(inputs=INPUTS).fit(data)


def test_a_linear_model_has_truncated_gaussian_posteriors() -> None:
    inversion = Inversion(model("linear"), ["a", "b"], ["u", "v"], {"c": 0.25})
    for u, v, errors in ((1.0, 0.3, (0.2, 0.4)), (3.2, 2.4, (0.3, 0.5)), (0.5, -1.0, (1e-6, 1e-7)), (0, 0, (50, 1e-3))):
        estimate = inversion.estimate(np.array([u, v]), np.array(errors, dtype=float))
        for k, (centre, low, high) in enumerate(((u - 0.25, -2.0, 3.0), (v, np.log(0.1), np.log(10)))):
            std = errors[k]
            exact = stats.truncnorm((low - centre) / std, (high - centre) / std, centre, std)
            ends = np.array([estimate.low[k], estimate.high[k]])
            ends = np.log(ends) if k else ends
            np.testing.assert_allclose(ends, exact.ppf([0.025, 0.975]), atol=1e-2 * exact.std(), rtol=0)


def test_two_answers_are_both_within_the_interval() -> None:
    inversion = Inversion(model("folded"), ["b"], ["v"], {"c": 0.0, "a": 0.0})
    estimate = inversion.estimate(np.array([1.0]), np.array([1e-3]))
    assert estimate.low[0] == pytest.approx(np.exp(-1), rel=3e-3)
    assert estimate.high[0] == pytest.approx(np.exp(1), rel=3e-3)


@pytest.mark.parametrize("value", [1e20, 1e200, 1e308])
def test_a_reading_beyond_everything_comes_to_an_end(value: float) -> None:
    estimate = Inversion(model("linear"), ["a", "b"], ["u", "v"], {"c": 0.25}).estimate(
        np.array([value, 0.3]), np.full(2, 0.1)
    )
    assert estimate.misfit > 1e15
    assert np.isnan(estimate.mean).all()


@pytest.mark.parametrize(("value", "error"), [(1.0, 1e308), (1.0, 0.0), (1.0, 1e-200), (np.inf, 1.0), (1.0, np.nan)])
def test_numbers_whose_squares_are_none_are_refused(value: float, error: float) -> None:
    inversion = Inversion(model("linear"), ["a"], ["u"], {"b": 1.0, "c": 0.25})
    with pytest.raises(ValueError, match="must be finite, their errors within 1e-150 to 1e\\+150"):
        inversion.estimate(np.array([value]), np.array([error]))


def test_an_error_beyond_all_outputs_leaves_the_whole_range() -> None:
    inversion = Inversion(model("linear"), ["a"], ["u"], {"b": 1.0, "c": 0.25})
    estimate = inversion.estimate(np.array([1.0]), np.array([1e140]))
    assert [estimate.low[0], estimate.high[0]] == pytest.approx([-2 + 0.125, 3 - 0.125], rel=1e-6)


def test_disagreement_shows_in_the_misfit() -> None:
    inversion = Inversion(model("linear"), ["a", "b"], ["u", "v"], {"c": 0.25})
    assert inversion.estimate(np.array([1.0, 0.3]), np.array([0.1, 0.1])).misfit < 1
    assert inversion.estimate(np.array([9.0, 0.3]), np.array([0.1, 0.1])).misfit > 1000


@pytest.mark.parametrize("trials", [25, pytest.param(250, marks=pytest.mark.soak)])
@pytest.mark.sampled(1)
@pytest.mark.parametrize("error", [0.5, 1e-2])
def test_intervals_hold_the_truth_as_often_as_they_say(error: float, trials: int) -> None:
    inversion = Inversion(model("folded"), ["a", "b"], ["u", "v"], {"c": 0.0})
    random = np.random.default_rng(3)
    held = []
    for _ in range(trials):
        t = random.uniform(-1, 1, 2)
        a, b = (float(input_.from_unit(x)) for input_, x in zip(INPUTS, t, strict=False))
        measured = np.array([a, (np.log(b) + a / 2) ** 2]) + error * random.standard_normal(2)
        estimate = inversion.estimate(measured, np.full(2, error))
        held.append((estimate.low <= [a, b]) & ([a, b] <= estimate.high))
    spread = np.sqrt(0.95 * 0.05 / trials)
    assert np.mean(held, axis=0) == pytest.approx(0.95, abs=3.2 * spread)


def test_refuses_what_it_cannot_infer() -> None:
    with pytest.raises(ValueError, match="'d' is not an input"):
        Inversion(model("linear"), ["d"], ["u"], {})
    with pytest.raises(ValueError, match="'c' must be either inferred or given"):
        Inversion(model("linear"), ["a", "b"], ["u"], {})
    with pytest.raises(ValueError, match="'w' is not an output"):
        Inversion(model("linear"), ["a", "b"], ["w"], {"c": 0.0})


NODES = np.array(list(product(*(gauss_points(count) for count in (8, 5, 10))))).T


def plane(t: Array) -> Array:
    return np.asarray(1.25 - (t[0] + t[1] + 0.3 * t[2]))


def curved(t: Array) -> Array:
    return np.asarray(1.0 - (t[0] + 0.9) ** 2 * (t[1] + 1.2) / 4 + 0.1 * t[2])


def learnt(above: Callable[[Array], Array], seed: int, count: int) -> Region:
    """A region from the nodes and some held-out cases, of which an exact function says what is refused."""
    t = np.concatenate([NODES, np.random.default_rng(seed).uniform(-1, 1, (3, count))], axis=1)
    refused, even = above(t) < 0, np.arange(t.shape[1]) >= NODES.shape[1]
    which = np.zeros(int(refused.sum()), dtype=np.intp)
    return feasibility.learn(t, refused, even, np.arange(t.shape[1]), which, ["too far"])


@pytest.mark.parametrize(("above", "seeds"), [(plane, 3), (curved, 3)])
def test_no_more_refused_cases_pass_than_is_promised(above: Callable[[Array], Array], seeds: int) -> None:
    passed, lost = [], []
    for seed in range(seeds):
        region = learnt(above, seed, 400)
        assert region.passing <= 0.05
        fresh = np.random.default_rng(100 + seed).uniform(-1, 1, (3, 20000))
        refused, inside = above(fresh) < 0, region.inside(fresh)
        passed.append((refused & inside).sum() / refused.sum() / region.passing)
        lost.append((~refused & ~inside).sum() / (~refused).sum())
    assert np.mean(passed) <= 1
    assert np.mean(lost) < 0.03  # the margin takes 1 % at least


@pytest.fixture(scope="module")
def bounded() -> GridGP:
    inputs = [Input("a", 0.0, 2.0), Input("b", 1.0, 100.0, "log"), Input("c", -1.0, 1.0)]
    coords = {input_.name: input_.levels(4) for input_ in inputs}
    grid = xr.Dataset(coords=coords)
    fitted = GridGP(inputs=inputs).fit(grid.assign(f=grid.a * np.log(grid.b) + grid.c))
    fitted.region_ = learnt(plane, 0, 200)
    return fitted


def test_points_beyond_the_edge_are_refused_with_the_reason(bounded: GridGP) -> None:
    inside, beyond = {"a": 0.5, "b": 5.0, "c": 0.0}, {"a": 1.95, "b": 98.0, "c": 0.5}
    message = r"a = 1.95, b = 98, c = 0.5 is beyond the edge of the cases that have answers: too far"
    for ask in (bounded.predict, bounded.interval, bounded.gradient, lambda points: bounded.sample(points, 2, 0)):
        ask(inside)
        with pytest.raises(OutOfRegionError, match=message):
            ask(beyond)
    X = np.array([list(inside.values()), list(beyond.values())])
    with pytest.raises(OutOfBoxError, match=r"\(1 of 2 points are beyond it\): too far"):
        bounded.predict_array(X)
    assert bounded.has_answers(np.vstack([X, [[3.0, 5.0, 0.0]]])).tolist() == [True, False, False]
    assert bounded.predict(beyond, extrapolate=True)["extrapolated"].item()
    np.testing.assert_array_equal(bounded.everywhere().predict_array(X), bounded.predict_array(X, extrapolate=True))
    assert bounded.only(["f"]).region_ is bounded.region_


def test_a_file_keeps_the_region(bounded: GridGP, tmp_path: Path) -> None:
    save(bounded, tmp_path / "model.nc")
    again = load(tmp_path / "model.nc").region_
    assert again is not None
    assert bounded.region_ is not None
    t = np.random.default_rng(1).uniform(-1, 1, (3, 200))
    np.testing.assert_array_equal(again.above(t), bounded.region_.above(t))
    assert (again.passing, again.lost, again.reasons) == (
        bounded.region_.passing, bounded.region_.lost, bounded.region_.reasons,
    )  # fmt: skip
    save(bounded.everywhere(), tmp_path / "plain.nc")
    assert load(tmp_path / "plain.nc").region_ is None


def test_slopes_are_difference_quotients(bounded: GridGP) -> None:
    assert bounded.region_ is not None
    t, step = unit_coordinates(bounded.inputs_, np.array([[0.7, 20.0, -0.3], [1.5, 3.0, 0.6]])), 1e-6
    slopes = bounded.region_.slopes(t)
    for k in range(3):
        shift = np.zeros((3, 1))
        shift[k] = step
        quotient = (bounded.region_.above(t + shift) - bounded.region_.above(t - shift)) / (2 * step)
        np.testing.assert_allclose(slopes[k], quotient, rtol=1e-6, atol=1e-6 * np.abs(slopes).max())


def test_a_file_with_an_inconsistent_region_is_refused(bounded: GridGP) -> None:
    assert bounded.region_ is not None
    stored = bounded.region_.state()
    with pytest.raises(ValueError, match="does not fit the model"):
        Region.restore(stored, 2)
    with pytest.raises(ValueError, match="do not fit its places"):
        Region.restore(stored.assign(region_which=stored["region_which"] + 5), 3)
