"""One warm process a worker (`tests/workflow/warm.py`), of which each command of a test is a fork."""

import atexit
import functools
import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.workflow import warm
from workflow.run.provenance import ROOT

PROGRAMS = ("meecontact", "snakemake", "python")


@functools.cache
def nursery() -> "subprocess.Popen[str]":
    """The warm process, begun when it is first needed; it ends with the worker."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys.executable, str(Path(warm.__file__)), str(ROOT)]
    begun = subprocess.Popen(
        command, env=environment | {"OMP_NUM_THREADS": "1"}, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    atexit.register(begun.communicate)
    return begun


def printed(line: str) -> str:
    """Return the output of a command line of a page, run in the current folder."""
    done = run(shlex.split(line), Path.cwd(), ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Running:
    """A command that runs, of which `poll`, `wait` and `kill` are those of `subprocess.Popen`."""

    def __init__(
        self, command: Sequence[str], folder: Path, packages: Path, streams: Sequence[str | Path], bound: bool = False
    ) -> None:
        self._nursery = nursery()
        self.returncode: int | None = None
        order = {
            "command": list(command),
            "folder": str(folder),
            "environment": {**os.environ, "PYTHONPATH": str(packages), "OMP_NUM_THREADS": "1"},
            "streams": [str(stream) for stream in streams],
            "bound": bound,
        }
        self.pid = int(self._told(order))

    def _told(self, order: dict[str, object]) -> str:
        assert self._nursery.stdin is not None
        assert self._nursery.stdout is not None
        print(json.dumps(order), file=self._nursery.stdin, flush=True)
        return self._nursery.stdout.readline().strip()

    def poll(self, *, wait: bool = False) -> int | None:
        """Its exit status, if it has ended."""
        if self.returncode is None and (answer := self._told({"process": self.pid, "wait": wait})):
            self.returncode = int(answer)
        return self.returncode

    def wait(self) -> int:
        """Its exit status, when it has ended."""
        status = self.poll(wait=True)
        assert status is not None
        return status

    def kill(self) -> None:
        """SIGKILL, if it has not ended."""
        if self.poll() is None:
            os.kill(self.pid, signal.SIGKILL)


def run(
    command: Sequence[str], folder: Path, packages: Path, said: str = "", bound: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run a command as `subprocess.run` would; `said` is its standard input, the rest that of `Running`."""
    with tempfile.TemporaryDirectory() as name:
        streams = [Path(name, stream) for stream in ("in", "out", "err")]
        for stream, content in zip(streams, (said, "", ""), strict=True):
            stream.write_text(content, encoding="utf-8")
        status = Running(command, folder, packages, streams, bound).wait()
        out, error = (stream.read_text(encoding="utf-8") for stream in streams[1:])
    return subprocess.CompletedProcess(list(command), status, out, error)
