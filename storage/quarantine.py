"""Refuses a netCDF file of unknown origin unless a child with limits has read all of it (`storage.examined`)."""

import contextlib
import faulthandler
import os
import resource
import select
import signal
import subprocess
import sys
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import NoReturn

from storage import examined
from storage.sealed import FormatError, check_seal

SCRIPT = examined.__file__
_A_THREAD = 2**27  # bytes of addresses: a heap of its own, a buffer of linear algebra
PATIENCE = 5 * examined.SECONDS  # of waiting; a child that gets no processor is not one that never ends


def try_to_read(path: str | PathLike[str], max_bytes: int) -> None:
    """Let a child read the file: all that its reader will read, and nothing else may be in it.

    A process of one thread, such as a job of the pipeline, forks; any other starts a new interpreter, which takes some
    four times as long, since a fork would copy its other threads' locks and not the threads.
    """
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"{file}: {'is a folder' if file.is_dir() else 'no such file'}")
    check_seal(file, max_bytes)
    child = _forked if _has_one_thread() else _started
    try:
        status, reason = child(file.absolute(), max_bytes)
    except TimeoutError:
        raise FormatError(file, "no readable netCDF-4 file (it keeps the library busy)") from None
    if status < 0:
        raise FormatError(file, f"no readable netCDF-4 file (it ends the library by signal {-status})")
    if status == examined.NOT_PLAIN:
        raise FormatError(file, reason)
    if status:
        raise FormatError(file, "no readable netCDF-4 file (the library cannot read it within its limits)")


@contextlib.contextmanager
def little_memory(path: Path) -> Iterator[None]:
    """Limit this process to `examined.MEMORY` more addresses, and some for each thread that may start."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    most = examined.addresses() + examined.MEMORY + _A_THREAD * (os.cpu_count() or 1)
    if soft == resource.RLIM_INFINITY or most < soft:
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))
    try:
        yield
    except MemoryError:
        raise FormatError(path, "too large: what is made of it takes more memory than a model has") from None
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _has_one_thread() -> bool:
    try:
        return len(list(Path("/proc/self/task").iterdir())) == 1
    except OSError:
        return False


def _started(path: Path, max_bytes: int) -> tuple[int, str]:
    """Exit status and reason of a new interpreter."""
    command = [sys.executable, "-I", SCRIPT, str(path), str(max_bytes)]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # each thread would reserve addresses
    try:
        done = subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False, env=environment)
    except subprocess.TimeoutExpired:
        raise TimeoutError from None
    return done.returncode, done.stdout.decode("utf-8", "replace")


def _forked(path: Path, max_bytes: int) -> tuple[int, str]:
    """Exit status and reason of a copy of this process."""
    receiving, sending = os.pipe()
    child = os.fork()
    if child == 0:
        _examine_and_end(path, max_bytes, sending)
    os.close(sending)
    with os.fdopen(receiving, "rb") as pipe:
        in_time = select.select([pipe], [], [], PATIENCE)[0]  # something was said, or the child has ended
        if not in_time:
            os.kill(child, signal.SIGKILL)
        reason = pipe.read().decode("utf-8", "replace")
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if not in_time:
        raise TimeoutError
    return status, reason


def _examine_and_end(path: Path, max_bytes: int, sending: int) -> NoReturn:
    status = 1
    with contextlib.suppress(BaseException):
        faulthandler.disable()  # the parent says what happened; the library says nothing
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        os.close(nothing)
        status, reason = examined.outcome(path, max_bytes)
        os.write(sending, examined.line(reason))
    os._exit(status)
