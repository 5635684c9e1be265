"""The lock of a study's results: whoever runs, from whichever checkout, and however the last one ended."""

import fcntl
import json
import os
import re
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import pytest

from workflow.run import lock as running


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A large disk to which the results of two checkouts lead; the first of them is the current folder."""
    for name in ("disk", "one", "two"):
        (tmp_path / name).mkdir()
    for name in ("one", "two"):
        (tmp_path / name / "results").symlink_to(tmp_path / "disk")
    monkeypatch.chdir(tmp_path / "one")
    yield tmp_path / "disk"
    running.release()


def test_checkouts_that_share_results_share_the_lock(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    running.claim({"tiny": {"title": "one"}})
    monkeypatch.chdir(disk.parent / "two")
    with pytest.raises(
        running.BusyError, match=rf"^study 'tiny' is .* \(process {os.getpid()}\): wait until that ends$"
    ):
        running.claim({"tiny": {"title": "two"}})
    assert running.begun("tiny") == {"title": "one"}
    running.claim({"other": {}})
    running.release()
    assert not [file for file in disk.rglob("*") if file.is_file()]
    running.claim({"tiny": {"title": "two"}})
    assert running.begun("tiny") == {"title": "two"}
    (disk / "same").symlink_to(disk / "tiny")
    with pytest.raises(running.BusyError, match="study 'same' is already being run"):
        running.claim({"same": {}})


def test_what_a_killed_run_leaves_holds_nobody(disk: Path) -> None:
    (disk / "tiny").mkdir()
    stale = json.dumps({"host": "elsewhere", "process": 1, "study": {"title": "a much longer title than the next one"}})
    (disk / "tiny/.running").write_text(stale, encoding="utf-8")
    running.claim({"tiny": {"title": "next"}})
    assert running.begun("tiny") == {"title": "next"}


def test_a_lock_that_its_holder_removes_meanwhile_is_taken_anew(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    running.claim({"tiny": {"title": "first"}})
    lock = fcntl.flock

    def ends_just_before(file: IO[str], operation: int) -> None:
        monkeypatch.setattr(fcntl, "flock", lock)
        running.release()
        lock(file, operation)  # of a file that has no name any more

    monkeypatch.setattr(fcntl, "flock", ends_just_before)
    running.claim({"tiny": {"title": "second"}})
    assert running.begun("tiny") == {"title": "second"}
    with pytest.raises(running.BusyError):
        running.claim({"tiny": {}})


def test_a_holder_elsewhere_is_named_with_its_host(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    running.claim({"tiny": {}})
    monkeypatch.setattr(socket, "gethostname", lambda: "another")
    host = json.loads((disk / "tiny/.running").read_text(encoding="utf-8"))["host"]
    with pytest.raises(running.BusyError, match=rf"\(process {os.getpid()} on {re.escape(host)}\): wait"):
        running.claim({"tiny": {}})


def test_results_without_locks_are_named_in_one_line(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_file: object, _operation: int) -> None:
        raise OSError(37, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none)
    with pytest.raises(OSError, match=r"No locks available: 'results/tiny/\.running'"):
        running.claim({"tiny": {}})
