"""Named inputs with their scales, named outputs, and refusals, for every engine."""

import re
from collections.abc import Callable
from copy import deepcopy
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from sklearn.exceptions import NotFittedError

from solver import solve
from surrogate import FactorialRegressor, FormatError, GridGP, Input, OutOfBoxError, load, save
from surrogate.data.points import named_points
from surrogate.use.export import exported
from tests.refusals import assert_refused
from tests.surrogate import functions

COUNTS = (9, 5, 5, 5, 2)
MIDDLE = {"mixture": 0.5, "angle": 0.3, "size": 0.05, "force": 3e4, "bias": 0.0}


@pytest.fixture(scope="module")
def model() -> GridGP:
    return GridGP(inputs=functions.INPUTS).fit(functions.factorial(COUNTS))


def test_sequences_span_the_factorial_and_inputs_stay_as_coordinates(model: GridGP) -> None:
    points: dict[str, Any] = {**MIDDLE, "size": [0.1, 0.01], "angle": (0.1, 0.2, 0.3)}
    answer = model.predict(points)
    assert answer["smooth"].dims == ("angle", "size")
    for name, value in points.items():
        np.testing.assert_array_equal(answer[name], value)
        assert answer[name].dims == ((name,) if np.ndim(value) else ())
        assert answer[name].attrs == model.box[name].attrs
    assert answer["angle"].attrs == {"units": "rad"}
    X = np.array([[0.5, angle, size, 3e4, 0.0] for angle in points["angle"] for size in points["size"]])
    mean, std = model.predict_array(X, return_std=True)
    for k, name in enumerate(model.outputs_):
        np.testing.assert_array_equal(answer[name].values.ravel(), mean[:, k])
        np.testing.assert_array_equal(answer[f"{name}_std"].values.ravel(), std[:, k])


def test_sequences_cross_as_those_of_the_solver_do() -> None:
    cases = {"load": [1e4, 2e4, 3e4], "friction": [0.1, 0.2], "radius": 0.05, "volume_fraction": 0.5}
    exact = solve(cases)
    points = named_points(cases, [Input(name, 0, 1e5) for name in cases])
    assert (points.dims, points.shape) == (exact["depth"].dims, exact["depth"].shape)
    assert {name: array.dims for name, array in points.coords.items()} == {
        name: array.dims for name, array in exact.coords.items()
    }
    np.testing.assert_array_equal(points.X[:, 0], exact["load"].broadcast_like(exact["depth"]).values.ravel())


def test_a_data_set_of_points_is_accepted_and_empty_ones_give_empty_answers(model: GridGP) -> None:
    held = functions.scattered(4, seed=2)[[input_.name for input_ in functions.INPUTS]]
    assert model.predict(held)["ratio"].dims == ("case",)
    assert model.predict(held.isel(case=slice(0)))["ratio"].shape == (0,)


def test_a_point_outside_the_box_is_refused_by_name_value_and_range(model: GridGP) -> None:
    with pytest.raises(OutOfBoxError) as caught:
        model.predict({**MIDDLE, "size": [0.05, 0.5]})
    assert str(caught.value) == "size = 0.5 is outside the trained box [0.005, 0.2] m (1 of 2 points are outside)"
    with pytest.raises(OutOfBoxError, match=re.escape("force = 1 is outside")):
        model.predict_array(np.array([[0.5, 0.3, 0.05, 1.0, 0.0]]))
    assert_refused(OutOfBoxError, re.escape("angle = 0.7"), model.gradient, {**MIDDLE, "angle": 0.7})


def test_extrapolation_is_computed_and_flagged_when_asked_for(model: GridGP) -> None:
    far = {**MIDDLE, "mixture": [0.5, 0.951]}
    truth = functions.outputs({k: xr.DataArray(v) for k, v in {**MIDDLE, "mixture": 0.951}.items()})["no_bias"]
    answer = model.predict(far, extrapolate=True)
    assert float(answer["no_bias"][1]) == pytest.approx(float(truth), rel=1e-4)  # close by, where it still holds
    assert "extrapolated" not in model.predict(MIDDLE)
    asks: list[Callable[..., xr.Dataset]] = [model.predict, model.interval, partial(model.quantile, q=0.5)]
    for ask in asks:
        assert ask(far, extrapolate=True)["extrapolated"].values.tolist() == [False, True]
        assert_refused(OutOfBoxError, re.escape("mixture = 0.951"), ask, far)


def test_box_and_scale_are_read_off_chebyshev_levels() -> None:
    box = GridGP().fit(functions.factorial((5, 3, 4, 3, 2))[["smooth"]]).box
    assert set(box) == {"mixture", "angle", "size", "force"}
    for input_ in functions.INPUTS[:4]:
        assert box[input_.name].scale == input_.scale
        assert box[input_.name].low == pytest.approx(input_.low, rel=1e-9, abs=1e-9)
        assert box[input_.name].high == pytest.approx(input_.high, rel=1e-9)


def test_unsorted_and_transposed_levels_give_the_same_model(model: GridGP) -> None:
    data = functions.factorial(COUNTS)
    shuffled = data.isel(mixture=slice(None, None, -1), size=[2, 0, 4, 1, 3]).transpose("force", "bias", ...)
    again = GridGP(inputs=functions.INPUTS).fit(shuffled)
    X = np.array([list(MIDDLE.values())])
    np.testing.assert_allclose(again.predict_array(X), model.predict_array(X), rtol=1e-13)  # sums in another order


@pytest.mark.parametrize(("level", "deviations"), [(0.95, 1.959963984540054), (0.5, 0.6744897501960817)])
def test_uncalibrated_intervals_are_those_of_a_normal_distribution(
    model: GridGP, level: float, deviations: float
) -> None:
    answer, interval = model.predict(MIDDLE), model.interval(MIDDLE, level)
    words = f"lower end of the {100 * level:g} % interval of the smooth output"
    assert interval["smooth_lower"].attrs == {"units": "Pa", "long_name": words}
    for name in model.outputs_:
        mean, half = float(answer[name]), deviations * float(answer[f"{name}_std"])
        ends = [float(interval[f"{name}_{end}"]) for end in ("lower", "upper")]
        assert ends == pytest.approx([mean - half, mean + half], rel=1e-14)


def test_quantiles_are_labelled_and_those_of_intervals(model: GridGP) -> None:
    points = {**MIDDLE, "angle": [0.1, 0.2, 0.4]}
    ends, upper = model.quantile(points, [0.025, 0.975]), model.quantile(points, 0.975)
    assert ends["smooth"].dims == ("quantile", "angle")
    assert upper["smooth"].dims == ("angle",)
    assert ends["smooth"].attrs == model.predict(points)["smooth"].attrs
    np.testing.assert_allclose(ends["smooth"][1], upper["smooth"], rtol=0, atol=0)
    np.testing.assert_allclose(ends["smooth"][0], model.interval(points)["smooth_lower"], rtol=1e-14)


@pytest.mark.parametrize("level", [0.0, 1.0, float("nan")])
def test_levels_that_are_none_are_refused(model: GridGP, level: float) -> None:
    for ask in (model.interval, partial(model.gradient, return_std=True)):
        assert_refused(ValueError, f"level {level:g} is not between 0 and 1", ask, MIDDLE, level=level)
    assert_refused(ValueError, r"q 2 is not between", model.quantile, MIDDLE, [0.5, 2.0])


def test_gradient_is_labelled(model: GridGP) -> None:
    slopes = model.gradient({**MIDDLE, "angle": [0.1, 0.2]}, return_std=True)
    assert list(slopes.data_vars) == [
        f"{name}{part}" for name in model.outputs_ for part in ("", "_std", "_lower", "_upper")
    ]
    assert slopes["smooth"].dims == ("input", "angle")
    assert slopes["input"].values.tolist() == list(model.box)
    assert slopes["input_units"].sel(input="force") == "N"
    assert slopes["smooth"].attrs["units"] == "(Pa) / input_units"
    assert model.gradient({**MIDDLE, "angle": np.array([])})["smooth"].shape == (len(model.box), 0)


def test_a_model_must_be_fitted_and_its_score_is_r2(model: GridGP) -> None:
    assert_refused(NotFittedError, "is not fitted yet; call fit first", GridGP().predict, {})
    held = functions.scattered(500, seed=3)
    points = held[[input_.name for input_ in functions.INPUTS]]
    mean = model.predict(points)
    by_hand = [
        1 - float(((mean[n] - held[n]) ** 2).sum() / ((held[n] - held[n].mean()) ** 2).sum()) for n in model.outputs_
    ]
    assert model.score(held) == pytest.approx(np.mean(by_hand), abs=1e-12)
    assert model.score(points, held[list(model.outputs_)]) == model.score(held)
    assert model.score(functions.factorial(COUNTS)) == pytest.approx(1, abs=1e-12)


def test_printed_it_says_inputs_outputs_box_cases_and_calibration() -> None:
    x, y = Input("x", 0.0, 1.0, units="m"), Input("force", 1.0, 10.0, "log")
    data = functions.grid((x, y), (4, 3))
    model = GridGP(inputs=[x, y])
    assert str(model) == "GridGP, not fitted yet"
    model.fit(data.assign(f=(data.x * data.force).assign_attrs(units="Pa"), g=data.x + data.force))
    assert str(model).splitlines() == [
        "GridGP of 2 outputs over 2 inputs, trained on 12 cases",
        "inputs:",
        "  x      [0, 1] m, linear",
        "  force  [1, 10], log",
        "outputs: f [Pa], g",
        "intervals: not calibrated",
    ]
    cases = functions.drawn((x, y), 50, seed=0)
    model.calibrate(cases.assign(f=cases.x * cases.force, g=cases.x + cases.force))
    assert str(model).endswith("intervals: calibrated on 50 cases")


def test_a_model_has_a_level_of_its_own(model: GridGP, tmp_path: Path) -> None:
    narrower = deepcopy(model)
    narrower.level_ = 0.8
    save(narrower, tmp_path / "narrower.nc")
    for known in (narrower, load(tmp_path / "narrower.nc")):
        xr.testing.assert_identical(known.interval(MIDDLE), model.interval(MIDDLE, 0.8))
        xr.testing.assert_identical(known.gradient(MIDDLE, True), model.gradient(MIDDLE, True, level=0.8))
        plain = exported(known)
        assert plain is not None
        assert plain["interval"]["level"] == 0.8
    narrower.level_ = 2.0
    save(narrower, tmp_path / "wrong.nc")
    assert_refused(FormatError, "level 2 is not between 0 and 1", load, tmp_path / "wrong.nc")


@pytest.fixture(scope="module")
def product() -> GridGP:
    """The model of f = x y."""
    inputs = Input("x", 0.0, 1.0), Input("y", 1.0, 2.0)
    grid = functions.grid(inputs, (4, 3))
    return GridGP(inputs).fit(grid.assign(f=grid.x * grid.y))


def test_masked_and_missing_cells_are_refused_as_nan_is(product: GridGP) -> None:
    """A masked cell has a value behind it, as 1e20: of sequences, arrays, labelled arrays, tables and cases."""
    column = np.ma.masked_array([0.5, 0.25], [False, True])
    matrix = np.ma.masked_array([[0.5, 1.5], [0.25, 1.5]], [[False, False], [True, False]])
    nullable = pd.DataFrame({"x": pd.array([0.5, None], dtype="Float64"), "y": [1.5, 1.5]})
    rows = [{"x": 0.5, "y": 1.5}, {"y": 1.5}]
    labelled = {"x": xr.DataArray(column, dims="case"), "y": 1.5}
    for points in ({"x": column, "y": 1.5}, {"x": [0.5, np.ma.masked], "y": 1.5}, matrix, nullable, rows, labelled):
        assert_refused(ValueError, "'x' is nan at 1 of 2 points; give finite values", product.predict, points)
    cases = np.random.default_rng(0).uniform(0, 1, (12, 2))
    hidden = np.ma.masked_array(cases, np.arange(24).reshape(12, 2) == 5)
    values = np.ma.masked_array(cases[:, 0], np.arange(12) == 3)
    for X, y in ((hidden, cases[:, 0]), (cases, values)):
        with pytest.raises(ValueError, match="NaN"):  # scikit-learn says so in several lines
            FactorialRegressor().fit(X, y)
    x = product.box["x"]
    output = np.ma.masked_array(np.ones(4), [False, False, True, False])
    assert_refused(ValueError, "not finite", GridGP([x]).fit, xr.Dataset({"f": ("x", output)}, {"x": x.levels(4)}))


def test_the_rows_of_tables_are_points(product: GridGP) -> None:
    frame = pd.DataFrame({"y": [1.5, 2.0], "x": [0.5, 0.25]}, index=["first", "second"])
    answer = product.predict(frame)
    assert answer["f"].dims == ("case",)
    assert answer["case"].values.tolist() == ["first", "second"]
    np.testing.assert_allclose(answer["f"], [0.75, 0.5], rtol=1e-9)
    columns = product.predict({"x": frame["x"], "y": frame["y"]})
    assert columns["f"].identical(answer["f"])
    with pytest.raises(ValueError, match=r"^y: its rows are not those of x: Series are columns of one table"):
        product.predict({"x": frame["x"], "y": frame["y"].iloc[::-1]})
    np.testing.assert_array_equal(product.predict(frame.to_dict("records"))["f"], answer["f"])


@pytest.mark.parametrize(("scale", "middle"), [("linear", 0.46), ("log", 0.018**0.5), ("logit", 3 / 10)])
def test_a_scale_maps_there_and_back_with_its_slope(scale: str, middle: float) -> None:
    input_ = Input("x", 0.02, 0.9, scale)  # type: ignore[arg-type]  # parametrised by plain strings
    x, step = np.linspace(0.05, 0.85, 7), 1e-7
    difference = (input_.to_unit(x + step) - input_.to_unit(x - step)) / (2 * step)
    np.testing.assert_allclose(input_.unit_slope(x), difference, rtol=1e-6)
    np.testing.assert_allclose(input_.from_unit(input_.to_unit(x)), x, rtol=1e-14)
    assert input_.from_unit(-1) == 0.02
    assert input_.from_unit(1) == 0.9
    assert input_.from_unit(0.0) == pytest.approx(middle, rel=1e-13)  # of odds 1/49 and 9: 3/7
