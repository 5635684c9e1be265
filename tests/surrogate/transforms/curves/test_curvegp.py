"""Largest values of curves against dense sampling, their derivatives, intervals and files."""

from copy import deepcopy

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import minimize

from approximation.chebyshev import gauss_points
from approximation.measure import Measure
from approximation.panels import Panels
from surrogate import CurveGP
from surrogate.transforms.curves.basis import Basis
from surrogate.transforms.curves.landscape import Landscape
from surrogate.transforms.groups import Scaling
from surrogate.use import validation
from surrogate.use.sensitivity import sobol
from tests.surrogate import functions
from tests.surrogate.curved import INPUTS, OUTPUTS, data, fields, fitted, fitted_over_groups

Array = NDArray[np.float64]


def truth(a: Array, b: Array) -> tuple[Array, Array]:
    """The largest norm and its x, by sampling and a search from the highest sample of either half; (n,) each."""
    x, y = np.linspace(-1, 1, 161), np.linspace(0, 1, 41)
    maxima = []
    for first, other in zip(a.tolist(), b.tolist(), strict=True):

        def lowered(place: Array, first: float = first, other: float = other) -> float:
            return -float(np.hypot(*fields(first, other, place[0], place[1])))

        grid = np.hypot(*fields(first, other, x[None], y[:, None]))
        tops = []
        for half in (slice(0, 81), slice(81, None)):
            row, column = np.unravel_index(grid[:, half].argmax(), grid[:, half].shape)
            start = np.array([x[half][column], y[row]])
            tops.append(minimize(lowered, start, bounds=[(-1, 1), (0, 1)], tol=1e-13))
        best = min(tops, key=lambda top: float(top.fun))
        maxima.append((-best.fun, best.x[0]))
    values = np.array(maxima).T
    return values[0], values[1]


@pytest.fixture(scope="module")
def cases() -> xr.Dataset:
    x = functions.drawn(INPUTS, 160, seed=1)
    top, place = truth(x.a.values, x.b.values)
    return data(x.a, x.b).assign(a=x.a, b=x.b, top=("case", top), place=("case", place))


@pytest.fixture(scope="module")
def model() -> CurveGP:
    return fitted()


def test_maxima_and_places_are_right_where_they_jump(model: CurveGP, cases: xr.Dataset) -> None:
    answer = model.predict({name: cases[name] for name in "ab"}, return_std=False)
    assert np.ptp(cases["place"].values) > 0.9  # both hills are among the cases
    assert answer["top"].values == pytest.approx(cases["top"].values, abs=3e-5)
    assert answer["place"].values == pytest.approx(cases["place"].values, abs=3e-3)
    assert answer["plain"].values == pytest.approx(cases["plain"].values, rel=1e-4)


def test_groups_may_stand_behind_the_curves(model: CurveGP, cases: xr.Dataset) -> None:
    over, points = fitted_over_groups(), {name: cases[name] for name in "ab"}
    answer, plain = (process.predict(points, return_std=False) for process in (over, model))
    xr.testing.assert_allclose(answer["top"], plain["top"], rtol=1e-4)
    assert over.grouping is not None
    assert over.grouping.scalings["top"] == Scaling({"b": 1.0})  # as the size does
    held, fresh = cases.isel(case=slice(100)), cases.isel(case=slice(100, None))
    over.calibrate(held)
    table = validation.validate(over, fresh[["a", "b", *OUTPUTS]], None)
    assert table["coverage"].values.min() >= 0.85


def test_intervals_hold_with_and_without_curves_of_the_held_out_cases(model: CurveGP, cases: xr.Dataset) -> None:
    held, fresh = cases.isel(case=slice(100)), cases.isel(case=slice(100, None))
    for calibration_cases in (held, held[["a", "b", *OUTPUTS]]):
        again = deepcopy(model).calibrate(calibration_cases)
        table = validation.validate(again, fresh[["a", "b", *OUTPUTS]], None)
        assert table["coverage"].values.min() >= 0.85
        assert bool((table["max_error"] <= 1.5 * table["raw_max_error"] + 1e-9).all())


def test_effects_are_those_of_the_inputs(model: CurveGP) -> None:
    """exp(a) b: the variances by hand, a uniform and b log-uniform."""
    indices = sobol(model).sel(output="plain")
    a = np.array([np.sinh(1), np.sinh(2) / 2 - np.sinh(1) ** 2])
    b = np.array([1.5, 1.875 - 1.5**2 / np.log(4)]) / np.log(4)
    first = np.array([a[1] * b[0] ** 2, b[1] * a[0] ** 2])
    assert indices["first_order"].values == pytest.approx(first / (first.sum() + a[1] * b[1]), abs=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_the_search_finds_the_highest_of_many_hills(seed: int) -> None:
    random, panels = np.random.default_rng(seed), Panels((24, 24, 24))
    scores = random.normal(size=(6, 40)) / np.arange(1, 7)[:, None]
    x = np.concatenate([gauss_points(24) + 2 * k for k in (-1, 0, 1)])
    shapes = np.stack([np.cos(k * x + k**2) for k in range(1, 7)])
    basis = Basis(np.zeros((1, x.size)), shapes[:, None], np.ones(1))
    sizes = Measure(np.array([[1.0], [-0.7]]), np.zeros((2, 1, 1)))
    summit = Landscape(basis, panels).summit(scores, sizes)
    fine = np.linspace(-3, 3, 60_001)
    curves = scores.T @ np.stack([np.cos(k * fine + k**2) for k in range(1, 7)])
    assert summit.value == pytest.approx(np.maximum(curves, -0.7 * curves).max(axis=1), abs=2e-7)
