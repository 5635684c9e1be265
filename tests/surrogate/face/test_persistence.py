"""Models as files: the same predictions again, and every kind of wrong file refused."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest
import xarray as xr

from storage.netcdf import read_whole, write_whole
from storage.sealed import seal
from surrogate import FactorialRegressor, FormatError, GridGP, load, save
from tests.surrogate import functions


@pytest.mark.usefixtures("quarantined")
def test_a_calibrated_model_of_one_input_survives_its_file(tmp_path: Path) -> None:
    """It has no corners of two inputs: nothing of length zero stands in a file."""
    model = FactorialRegressor().fit(np.linspace(0, 1, 9)[:, None], np.exp(np.linspace(0, 1, 9))).model_
    t = np.random.default_rng(0).uniform(size=300)
    model.calibrate(xr.Dataset({"y0": ("case", np.exp(t))}, {"x0": ("case", t)}))
    save(model, tmp_path / "one.nc")
    again, points = load(tmp_path / "one.nc"), np.linspace(0, 1, 7)[:, None]
    np.testing.assert_array_equal(again.interval_array(points, 0.9), model.interval_array(points, 0.9))
    with netCDF4.Dataset(tmp_path / "one.nc") as file:
        assert "calibration_guard" in file.variables
        assert all(dimension.size for dimension in file.dimensions.values())


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("stored") / "model.nc"
    save(GridGP(functions.INPUTS).fit(functions.factorial((6, 4, 4, 3, 2))), path)
    return path.read_bytes()


def edit(path: Path, change: Callable[[xr.Dataset], xr.Dataset]) -> None:
    """Change a stored model and give it a valid checksum again."""
    write_whole(change(read_whole(path)), path)


def attribute(name: str, value: object) -> Callable[[xr.Dataset], xr.Dataset]:
    return lambda data: data.assign_attrs({name: value})


def replaced(name: str, value: Any) -> Callable[[xr.Dataset], xr.Dataset]:  # any array-like
    return lambda data: data.assign({name: data[name].copy(data=np.broadcast_to(value, data[name].shape))})


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (attribute("format", "other"), "not a surrogate model"),
        (attribute("format_version", 1), "format version 1 is not 4, the one known here: `make run` anew"),
        (attribute("engine", "torch"), "unknown engine 'torch'; known are grid, scatter, grouped, curves, "),
        (attribute("kernel", "__import__('os')"), "unknown kernel"),
        (lambda d: d.drop_vars("amplitude"), "inconsistent"),
        (lambda d: d.assign(core_0=d["core_0"][..., :1].rename(rank_1="cut")), "core 1 has the shape"),
        (lambda d: d.isel(mode_0=slice(2)), "do not come out again"),
        (lambda d: d.assign(core_0=d["core_0"].expand_dims("new")), "inconsistent"),
        (lambda d: d.isel(level_0=slice(1, None)), "Chebyshev-Gauss"),
        (replaced("core_1", np.nan), "not finite"),
        (replaced("variance", -1.0), "negative variance"),
        (replaced("hyperparameter", 1.5), "rho must lie between 0 and 1"),
        (replaced("contraction_order", 0), "is no order"),
        (replaced("scale", "cubic"), "'cubic' is none of linear, log"),
        (replaced("low", 1e9), "must be less than high"),
        (replaced("probe_mean", 0.0), "do not come out again"),
        (replaced("probe_std", 0.0), "do not come out again"),
        (lambda d: d.assign(core_2=d["core_2"] * 1.0001), "probe_mean do not come out again"),
        (lambda d: d.assign(variance=d["variance"] * 1.01), "probe_std do not come out again"),
    ],
)
def test_wrong_models_are_refused(
    change: Callable[[xr.Dataset], xr.Dataset], says: str, stored: bytes, tmp_path: Path
) -> None:
    path = tmp_path / "model.nc"
    path.write_bytes(stored)
    edit(path, change)
    with pytest.raises(FormatError, match=re.escape(says)) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("quarantined")
def test_a_model_that_unpacks_to_too_much_is_refused(stored: bytes, tmp_path: Path) -> None:
    path = tmp_path / "model.nc"
    path.write_bytes(stored)
    with netCDF4.Dataset(path, "a") as file:
        file.createDimension("huge", 2**36)
        file.createVariable("bomb", "f8", ("huge",), compression="zstd", chunksizes=(2**16,))
    seal(path)
    with pytest.raises(FormatError, match="too large"):
        load(path)
