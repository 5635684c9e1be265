"""Refuses a netCDF file of unknown origin unless a child process with limits can read it (`storage.examined`)."""

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
_A_THREAD = 2**27  # bytes of addresses of a thread: its heap and a buffer of linear algebra
PATIENCE = 5 * examined.SECONDS  # of waiting, since a child may have to wait for a processor


def try_to_read(path: str | PathLike[str], max_bytes: int) -> None:
    """Let a child process read the whole file; FormatError if it cannot, or finds unexpected contents."""
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"{file}: {'is a folder' if file.is_dir() else 'no such file'}")
    check_seal(file, max_bytes)
    # a fork would copy the locks of other threads but not the threads; a new interpreter takes four times as long
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
    """Limit this process to `examined.MEMORY` further bytes of addresses, and some for each thread that may start."""
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
    """Return exit status and reason of an examination in a new interpreter."""
    command = [sys.executable, "-I", SCRIPT, str(path), str(max_bytes)]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # each thread would reserve addresses
    try:
        done = subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False, env=environment)
    except subprocess.TimeoutExpired:
        raise TimeoutError from None
    return done.returncode, done.stdout.decode("utf-8", "replace")


def _forked(path: Path, max_bytes: int) -> tuple[int, str]:
    """Return exit status and reason of an examination in a fork of this process."""
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
        devnull = os.open(os.devnull, os.O_WRONLY)
        os.dup2(devnull, 1)
        os.dup2(devnull, 2)
        os.close(devnull)
        status, reason = examined.outcome(path, max_bytes)
        os.write(sending, examined.line(reason))
    os._exit(status)
