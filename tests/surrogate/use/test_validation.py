"""Error tables, sensitivity and inversion against figures by hand and closed forms."""

from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from numpy.polynomial.chebyshev import chebval2d, chebvander2d
from scipy import stats
from scipy.integrate import quad
from scipy.stats import binom, norm

from surrogate import GridGP, Input, ScatterGP
from surrogate.use.inversion import Inversion
from surrogate.use.sensitivity import sobol
from surrogate.use.validation import LEVELS, chebyshev_interpolation, crps, ideal, pit, validate
from tests.surrogate import functions


def test_crps_is_the_integral_that_defines_it() -> None:
    true, mean, std = np.array([0.3, -2.0, 1.0]), np.array([0.0, 1.0, 1.0]), np.array([0.5, 1.0, 2.0])
    for k in range(3):

        def square(x: float, k: int = k) -> float:
            return float((norm.cdf(x, mean[k], std[k]) - (x >= true[k])) ** 2)

        want = quad(square, -40, true[k], limit=200)[0] + quad(square, true[k], 40, limit=200)[0]
        assert crps(true, mean, std)[k] == pytest.approx(want, rel=1e-7)
    np.testing.assert_array_equal(crps(true, mean, np.zeros(3)), np.abs(true - mean))


def test_pit_and_coverage_of_a_right_model_are_uniform_and_nominal() -> None:
    rng = np.random.default_rng(0)
    mean, std = rng.normal(size=20_000), rng.uniform(0.5, 2, 20_000)
    values = pit(mean + std * rng.normal(size=20_000), mean, std)
    np.testing.assert_allclose(np.quantile(values, [0.1, 0.5, 0.9]), [0.1, 0.5, 0.9], atol=0.01)


def test_ideal_parts_fall_short_by_chance_alone() -> None:
    """The least of 10 deciles of 50 cases each, of one input and one output: by the distribution of binomial counts."""
    box, cases = {"x": Input("x", 0, 1)}, {"x": xr.DataArray(np.linspace(0, 1, 500), dims="case")}
    result = ideal(box, cases, 1)
    at_least = 1 - binom.cdf(np.arange(-1, 50), 50, 0.95)  # P(count >= k), k = 0 .. 50
    mean = (at_least[1:] ** 10).sum() / 50
    assert result["worst_decile_coverage"] == pytest.approx(mean, abs=0.02)
    assert np.isnan(result["worst_corner_coverage"])  # of one input there is none
    np.testing.assert_allclose(result["low"], LEVELS, atol=0.03)
    assert result["low"] == result["high"]
    many = ideal(box, cases, 40)
    assert many["worst_decile_coverage"] < result["worst_decile_coverage"] - 0.03
    assert all(low < high for low, high in zip(many["low"], many["high"], strict=True))


def test_the_table_is_that_of_the_definitions() -> None:
    data, held = functions.factorial((8, 4, 4, 4, 2)), functions.scattered(400, seed=4)
    model = GridGP(inputs=functions.INPUTS).fit(data)
    table = validate(model, held, data)
    predicted = model.predict(held[[input_.name for input_ in functions.INPUTS]])
    for name in model.outputs_:
        row, true = table.sel(output=name), held[name].values
        error, std = predicted[name].values - true, predicted[f"{name}_std"].values
        spread = true.max() - true.min()
        assert float(row["range"]) == spread
        assert float(row["max_error"]) == pytest.approx(np.abs(error).max() / spread, rel=1e-12)
        assert float(row["rmse"]) == pytest.approx(np.sqrt(np.mean(error**2)) / spread, rel=1e-12)
        assert float(row["r2"]) == pytest.approx(1 - np.sum(error**2) / np.sum((true - true.mean()) ** 2), abs=1e-12)
        inside = np.abs(error) <= 1.959963984540054 * std
        assert float(row["coverage"]) == pytest.approx(inside.mean(), abs=1e-12)
        lowest = np.argsort(held["angle"].values)[:40]
        assert float(row["decile_coverage"].sel(input="angle", decile=1)) == pytest.approx(inside[lowest].mean())
        assert float(row["worst_decile_coverage"]) == float(row["decile_coverage"].min())
    assert table["pit"].shape == (6, 400)
    X = np.stack([held[name].values for name in model.box], axis=1)
    (plain,) = chebyshev_interpolation(data, functions.INPUTS, X, ["ratio"])
    want = np.abs(plain - held["ratio"]).max() / table["range"].sel(output="ratio")
    assert float(table["baseline_max_error"].sel(output="ratio")) == pytest.approx(float(want), rel=1e-12)


def test_the_baseline_is_the_polynomial_through_the_data() -> None:
    x, y = Input("x", -1, 1), Input("y", 1, 100, "log")
    a, b = x.levels(6), y.levels(5)
    values = np.exp(a)[:, None] / (1 + b)
    data = xr.Dataset({"f": (("x", "y"), values)}, coords={"x": a, "y": b})
    rng = np.random.default_rng(0)
    s, t = rng.uniform(-1, 1, 50), rng.uniform(-1, 1, 50)
    grid = np.meshgrid(a, y.to_unit(b), indexing="ij")
    matrix = chebvander2d(grid[0].ravel(), grid[1].ravel(), [5, 4])
    coefficients = np.linalg.solve(matrix, values.ravel()).reshape(6, 5)
    (result,) = chebyshev_interpolation(data, [x, y], np.stack([s, y.from_unit(t)], axis=1), ["f"])
    np.testing.assert_allclose(result, chebval2d(s, t, coefficients), rtol=0, atol=1e-13)


@cache
def ishigami() -> GridGP:
    inputs = [Input(name, -np.pi, np.pi) for name in ("x1", "x2", "x3")]
    x = functions.grid(inputs, (26, 30, 10))
    f = np.sin(x.x1) + 7 * np.sin(x.x2) ** 2 + 0.1 * x.x3**4 * np.sin(x.x1)
    return GridGP(inputs=inputs).fit(xr.Dataset({"f": f, "constant": 0 * x.x1 + 3, "single": 2 * x.x3**2}))


def test_indices_and_main_effects_of_the_ishigami_function_are_the_known_ones() -> None:
    # T. Ishigami and T. Homma (1990), a = 7, b = 0.1
    a, b, pi = 7.0, 0.1, np.pi
    v1, v2, v13 = 0.5 * (1 + b * pi**4 / 5) ** 2, a**2 / 8, b**2 * pi**8 * (1 / 18 - 1 / 50)
    whole = v1 + v2 + v13
    all_indices = sobol(ishigami())
    np.testing.assert_allclose(all_indices["total"].sel(output="single"), [0, 0, 1], atol=1e-10)
    np.testing.assert_array_equal(all_indices["total"].sel(output="constant"), 0)
    indices = all_indices.sel(output="f")
    assert float(indices["mean"]) == pytest.approx(a / 2, rel=1e-10)
    assert float(indices["variance"]) == pytest.approx(whole, rel=1e-10)
    np.testing.assert_allclose(indices["first_order"], np.array([v1, v2, 0]) / whole, rtol=0, atol=1e-10)
    np.testing.assert_allclose(indices["total"], np.array([v1 + v13, v2, v13]) / whole, rtol=0, atol=1e-10)
    want = np.zeros((3, 3))
    want[0, 2] = want[2, 0] = v13 / whole
    np.testing.assert_allclose(indices["second_order"], want, rtol=0, atol=1e-10)
    x = indices["value"]
    effects: dict[str, Any] = {  # conditional means
        "x1": np.sin(x.sel(input="x1")) * (1 + 0.1 * np.pi**4 / 5),
        "x2": 7 * np.sin(x.sel(input="x2")) ** 2 - 3.5,
        "x3": 0 * x.sel(input="x3"),
    }
    for name, effect in effects.items():
        np.testing.assert_allclose(indices["main_effect"].sel(input=name), effect, rtol=0, atol=1e-9)


def test_indices_under_a_distribution_are_those_of_its_moments() -> None:
    """Of f = sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, with x3 triangular: moments of x3^4 by its density."""
    low, mode, high = -1.0, 0.5, 2.0
    triangular = scipy.stats.triang((mode - low) / (high - low), low, high - low)
    fourth, eighth = (float(triangular.moment(order)) for order in (4, 8))
    single, two = 0.5 * (1 + 0.1 * fourth) ** 2, 7.0**2 / 8
    pair = 0.5 * 0.1**2 * (eighth - fourth**2)
    indices = sobol(ishigami(), {"x3": triangular.ppf}).sel(output="f")
    whole = single + two + pair
    # the quantile function has square roots at its ends, and 64 nodes
    np.testing.assert_allclose(indices["first_order"], np.array([single, two, 0]) / whole, rtol=0, atol=1e-5)
    np.testing.assert_allclose(indices["total"], np.array([single + pair, two, pair]) / whole, rtol=0, atol=1e-5)


def test_intervals_hold_the_indices_of_the_truth_on_a_coarse_grid() -> None:
    truth = sobol(GridGP(inputs=functions.INPUTS).fit(functions.factorial((16, 5, 5, 5, 2))))
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial((6, 3, 3, 3, 2)))
    model.calibrate(functions.scattered(1000, seed=3))
    coarse = sobol(model)
    for name in ("first_order", "total"):
        assert bool((coarse[f"{name}_low"] <= truth[name] + 1e-12).all())
        assert bool((coarse[f"{name}_high"] >= truth[name] - 1e-12).all())
        width = coarse[f"{name}_high"] - coarse[f"{name}_low"]
        assert 1e-6 < float(width.max()) < 0.7


def test_scattered_models_are_refused_by_name() -> None:
    cases = functions.scattered(20, seed=0)[["mixture", "ratio"]]
    with pytest.raises(TypeError, match="need a GridGP, GroupedGP or CurveGP, got ScatterGP"):
        sobol(ScatterGP(outputs=["ratio"]).fit(cases))


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
