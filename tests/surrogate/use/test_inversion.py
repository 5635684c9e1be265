"""Inversion against closed forms."""

import numpy as np
import pytest
import xarray as xr
from scipy import stats

from surrogate import GridGP, Input
from surrogate.use.inversion import Inversion
from tests.surrogate import functions

INPUTS = [Input("a", -2.0, 3.0), Input("b", 0.1, 10.0, "log"), Input("c", 0.0, 1.0)]


def model(second: str) -> GridGP:
    """A model of u = a + c and v = log b (linear), or v = (log b + a / 2)^2 (folded: two answers)."""
    grid = functions.grid(INPUTS, (6, 8, 2))
    a, b, c = (grid[input_.name] for input_ in INPUTS)
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


def test_an_error_beyond_all_outputs_leaves_the_whole_range() -> None:
    inversion = Inversion(model("linear"), ["a"], ["u"], {"b": 1.0, "c": 0.25})
    estimate = inversion.estimate(np.array([1.0]), np.array([1e140]))
    assert [estimate.low[0], estimate.high[0]] == pytest.approx([-2 + 0.125, 3 - 0.125], rel=1e-6)


def test_disagreement_shows_in_the_misfit_and_a_reading_beyond_everything_comes_to_an_end() -> None:
    inversion = Inversion(model("linear"), ["a", "b"], ["u", "v"], {"c": 0.25})
    assert inversion.estimate(np.array([1.0, 0.3]), np.full(2, 0.1)).misfit < 1
    for value, least in ((9.0, 1e3), (1e20, 1e15), (1e308, 1e15)):
        estimate = inversion.estimate(np.array([value, 0.3]), np.full(2, 0.1))
        assert estimate.misfit > least
        assert value == 9.0 or np.isnan(estimate.mean).all()


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
