"""Text files appear whole or not at all."""

import errno
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from storage.blocks import Region, write_blocks
from storage.files import write_bytes, write_text, writing
from storage.netcdf import checksum, read_whole, write_whole
from storage.sealed import PARTIAL

WRITERS: dict[str, Callable[[Path], None]] = {
    "text": lambda path: write_text(path, "a" * 10**6),
    "netcdf": lambda path: write_whole(xr.Dataset({"f": ("x", [float(k % 7919) ** 0.5 for k in range(10**5)])}), path),
}


@pytest.mark.parametrize(("mask", "mode"), [(0o022, 0o644), (0o077, 0o600)])
def test_a_text_has_the_permissions_of_any_new_file_and_of_a_netcdf_file(mask: int, mode: int, tmp_path: Path) -> None:
    before = os.umask(mask)
    try:
        for name, write in WRITERS.items():
            write(tmp_path / name)
    finally:
        os.umask(before)
    assert {(tmp_path / name).stat().st_mode & 0o777 for name in WRITERS} == {mode}


@pytest.mark.parametrize("name", WRITERS)
def test_a_write_that_has_no_room_names_the_final_file(name: str, tmp_path: Path) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**15, limits[1]))
    try:
        with pytest.raises(OSError, match="File too large") as caught:
            WRITERS[name](tmp_path / "a")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (caught.value.errno, caught.value.filename) == (errno.EFBIG, str(tmp_path / "a"))
    assert not list(tmp_path.iterdir())


def test_another_file_that_fails_during_a_write_keeps_its_name(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as caught, writing(tmp_path / "a.csv") as file:
        file.write((tmp_path / "absent.csv").read_bytes())
    assert caught.value.filename == str(tmp_path / "absent.csv")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_killed_writer_leaves_the_old_file_and_what_the_next_run_sweeps(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    write_bytes(path, b"old")
    code = (
        "import os, pathlib, signal, sys; from storage.files import writing\n"
        "with writing(pathlib.Path(sys.argv[1])) as file:\n"
        "    file.write(bytes(10**6)); os.kill(os.getpid(), signal.SIGKILL)"
    )
    assert subprocess.run([sys.executable, "-c", code, str(path)], check=False).returncode == -signal.SIGKILL
    assert path.read_bytes() == b"old"
    (left,) = set(tmp_path.iterdir()) - {path}
    assert left.name.startswith(".a.csv.")
    assert left.suffix == PARTIAL


RANDOM = np.random.default_rng(7)


def sample() -> xr.Dataset:
    """Two variables over shared axes, one with a further axis and in single precision, and coordinates of any kind."""
    shape = (6, 10, 8)
    return xr.Dataset(
        {
            "depth": (("a", "b", "c"), RANDOM.normal(3.0, 2.0, shape), {"units": "m"}),
            "field": (("a", "b", "c", "x"), RANDOM.normal(1e6, 1.0, (*shape, 12)).astype("f4"), {"units": "Pa"}),
        },
        coords={"a": np.arange(6.0), "b": np.arange(10), "x": np.linspace(0, 1, 12), "kind": "fibrous"},
        attrs={"title": "a sample"},
    )


def pieces(data: xr.Dataset) -> Iterator[tuple[Region, Mapping[str, NDArray[Any]]]]:
    for a in range(6):
        for b in (0, 5):
            region = (slice(a, a + 1), slice(b, b + 5), slice(0, 8))
            yield region, {str(name): array.values[region] for name, array in data.data_vars.items()}


@pytest.mark.parametrize("chunks", [{}, {"a": 1, "b": 5, "x": 4}, {"a": 1, "b": 3, "c": 3, "x": 5}])
def test_blocks_make_the_file_that_one_write_would_hold(chunks: dict[str, int], tmp_path: Path) -> None:
    data = sample()
    write_blocks(tmp_path / "a.nc", data, pieces(data), chunks)
    write_blocks(tmp_path / "b.nc", data, pieces(data), chunks)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
    stored = read_whole(tmp_path / "a.nc")  # verifies the checksum
    for name, array in data.data_vars.items():
        np.testing.assert_array_equal(stored[name].values, array.values)
        assert stored[name].dtype == array.dtype
        assert stored[name].attrs["units"] == array.attrs["units"]
        exact = array.values.astype(np.float64)
        assert stored[name].attrs["mean"] == pytest.approx(exact.mean(), rel=1e-12)
        assert stored[name].attrs["standard_deviation"] == pytest.approx(exact.std(), rel=1e-5)
        np.testing.assert_array_equal(stored[name].attrs["actual_range"], [exact.min(), exact.max()])
    assert stored.drop_vars(["depth", "field"]).equals(data.drop_vars(["depth", "field"]))
    assert stored.attrs["checksum"] == checksum(stored)


def test_what_is_missing_or_not_finite_leaves_no_file(tmp_path: Path) -> None:
    data = sample()
    with pytest.raises(ValueError, match="depth: 400 of 480 values given"):
        write_blocks(tmp_path / "a.nc", data, list(pieces(data))[:-2], {})
    data["depth"][3, 4, 5] = np.nan
    with pytest.raises(ValueError, match="depth: not finite in float64"):
        write_blocks(tmp_path / "a.nc", data, pieces(data), {})
    assert not list(tmp_path.iterdir())
