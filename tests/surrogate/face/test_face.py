"""Named inputs with their scales, named outputs, and refusals in one line, for every engine."""

import re
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from sklearn.exceptions import NotFittedError

from solver import solve
from surrogate import (
    FactorialRegressor,
    FormatError,
    GridGP,
    Group,
    GroupedGP,
    Input,
    OutOfBoxError,
    Scaling,
    ScatterGP,
    load,
    save,
)
from surrogate.data.points import named_points
from surrogate.gp import imputation
from surrogate.gp.factors import Factor
from surrogate.levels.counts import choose, decays
from surrogate.use.export import exported
from surrogate.use.inversion import Inversion
from tests.refusals import assert_refused
from tests.surrogate import functions, grouped
from tests.surrogate.grouped import GROUPING, GROUPS, PRESSING, SCALINGS
from tests.surrogate.use import test_validation
from tests.surrogate.use.test_estimator import LEVELS, factorial, fresh

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


@cache
def small() -> GridGP:
    return GridGP(inputs=functions.INPUTS).fit(functions.factorial((4, 3, 3, 3, 2)))


def fit(change: Callable[[xr.Dataset], xr.Dataset] = lambda data: data, **options: Any) -> object:
    return GridGP(inputs=functions.INPUTS, **options).fit(change(functions.factorial((5, 3, 3, 3, 2))))


def scatter(change: Callable[[xr.Dataset], xr.Dataset]) -> object:
    cases = functions.scattered(10, seed=0)[["mixture", "size", "ratio", "no_bias"]]
    return ScatterGP(inputs=[functions.INPUTS[0], functions.INPUTS[2]]).fit(change(cases))


def calibrate(change: Callable[[xr.Dataset], xr.Dataset]) -> object:
    return small().calibrate(change(functions.scattered(60, seed=1)))


def regress(X: Any, **options: Any) -> object:
    return FactorialRegressor(**options).fit(X, X[:, 0])


def group(scaling: Scaling, **coordinates: float) -> object:
    grouping = replace(GROUPING, scalings={**SCALINGS, "voltage": scaling})
    return GroupedGP(grouping).fit(grouped.factorial().assign_coords(coordinates))


@cache
def inversion(names: tuple[str, ...], output: str = "u", **known: float) -> Inversion:
    return Inversion(test_validation.model("linear"), names, [output], known)


def read(value: float, error: float) -> object:
    return inversion(("a",), b=1.0, c=0.25).estimate(np.array([value]), np.array([error]))


def levels(tolerance: float, budget: int) -> object:
    return choose(decays(functions.factorial((5, 3, 3, 3, 2)), functions.INPUTS), tolerance, budget)


#: Each with words of its refusal; " ... " stands for any others.
POINTS: list[tuple[Any, str]] = [
    (MIDDLE | {"siez": 0.1}, "unknown input 'siez'; did you mean 'size'?"),
    ({name: value for name, value in MIDDLE.items() if name != "size"}, "input 'size' is missing"),
    (MIDDLE | {"angle": float("nan")}, "input 'angle' is nan at 1 of 1 points"),
    (MIDDLE | {"angle": "0.1"}, "input 'angle' must be numbers"),
    (MIDDLE | {"angle": [[0.1]]}, "input 'angle' is an array of 2 dimensions"),
    (MIDDLE | dict.fromkeys(("angle", "size"), np.zeros(10**5)),
     "the inputs span 10000000000 points, more than 10000000"),
    (MIDDLE | {"angle": xr.DataArray([0.1], dims="size")}, "input 'angle' has a dimension of an input's name, 'size'"),
    (MIDDLE | {"angle": xr.DataArray([0.1], dims="c"), "size": xr.DataArray([0.1, 0.1], dims="c")}, "do not agree"),
    (np.zeros((3, 4)), "the columns mixture, angle, size, force, bias; got float64 values of shape (3, 4)"),
    (xr.DataArray(np.zeros((5, 5)), dims=("input", "point")), "points must be named"),
    (pd.DataFrame({"size": [0.1]})[["size", "size"]], "the table of points has a column twice"),
]  # fmt: skip
GROUPINGS: list[tuple[dict[str, Any], str]] = [
    ({"groups": GROUPS[:2]}, "input 'charge' is in no group and no scale"),
    ({"groups": (*GROUPS, Group(Input("x", 0, 1), {"heat": 1.0}))}, "'heat' is no input"),
    ({"groups": (*GROUPS[:2], Group(Input("root", 0, 1), {"charge": 0.5}))}, "'charge' from -2e-06 on has no such"),
    ({"groups": (GROUPS[0], Group(Input("pressing", 1e9, 2e9), PRESSING), GROUPS[2])}, "beyond its range"),
    ({"scalings": {"f": Scaling({"charge": 1.0})}}, "the scale of f: 'charge'"),
    ({"added": {"charge": 1.0}}, "the added logarithm: 'charge'"),
]
RANGES: list[tuple[float, float, Any, str]] = [
    (1, 1, "linear", "'radius' ... low 1 must be less than high 1"),
    (0, 1, "log", "'radius' ... log scale needs low > 0"),
    (0, 0.9, "logit", "'radius' ... a logit scale needs 0 < low and high < 1, got [0, 0.9]"),
    (float("nan"), 1, "linear", "'radius' ... finite"),
    (0, 1, "cubic", "'radius' ... 'cubic' is none of linear, log"),
]
REFUSED: list[tuple[Callable[[], object], str]] = [
    *((lambda points=points: small().predict(points), says) for points, says in POINTS),
    *((lambda change=change: replace(GROUPING, **change), says) for change, says in GROUPINGS),
    *((lambda low=low, high=high, scale=scale: Input("radius", low, high, scale), says)
      for low, high, scale, says in RANGES),
    # factorials
    (lambda: fit(lambda d: d.assign(smooth=d["smooth"].where(d["size"] > 0.01))), "output 'smooth' is not finite in"),
    (lambda: fit(lambda d: d.isel(size=[0, 2])), "input 'size': level"),
    (lambda: fit(lambda d: d.isel(size=[0, 1, 1])), "input 'size' has the level 0.0316228 more than once"),
    (lambda: fit(lambda d: d.rename(size="radius")), "has dimension 'radius', which is no input"),
    (lambda: fit(lambda d: d.drop_vars("size")), "input 'size' has no coordinate"),
    (lambda: fit(lambda d: d.assign(smooth=d["smooth"].astype(str))), "output 'smooth' must be numbers"),
    (lambda: fit(lambda d: d.isel(size=[1])), "input 'size' has 1 level; a factor needs at least 2"),
    (lambda: fit(hyperparameters={"mixture": 1.5}), "rho must lie between 0 and 1, got 1.5"),
    (lambda: fit(hyperparameters={"colour": 0.5}), "hyperparameters name 'colour', which is no input"),
    # scattered cases, alone and to calibrate with
    (lambda: scatter(lambda d: d.drop_vars("size")), "'size' is not in the data set"),
    (lambda: scatter(lambda d: d.assign(ratio=d.ratio.where(d.mixture < 0.5))), "'ratio' is not finite in"),
    (lambda: scatter(lambda d: d.assign(size=d["size"] * 100)), "outside its range [0.005, 0.2] m"),
    (lambda: scatter(lambda d: d.assign(ratio=d.ratio.expand_dims(t=2))), "'ratio' must be numbers over one dimension"),
    (lambda: scatter(lambda d: d.assign(ratio=("other", np.ones(3)))), "'ratio' is over 'other'"),
    (lambda: calibrate(lambda d: d.isel(case=slice(39))), "calibration needs at least 40 cases, got 39"),
    (lambda: calibrate(lambda d: d.drop_vars("ratio")), "'ratio' is not in the data set"),
    (lambda: calibrate(lambda d: d.assign(angle=d["angle"] + 1)), "outside the trained box"),
    (lambda: calibrate(lambda d: d.assign(ratio=d.ratio.where(d.angle < 0.5))), "'ratio' is not finite in a case"),
    # tables
    (lambda: regress(fresh(), design="grid"), "design 'grid' is none of auto, factorial, scattered"),
    (lambda: regress(factorial(LEVELS)[1:], design="factorial"),
     "the 209 cases are no factorial: the columns have 6 x 7 x 5 lev"),
    (lambda: regress(factorial([np.linspace(0, 1, 8), *LEVELS[1:]]), design="factorial"),
     "8 levels are no Chebyshev-Gauss levels"),
    (lambda: regress(np.column_stack([fresh(9), np.full(9, 2.5)])),
     "column 'x3' is 2.5 in all 9 cases; leave it out"),
    (lambda: regress(fresh(1)), "Found array with 1 sample(s)"),
    (lambda: regress(fresh(), inputs=[Input("a", 0, 1)]), "inputs has 1 entries for the 3 columns x0, x1, x2"),
    (lambda: regress(fresh(), inputs=[Input("a", 0, 1), Input("b", 1, 9), Input("c", -2, 3)]),
     "outside its range [1, 9]"),
    # cases that do not fit their groups
    (lambda: group(Scaling({"load": 1.0}, logarithm=1)),
     "output 'voltage' is from ... no logarithm of what changes sign"),
    (lambda: group(SCALINGS["voltage"], radius=0.03), "do not have its values of the axis 'pressing'"),
    # inversion
    (lambda: inversion(("d",)), "'d' is not an input"),
    (lambda: inversion(("a", "b")), "'c' must be either inferred or given"),
    (lambda: inversion(("a", "b"), "w", c=0.0), "'w' is not an output"),
    *((lambda value=value, error=error: read(value, error), "must be finite, their errors within 1e-150 to 1e+150")
      for value, error in ((1.0, 1e308), (1.0, 0.0), (np.inf, 1.0), (1.0, np.nan))),
    # holes of a factorial
    (lambda: imputation.expected([Factor(60, 0.3)] * 2, np.zeros((60, 60, 1)), np.add.outer(*[np.arange(60)] * 2) > 55),
     "places of the factors ... at most 2000 are filled in"),
    # numbers of levels
    *((lambda tolerance=tolerance, budget=budget: levels(tolerance, budget), "must be positive")
      for tolerance, budget in ((0.0, 10), (float("nan"), 10), (1e-3, 0))),
]  # fmt: skip


@pytest.mark.parametrize(("attempt", "says"), REFUSED, ids=[says for _, says in REFUSED])
def test_it_is_refused_in_one_line(attempt: Callable[[], object], says: str) -> None:
    assert_refused(ValueError, ".*".join(map(re.escape, says.split(" ... "))), attempt)
