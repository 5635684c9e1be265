"""Models as files: the same predictions again, every kind of wrong file refused, and little taken by what is read."""

import os
import resource
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from storage.described import described
from storage.netcdf import write_whole
from storage.quarantine import little_memory
from surrogate import FactorialRegressor, FormatError, GridGP, Input, load, save
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.face import persistence
from surrogate.face.persistence import MOST, check_sizes


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


ONE = Input("a", 0, 1)


def model() -> GridGP:
    """A sine over one input."""
    levels = ONE.levels(6)
    return GridGP([ONE]).fit(xr.Dataset({"y": ("a", np.sin(levels))}, coords={"a": levels}))


def with_levels(stored: xr.Dataset, count: int = 20_000) -> xr.Dataset:
    """A model's arrays with so many levels, of which a matrix has the square: 3.2 GB of a file of 160 kB."""
    core = ("rank_0", "mode_0", "output"), np.zeros((1, count, 1))
    stored = stored.drop_vars(["levels_0", "core_0"])
    return stored.assign(levels_0=("level_0", np.linspace(0, 1, count)), core_0=core)


def twice(stored: xr.Dataset) -> xr.Dataset:
    """A model's arrays with one output twice."""
    return stored.isel(output=[0, 0]).assign(probe_point=(("probe", "input"), [[0.5]]))


@pytest.mark.usefixtures("quarantined")
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (with_levels, r"inconsistent: level_0 is 20000 long; .* at most 1000"),
        (lambda stored: stored.assign(more=("many", np.zeros(2**23))), "too large: it unpacks to 671"),
        (twice, "inconsistent: output names must be unique"),
    ],
)
def test_a_small_file_that_would_fill_the_memory_or_names_twice_is_refused(
    change: Callable[[xr.Dataset], xr.Dataset], says: str, tmp_path: Path
) -> None:
    path, stored = tmp_path / "hostile.nc", change(persistence.nested(model()))
    stored.attrs |= {"format": persistence.FORMAT, "format_version": persistence.VERSION}
    write_whole(described(stored, "hostile", SOURCE, MEANINGS), path)
    assert path.stat().st_size < 2**19
    with pytest.raises(FormatError, match=rf"hostile\.nc: {says}"):
        load(path)


def test_levels_are_bounded_for_all_factors_together() -> None:
    with pytest.raises(ValueError, match="2700 levels of all factors; a model in a file has at most 2000"):
        check_sizes(xr.Dataset({f"levels_{k}": (f"smooth_level_{k}", np.zeros(900)) for k in range(3)}))


def test_what_is_made_of_a_file_has_little_memory_and_the_limit_goes_again(tmp_path: Path) -> None:
    before, path = resource.getrlimit(resource.RLIMIT_AS), tmp_path / "some.nc"
    with (
        pytest.raises(FormatError, match=r"some\.nc: too large: what is made of it takes more memory"),
        little_memory(path),
    ):
        np.zeros(2**32 + 2**27 * (os.cpu_count() or 1), dtype=np.uint8)  # untouched, a machine would grant it
    assert resource.getrlimit(resource.RLIMIT_AS) == before


def test_what_could_not_be_read_again_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(MOST, "output", 0)
    with pytest.raises(ValueError, match="output is 1 long"):
        save(model(), tmp_path / "y.nc")
    assert list(tmp_path.iterdir()) == []
