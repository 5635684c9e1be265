"""The model of some outputs: the same answers for less."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

from surrogate import GridGP, Input, ScatterGP

BOX = [Input("a", 1.0, 3.0), Input("b", 0.1, 10.0, "log"), Input("c", -1.0, 1.0)]


def values(a: Any, b: Any, c: Any) -> dict[str, Any]:
    """Five outputs of different sizes, one of them constant."""
    return {
        "wave": np.sin(2 * a * c) / b, "rise": 1e9 * np.exp(a + c), "root": np.sqrt(a * b + 2 + c),
        "flat": 3.0 + 0 * a * b * c, "small": 1e-12 * a**2 * np.log(b),
    }  # fmt: skip


def table(points: dict[str, xr.DataArray]) -> xr.Dataset:
    """Inputs and outputs as a data set."""
    return xr.Dataset(values(**points)).assign_coords({k: v for k, v in points.items() if v.dims == (k,)})


@pytest.fixture(scope="module")
def model() -> GridGP:
    """Fitted to 9 x 11 x 8 cases and calibrated on 300."""
    axes = {
        input_.name: xr.DataArray(input_.levels(n), dims=input_.name) for input_, n in zip(BOX, (9, 11, 8), strict=True)
    }
    fitted = GridGP(inputs=BOX, compression=1e-10).fit(
        table({name: axis.assign_coords({name: axis}) for name, axis in axes.items()})
    )
    random = np.random.default_rng(1)
    scattered = {input_.name: xr.DataArray(input_.from_unit(random.uniform(-1, 1, 300)), dims="case") for input_ in BOX}
    return fitted.calibrate(xr.Dataset({**scattered, **values(**scattered)}))


@pytest.mark.parametrize("outputs", [["root"], ["small", "wave"], ["flat"], ["small", "flat", "root", "rise", "wave"]])
def test_a_part_answers_as_the_whole(model: GridGP, outputs: list[str]) -> None:
    random = np.random.default_rng(2)
    points = {one.name: xr.DataArray(one.from_unit(random.uniform(-1, 1, 500)), dims="case") for one in BOX}
    part = model.only(outputs)
    answer, whole = part.predict(points), model.predict(points)
    assert list(answer.data_vars) == [one for name in outputs for one in (name, f"{name}_std")]
    slopes, all_slopes = part.gradient(points, return_std=True), model.gradient(points, return_std=True)
    for name in outputs:
        size = float(whole[name].std()) or 1.0
        np.testing.assert_allclose(answer[name], whole[name], rtol=0, atol=2e-9 * size)
        for one, other in ((answer, whole), (slopes, all_slopes)):
            np.testing.assert_allclose(one[f"{name}_std"], other[f"{name}_std"], rtol=1e-12, atol=0)
        for one, other in zip(slopes[name].values, all_slopes[name].values, strict=True):
            assert np.abs(one - other).max() <= 1e-7 * np.abs(other).max() + 1e-12 * size
    assert model.outputs_ == ("wave", "rise", "root", "flat", "small")  # the model itself stays


def test_a_scattered_model_answers_no_less() -> None:
    random = np.random.default_rng(3)
    points = {one.name: xr.DataArray(one.from_unit(random.uniform(-1, 1, 40)), dims="case") for one in BOX}
    model = ScatterGP(inputs=BOX, outputs=["wave", "root"]).fit(xr.Dataset({**points, **values(**points)}))
    at = {"a": 2.0, "b": 1.0, "c": 0.1}
    assert float(model.only(["root"]).predict(at)["root"]) == float(model.predict(at)["root"])
