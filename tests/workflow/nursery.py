"""Where tests' commands begin: one warm process a worker (`tests/workflow/warm.py`), of which each is a fork."""

import atexit
import functools
import json
import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.workflow import warm
from workflow.run.provenance import ROOT

PROGRAMS = ("meecontact", "snakemake", "python")


# root may write everywhere, unless it gives up the right to
PLAIN_USER = () if os.geteuid() else ("setpriv", "--bounding-set=-dac_override", "--inh-caps=-dac_override")


@functools.cache
def nursery(user: tuple[str, ...] = ()) -> "subprocess.Popen[str]":
    """The warm process, begun when it is first needed; it ends with the worker."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [*user, sys.executable, str(Path(warm.__file__)), str(ROOT)]
    begun = subprocess.Popen(
        command, env=environment | {"OMP_NUM_THREADS": "1"}, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    atexit.register(begun.communicate)
    return begun


def printed(line: str) -> str:
    """What a command line of a page prints, run in the current folder."""
    done = run(shlex.split(line), Path.cwd(), ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout


def run(
    command: Sequence[str], folder: Path, packages: Path, said: str = "", user: tuple[str, ...] = ()
) -> subprocess.CompletedProcess[str]:
    """Run a command, ``meecontact``, ``snakemake`` or ``python``, as `subprocess.run` would.

    Parameters
    ----------
    command : sequence of str
        The program's name and its words.
    folder : Path
        Its current folder.
    packages : Path
        Where it finds the project's packages.
    said : str
        Its standard input.
    user : tuple of str
        `PLAIN_USER`, or nothing: this user.
    """
    with tempfile.TemporaryDirectory() as name:
        streams = [Path(name, stream) for stream in ("in", "out", "err")]
        for stream, content in zip(streams, (said, "", ""), strict=True):
            stream.write_text(content, encoding="utf-8")
        order = {
            "command": list(command),
            "folder": str(folder),
            "environment": {**os.environ, "PYTHONPATH": str(packages), "OMP_NUM_THREADS": "1"},
            "streams": [str(stream) for stream in streams],
        }
        warm_one = nursery(user)
        assert warm_one.stdin is not None
        assert warm_one.stdout is not None
        print(json.dumps(order), file=warm_one.stdin, flush=True)
        status = int(warm_one.stdout.readline())
        out, error = (stream.read_text(encoding="utf-8") for stream in streams[1:])
    return subprocess.CompletedProcess(list(command), status, out, error)
