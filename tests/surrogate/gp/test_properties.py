"""Invariants of a grid process, over random factorials."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial.chebyshev import chebval

from surrogate import GridGP, Input
from tests.layers import SOAK

NAMES = ("x", "y", "z")
EXAMPLES = 100 if SOAK else 6


@st.composite
def boxes(draw: st.DrawFn) -> list[Input]:
    inputs = []
    for name in NAMES[: draw(st.integers(1, 3))]:
        low = draw(st.floats(1e-3, 1e3))
        high = low * (1 + draw(st.floats(0.1, 1e3)))
        inputs.append(Input(name, low, high, draw(st.sampled_from(["linear", "log"]))))
    return inputs


@st.composite
def factorials(draw: st.DrawFn) -> tuple[list[Input], xr.Dataset]:
    """Products of random polynomials in the scaled coordinates, of degree below the level count, plus a constant."""
    inputs = draw(boxes())
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = 10.0 ** draw(st.integers(-6, 9))
    data = xr.Dataset()
    for name in ("f", "g"):
        product: xr.DataArray = xr.DataArray(1.0)
        for input_ in inputs:
            count = draw(st.integers(2, 8)) if name == "f" else data.sizes[input_.name]
            levels = input_.levels(count)
            values = chebval(input_.to_unit(levels), rng.normal(size=rng.integers(1, count + 1)))
            product = product * xr.DataArray(values, dims=input_.name, coords={input_.name: levels})
        data[name] = size * (product + rng.normal())
    return inputs, data


def unit(inputs: list[Input], count: int) -> dict[str, xr.DataArray]:
    t = np.random.default_rng(0).uniform(-1, 1, (len(inputs), count))
    return {one.name: xr.DataArray(one.from_unit(row), dims="case") for one, row in zip(inputs, t, strict=True)}


def spread(data: xr.Dataset, name: str) -> float:
    return float(np.ptp(data[name].values)) + 1e-300


@pytest.mark.soakable
@given(factorials())
@settings(deadline=None, max_examples=EXAMPLES)
def test_the_data_are_met_and_nothing_is_unknown_there(case_data: tuple[list[Input], xr.Dataset]) -> None:
    inputs, data = case_data
    model = GridGP(inputs).fit(data)
    answer = model.predict({input_.name: data[input_.name] for input_ in inputs})
    between = model.predict(unit(inputs, 50))
    for p, name in enumerate(("f", "g")):
        room = 1e-9 * (spread(data, name) + 1e-6 * float(np.abs(data[name]).max()))
        np.testing.assert_allclose(answer[name], data[name].transpose(*answer[name].dims), rtol=0, atol=room)
        at_levels, scale = answer[f"{name}_std"], np.sqrt(model.variance_[p]) * model.scale_[p]
        assert bool((at_levels >= 0).all())
        assert bool((between[f"{name}_std"] >= 0).all())
        assert float(at_levels.max()) <= 1e-10 * scale * _prior(model, p)


def _prior(model: GridGP, p: int) -> float:
    """Largest prior standard deviation over the box at unit variance: at its corners."""
    product = 1.0
    for k, factor in enumerate(model.factors_):
        ends = factor.features(np.array([-1.0, 1.0]), 1).prior.max()
        product *= 1 + model.amplitude_[k, p] * ends
    return float(np.sqrt(product))
