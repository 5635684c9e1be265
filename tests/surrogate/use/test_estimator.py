"""The regressor is one of scikit-learn's, and takes a factorial for what it is."""

import re
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.model_selection import GridSearchCV, KFold, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import check_estimator, estimator_checks_generator

from surrogate import FactorialRegressor, GridGP, Input, OutOfBoxError, ScatterGP, chebyshev_levels

Array = NDArray[np.float64]

# These fit two hundred cases of ten columns, six to fifteen times: left to `make soak`.
SLOW = {
    "check_positive_only_tag_during_fit",
    "check_regressor_data_not_an_array",
    "check_regressors_int",
    "check_regressors_train",
}
LEVELS = [chebyshev_levels(0, 1, 6), chebyshev_levels(1, 50, 7, "log"), chebyshev_levels(-2, 3, 5)]


def truth(X: Array) -> Array:
    return np.exp(0.5 * X[:, 0]) * np.log(X[:, 1]) + 0.1 * X[:, 2]


def factorial(levels: list[Array]) -> Array:
    X = np.stack(np.meshgrid(*levels, indexing="ij"), axis=-1).reshape(-1, len(levels))
    return np.random.default_rng(0).permutation(X)


def fresh(count: int = 50) -> Array:
    return np.random.default_rng(1).uniform([0.1, 2, -1], [0.9, 40, 2], (count, 3))


def table(X: Array, names: list[str]) -> Any:
    """A pandas DataFrame."""
    return xr.Dataset({name: ("row", column) for name, column in zip(names, X.T, strict=True)}).to_dataframe()


@pytest.mark.soak
def test_every_check_of_scikit_learn_passes() -> None:
    found = check_estimator(FactorialRegressor(), on_skip=None)
    assert {one["check_name"] for one in found if one["status"] != "passed"} <= {"check_array_api_input"}


def test_the_checks_of_scikit_learn_pass() -> None:
    names = set()
    for estimator, check in estimator_checks_generator(FactorialRegressor()):
        name = check.func.__name__
        names.add(name)
        if name not in SLOW | {"check_array_api_input"}:
            check(estimator)
    assert names >= SLOW
    assert len(names) > 40


def test_a_factorial_in_any_order_is_the_grid_model_of_its_data_set() -> None:
    X = factorial(LEVELS)
    both = np.stack([truth(X), X[:, 0] ** 2], axis=1)
    model = FactorialRegressor().fit(X, both)
    assert isinstance(model.model_, GridGP)
    assert model.model_.kernel == "chebyshev"
    assert [one.scale for one in model.model_.inputs_] == ["linear", "log", "linear"]
    axes = {f"x{k}": levels for k, levels in enumerate(LEVELS)}
    a, b, c = xr.broadcast(*(xr.DataArray(values, dims=name, coords={name: values}) for name, values in axes.items()))
    own = GridGP().fit(xr.Dataset({"f": np.exp(0.5 * a) * np.log(b) + 0.1 * c, "g": a**2}))
    mean, std = model.predict(fresh(), return_std=True)
    wanted = own.predict_array(fresh(), return_std=True)
    np.testing.assert_allclose(mean, wanted[0], rtol=1e-11)
    np.testing.assert_allclose(std, wanted[1], rtol=1e-6)
    single = FactorialRegressor().fit(X, truth(X))
    assert single.predict(fresh(3)).shape == (3,)
    np.testing.assert_allclose(single.predict(fresh()), truth(fresh()), atol=1e-4)


@pytest.mark.parametrize(
    ("X", "engine", "kernel"),
    [
        (factorial([np.array([0.0, 0.3, 1.0]), np.array([1.0, 7.0, 50.0]), np.array([-2.0, 3.0])]), GridGP, "matern52"),
        (fresh(30), ScatterGP, "auto"),
        (fresh(9)[:, :1], GridGP, "matern52"),  # distinct values of one column are its levels
    ],
    ids=["other levels", "scattered", "one column"],
)
def test_the_cases_decide_the_engine(X: Array, engine: type, kernel: str) -> None:
    model = FactorialRegressor(nugget=1e-8).fit(X, X[:, 0])
    assert isinstance(model.model_, engine)
    assert getattr(model.model_, "kernel", "") == kernel
    np.testing.assert_allclose(model.predict(X), X[:, 0], atol=1e-4)


@pytest.mark.parametrize(
    ("change", "X", "says"),
    [
        ({"design": "grid"}, fresh(), "design 'grid' is none of auto, factorial, scattered"),
        ({"kernel": "cubic"}, fresh(), "kernel 'cubic' is none of auto, rbf, matern32, matern52, chebyshev"),
        (
            {"design": "factorial"},
            factorial(LEVELS)[1:],
            "the 209 cases are no factorial: the columns have 6 x 7 x 5 lev",
        ),
        ({}, np.column_stack([fresh(9), np.full(9, 2.5)]), "column 'x3' is 2.5 in all 9 cases; leave it out"),
        ({}, fresh(1), "Found array with 1 sample(s)"),
        ({"inputs": [Input("a", 0, 1)]}, fresh(), "inputs has 1 entries for the 3 columns x0, x1, x2"),
        (
            {"inputs": [Input("a", 0, 1), Input("b", 1, 9), Input("c", -2, 3)]},
            fresh(),
            "outside its range [1, 9]",
        ),
    ],
)
def test_bad_cases_are_refused_in_one_line(change: dict[str, Any], X: Array, says: str) -> None:
    with pytest.raises(ValueError, match=re.escape(says)) as caught:
        FactorialRegressor(**change).fit(X, X[:, 0])
    assert "\n" not in str(caught.value)


def test_tables_name_the_inputs_and_own_names_do_not_clash() -> None:
    names = ["case", "y0", "point"]
    model = FactorialRegressor(design="scattered").fit(table(fresh(30), names), truth(fresh(30)))
    assert model.feature_names_in_.tolist() == list(model.model_.box) == names
    assert model.model_.outputs_ == ("y0_",)
    np.testing.assert_allclose(model.predict(table(fresh(30), names)), truth(fresh(30)), atol=1e-4)
    with pytest.raises(ValueError, match="feature names"):
        model.predict(table(fresh(30), names[::-1]))


def test_pipelines_searches_and_copies_work() -> None:
    X = fresh(60)
    scores = cross_val_score(make_pipeline(StandardScaler(), FactorialRegressor()), X, truth(X), cv=3)
    assert scores.min() > 0.95
    folds = KFold(2, shuffle=True, random_state=0)
    search = GridSearchCV(FactorialRegressor(), {"kernel": ["matern32", "rbf"]}, cv=folds).fit(X, truth(X))
    assert search.best_params_ == {"kernel": "rbf"}  # the smooth function wants the smooth kernel
    best = search.best_estimator_
    assert clone(best).get_params() == best.get_params()


def test_points_outside_are_answered_unless_refused() -> None:
    X = factorial(LEVELS)
    beyond = np.array([[1.01, 10.0, 0.0]])
    np.testing.assert_allclose(FactorialRegressor().fit(X, truth(X)).predict(beyond), truth(beyond), atol=1e-3)
    with pytest.raises(OutOfBoxError, match=re.escape("x0 = 1.01 is outside the trained box")):
        FactorialRegressor(extrapolate=False).fit(X, truth(X)).predict(beyond)


def test_double_rows_count_once_and_missing_ones_are_told() -> None:
    X = factorial(LEVELS)
    whole = FactorialRegressor().fit(X, truth(X))
    doubled = np.concatenate([X, X[:3]])
    again = FactorialRegressor().fit(doubled, truth(doubled))
    assert isinstance(again.model_, GridGP)
    np.testing.assert_allclose(again.predict(fresh()), whole.predict(fresh()), rtol=1e-12)
    y = truth(doubled)
    y[-1] += 0.1  # noise: no interpolation of it
    assert isinstance(FactorialRegressor().fit(doubled, y).model_, ScatterGP)
    for some in (X[1:], X[[1, *range(1, 210)]]):  # the second: as many cases as combinations, but one of them twice
        with pytest.warns(UserWarning, match="1 of the 210 combinations of 6 x 7 x 5 levels are missing"):
            assert isinstance(FactorialRegressor().fit(some, truth(some)).model_, ScatterGP)
