"""Sensitivity indices against closed forms."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

from surrogate import GridGP, Input, ScatterGP
from surrogate.use.sensitivity import sobol
from tests.surrogate import functions


def ishigami() -> GridGP:
    inputs = [Input(name, -np.pi, np.pi) for name in ("x1", "x2", "x3")]
    levels = {input_.name: input_.levels(n) for input_, n in zip(inputs, (26, 30, 10), strict=True)}
    x = [xr.DataArray(values, dims=name, coords={name: values}) for name, values in levels.items()]
    f = np.sin(x[0]) + 7 * np.sin(x[1]) ** 2 + 0.1 * x[2] ** 4 * np.sin(x[0])
    return GridGP(inputs=inputs).fit(xr.Dataset({"f": f, "constant": 0 * x[0] + 3, "single": 2 * x[2] ** 2}))


def test_indices_of_the_ishigami_function_are_the_known_ones() -> None:
    # T. Ishigami and T. Homma (1990), a = 7, b = 0.1
    a, b, pi = 7.0, 0.1, np.pi
    v1, v2, v13 = 0.5 * (1 + b * pi**4 / 5) ** 2, a**2 / 8, b**2 * pi**8 * (1 / 18 - 1 / 50)
    whole = v1 + v2 + v13
    indices = sobol(ishigami()).sel(output="f")
    assert float(indices["mean"]) == pytest.approx(a / 2, rel=1e-10)
    assert float(indices["variance"]) == pytest.approx(whole, rel=1e-10)
    np.testing.assert_allclose(indices["first_order"], np.array([v1, v2, 0]) / whole, rtol=0, atol=1e-10)
    np.testing.assert_allclose(indices["total"], np.array([v1 + v13, v2, v13]) / whole, rtol=0, atol=1e-10)
    want = np.zeros((3, 3))
    want[0, 2] = want[2, 0] = v13 / whole
    np.testing.assert_allclose(indices["second_order"], want, rtol=0, atol=1e-10)


def test_main_effects_are_the_conditional_means() -> None:
    indices = sobol(ishigami()).sel(output="f")
    x = indices["value"]
    want: dict[str, Any] = {
        "x1": np.sin(x.sel(input="x1")) * (1 + 0.1 * np.pi**4 / 5),
        "x2": 7 * np.sin(x.sel(input="x2")) ** 2 - 3.5,
        "x3": 0 * x.sel(input="x3"),
    }
    for name, effect in want.items():
        np.testing.assert_allclose(indices["main_effect"].sel(input=name), effect, rtol=0, atol=1e-9)


def test_outputs_of_one_or_no_input_have_trivial_indices() -> None:
    indices = sobol(ishigami())
    np.testing.assert_allclose(indices["total"].sel(output="single"), [0, 0, 1], atol=1e-10)
    np.testing.assert_array_equal(indices["total"].sel(output="constant"), 0)


@pytest.fixture(scope="module")
def fine() -> GridGP:
    return GridGP(inputs=functions.INPUTS).fit(functions.factorial((22, 6, 6, 6, 2)))


def test_intervals_hold_the_indices_of_the_truth_on_a_coarse_grid(fine: GridGP) -> None:
    truth = sobol(fine)
    model = (
        GridGP(inputs=functions.INPUTS)
        .fit(functions.factorial((6, 3, 3, 3, 2)))
        .calibrate(functions.scattered(2000, seed=3))
    )
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
