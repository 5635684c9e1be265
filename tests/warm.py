"""Commands as forks of one process a worker that has imported what they need (`tests/preloaded.py`).

Runs of an installed program and of designs (test_pipeline) stay as users start them, and one that `make soak` compares
with runs that are killed.
"""

import atexit
import contextlib
import ctypes
import functools
import importlib
import os
import runpy
import shlex
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Sequence
from multiprocessing import forkserver, get_context
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from workflow.run.provenance import ROOMS, ROOT

PROGRAMS = {"meecontact": "workflow.cli.main", "snakemake": "snakemake.cli", "python": ""}
#: Stands in the command line of every fork.
FORKED = "multiprocessing.forkserver"


@functools.cache
def context() -> Any:
    """Return the start of processes; the first call starts the warm process, which ends with the worker."""
    forks = get_context("forkserver")
    forks.set_forkserver_preload(["tests.preloaded"])
    with contextlib.chdir(ROOT):  # where its imports are
        forkserver.ensure_running()
    server: Any = forkserver
    atexit.register(server._forkserver._stop)
    return forks


def _python(words: list[str]) -> None:
    """Run what `python` would run: a module, a piece of code or a file; `-W error` comes first."""
    if words[0] == "-W":
        warnings.simplefilter(words[1])  # type: ignore[arg-type]  # an action's name
        words = words[2:]
    sys.path.insert(0, "" if words[0] in ("-m", "-c") else str(Path(words[0]).parent))
    sys.argv[:] = words[1:] if words[0] == "-m" else words
    if words[0] == "-m":
        runpy.run_module(words[1], run_name="__main__", alter_sys=True)
    elif words[0] == "-c":
        exec(compile(words[1], "<string>", "exec"), {"__name__": "__main__"})
    else:
        runpy.run_path(words[0], run_name="__main__")


def _obey_permissions() -> None:
    """Give up CAP_DAC_OVERRIDE, of number 1, with which root ignores permissions; no program gets it back."""
    library = ctypes.CDLL(None)
    header, sets = (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()
    assert library.capget(header, sets) == 0
    library.prctl(24, 1)  # PR_CAPBSET_DROP
    for k in range(3):
        sets[k] &= ~(1 << 1)
    assert library.capset(header, sets) == 0


def _execute(
    command: list[str], folder: str, packages: str, environment: dict[str, str], streams: list[str], bound: bool
) -> None:
    """Be a command in a fork: its folder, environment, packages and streams."""
    assert "tests.preloaded" in sys.modules
    if bound:
        _obey_permissions()
    os.environ.clear()
    os.environ.update(environment, PYTHONPATH=packages, OMP_NUM_THREADS="1")
    os.chdir(folder)
    if packages != str(ROOT):
        for name in [name for name in sys.modules if name.partition(".")[0] in (*ROOMS, "meecontact", "verification")]:
            del sys.modules[name]
    sys.path[:] = [packages, *(path for path in sys.path if path not in ("", str(ROOT)))]
    output = os.O_WRONLY | os.O_CREAT | os.O_APPEND
    for number, (name, flags) in enumerate(zip(streams, (os.O_RDONLY, output, output), strict=True)):
        stream = os.open(name, flags)
        os.dup2(stream, number)
        os.close(stream)
    try:
        if command[0] == "python":
            _python(command[1:])
        else:
            sys.argv[:] = command
            sys.exit(importlib.import_module(PROGRAMS[command[0]]).main())
    except Exception:
        sys.excepthook(*sys.exc_info())
        sys.exit(1)
    finally:
        atexit._run_exitfuncs()  # multiprocessing leaves them out


def start(
    command: Sequence[str], folder: Path, packages: Path, streams: Sequence[str | Path], bound: bool = False
) -> BaseProcess:
    """Start a command whose standard streams are files; permissions bind root if `bound`."""
    arguments = list(command), str(folder), str(packages), dict(os.environ), [*map(str, streams)], bound
    process: BaseProcess = context().Process(target=_execute, args=arguments)
    process.start()
    return process


def run(
    command: Sequence[str], folder: Path, packages: Path = ROOT, bound: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run a command as `subprocess.run` would; permissions bind root if `bound`."""
    with tempfile.TemporaryDirectory() as name:
        streams = [Path(name, stream) for stream in ("out", "err")]
        process = start(command, folder, packages, [os.devnull, *streams], bound)
        process.join()
        out, error = (stream.read_text(encoding="utf-8") for stream in streams)
    return subprocess.CompletedProcess(list(command), process.exitcode or 0, out, error)


def printed(line: str) -> str:
    """Return the output of a command line of a page, run in the current folder."""
    done = run(shlex.split(line), Path.cwd())
    assert done.returncode == 0, done.stderr
    return done.stdout
