"""Text files appear whole or not at all."""

import errno
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

from storage.files import write_bytes, write_text, writing
from storage.netcdf import read_whole, write_whole
from storage.sealed import PARTIAL, FormatError, check_seal, sha256

WRITERS: dict[str, Callable[[Path], None]] = {
    "text": lambda path: write_text(path, "a" * 10**6),
    "netcdf": lambda path: write_whole(xr.Dataset({"f": ("x", [float(k % 7919) ** 0.5 for k in range(10**5)])}), path),
}


def test_a_failed_write_leaves_the_old_file_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "old")
    with pytest.raises(UnicodeEncodeError):
        write_text(path, "new \ud800")
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("mask", "mode"), [(0o022, 0o644), (0o077, 0o600)])
def test_a_text_has_the_permissions_of_any_new_file_and_of_a_netcdf_file(mask: int, mode: int, tmp_path: Path) -> None:
    before = os.umask(mask)
    try:
        for name, write in WRITERS.items():
            write(tmp_path / name)
    finally:
        os.umask(before)
    assert {(tmp_path / name).stat().st_mode & 0o777 for name in WRITERS} == {mode}


def test_netcdf_files_are_sealed_and_texts_are_not(tmp_path: Path) -> None:
    for name, write in WRITERS.items():
        write(tmp_path / name)
    content = (tmp_path / "netcdf").stat().st_size - 48
    assert check_seal(tmp_path / "netcdf", 2**30) == sha256(tmp_path / "netcdf", content).hex()
    assert list(read_whole(tmp_path / "netcdf").data_vars) == ["f"]
    assert (tmp_path / "text").read_bytes() == b"a" * 10**6
    with pytest.raises(FormatError, match="no seal"):
        check_seal(tmp_path / "text", 2**30)


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


@pytest.mark.process
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
