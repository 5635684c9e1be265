"""The lock of a study's results: whoever runs, from whichever checkout, and however the last one ended."""

import fcntl
import json
import os
import re
import shutil
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
import pytest
import xarray as xr

from storage import netcdf
from storage.blocks import write_blocks
from storage.sealed import FormatError
from tests.workflow.conftest import job
from workflow.run import joblog, lock


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A large disk to which the results of two checkouts lead; the first of them is the current folder."""
    for name in ("disk", "one", "two"):
        (tmp_path / name).mkdir()
    for name in ("one", "two"):
        (tmp_path / name / "results").symlink_to(tmp_path / "disk")
    monkeypatch.chdir(tmp_path / "one")
    yield tmp_path / "disk"
    lock.release()


def test_checkouts_that_share_results_share_the_lock(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock.claim({"tiny": {"title": "one"}})
    monkeypatch.chdir(disk.parent / "two")
    with pytest.raises(lock.BusyError, match=rf"^study 'tiny' is .* \(process {os.getpid()}\): wait until that ends$"):
        lock.claim({"tiny": {"title": "two"}})
    assert lock.begun("tiny") == {"title": "one"}
    lock.claim({"other": {}})
    lock.release()
    assert not [file for file in disk.rglob("*") if file.is_file()]
    lock.claim({"tiny": {"title": "two"}})
    assert lock.begun("tiny") == {"title": "two"}


def test_a_link_of_one_study_leads_to_its_lock_too(disk: Path) -> None:
    (disk / "tiny").mkdir()
    (disk / "same").symlink_to(disk / "tiny")
    lock.claim({"tiny": {}})
    with pytest.raises(lock.BusyError, match="study 'same' is already being run"):
        lock.claim({"same": {}})


def test_what_a_killed_run_leaves_holds_nobody(disk: Path) -> None:
    (disk / "tiny").mkdir()
    stale = json.dumps({"host": "elsewhere", "process": 1, "study": {"title": "a much longer title than the next one"}})
    (disk / "tiny/.running").write_text(stale, encoding="utf-8")
    lock.claim({"tiny": {"title": "next"}})
    assert lock.begun("tiny") == {"title": "next"}


def test_a_lock_that_its_holder_removes_meanwhile_is_taken_anew(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock.claim({"tiny": {"title": "first"}})
    flock = fcntl.flock

    def ends_just_before(file: IO[str], operation: int) -> None:
        monkeypatch.setattr(fcntl, "flock", flock)
        lock.release()
        flock(file, operation)  # of a file that has no name any more

    monkeypatch.setattr(fcntl, "flock", ends_just_before)
    lock.claim({"tiny": {"title": "second"}})
    assert lock.begun("tiny") == {"title": "second"}
    with pytest.raises(lock.BusyError):
        lock.claim({"tiny": {}})


def test_a_holder_elsewhere_is_named_with_its_host(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock.claim({"tiny": {}})
    monkeypatch.setattr(socket, "gethostname", lambda: "another")
    host = json.loads((disk / "tiny/.running").read_text(encoding="utf-8"))["host"]
    with pytest.raises(lock.BusyError, match=rf"\(process {os.getpid()} on {re.escape(host)}\): wait"):
        lock.claim({"tiny": {}})


def test_results_without_locks_are_named_in_one_line(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_file: object, _operation: int) -> None:
        raise OSError(37, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none)
    with pytest.raises(OSError, match=r"No locks available: 'results/tiny/\.running'"):
        lock.claim({"tiny": {}})


def test_sweeping_leaves_what_is_whole(tmp_path: Path) -> None:
    for name in (".slab_0.nc.x.partial", "slab_0.nc", "slab_1.nc", ".hidden"):
        (tmp_path / name).touch()
    lock.sweep(tmp_path, [tmp_path / "slab_1.nc", tmp_path / "absent.nc"])
    assert {file.name for file in tmp_path.iterdir()} == {"slab_0.nc", ".hidden"}


STATE, OTHER = "fixed factors: 0123", "fixed factors: 4567"
DATA = xr.Dataset({"x": ("case", np.arange(3.0))})


@pytest.fixture(autouse=True)
def _run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A run of the study ``own`` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    lock.claim({"own": {}}, "mee/results", None, {"own": [STATE]})
    yield
    lock.release()
    netcdf.bind({}, {})


def begin(study: str, output: str, *inputs: str, state: str = STATE) -> None:
    """Begin a job that makes one file out of others."""
    joblog.bind(job(study, output, *inputs, parameter=state))


def slab(study: str, number: int, state: str = STATE) -> str:
    """A slab as a job writes it."""
    path = Path(f"mee/results/{study}/fields/slab_{number}.nc")
    path.parent.mkdir(parents=True, exist_ok=True)
    begin(study, str(path), state=state)
    if number:
        netcdf.write_whole(DATA, path)
    else:
        write_blocks(path, DATA, [((slice(None),), {"x": DATA["x"].values})], {})
    return str(path)


def test_a_file_answers_what_its_path_and_study_say() -> None:
    first, second, foreign = slab("own", 0), slab("own", 1), slab("other", 0)
    begin("own", "mee/results/own/quantities.nc", first, second)
    for path in (first, second):
        assert netcdf.read_whole(path).attrs.keys().isdisjoint([netcdf.ANSWERS])
        with netcdf.read_whole(path, lazy=True) as lazy, netcdf.read_whole(path, names=["x"]) as part:
            np.testing.assert_array_equal(lazy["x"], part["x"])
    shutil.copy(first, "first.nc")
    for source, message in (
        (second, "holds own/fields/slab_1.nc, not own/fields/slab_0.nc; remove it, and run again"),
        (foreign, "holds other/fields/slab_0.nc, not own/fields/slab_0.nc"),
    ):
        shutil.copy(source, first)
        options: dict[str, Any]
        for options in ({}, {"lazy": True}, {"names": ["x"]}):
            with pytest.raises(FormatError, match=message):
                netcdf.read_whole(first, **options)


def test_a_file_of_another_state_of_the_study_is_refused() -> None:
    path = slab("own", 0, OTHER)
    begin("own", "mee/results/own/quantities.nc", path)
    with pytest.raises(FormatError, match=r"made from another state of the study \(fixed factors\); remove it"):
        netcdf.read_whole(path)
    netcdf.bind({}, {})
    netcdf.write_whole(DATA, path)  # by nobody's job
    begin("own", "mee/results/own/quantities.nc", path)
    with pytest.raises(FormatError, match="holds no name of a file"):
        netcdf.read_whole(path)
    lock.release()  # a script that runs alone knows the path only
    begin("own", path, state=OTHER)
    netcdf.write_whole(DATA, path)
    begin("own", "mee/results/own/quantities.nc", path)
    assert netcdf.read_whole(path).sizes == {"case": 3}
