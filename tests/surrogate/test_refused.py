"""What is no input, point, case, group or request is refused in one line that names what is wrong, by every model."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from surrogate import FactorialRegressor, GridGP, Group, GroupedGP, Input, Scaling, ScatterGP
from surrogate.gp import imputation
from surrogate.gp.factors import Factor
from surrogate.levels.counts import choose, decays
from surrogate.use.inversion import Inversion
from tests.refusals import assert_refused
from tests.surrogate import functions, grouped
from tests.surrogate.grouped import GROUPING, GROUPS, PRESSING, SCALINGS
from tests.surrogate.use import test_inversion
from tests.surrogate.use.test_estimator import LEVELS, factorial, fresh

MIDDLE = {"mixture": 0.5, "angle": 0.3, "size": 0.05, "force": 3e4, "bias": 0.0}


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
    return Inversion(test_inversion.model("linear"), names, [output], known)


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
