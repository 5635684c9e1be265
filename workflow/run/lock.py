"""A lock for one run a study at a time, which stores the study for the jobs; files of killed runs are removed.

Snakemake's own lock outlives a killed run and then needs `--unlock`; a lock of the kernel (`flock`) dies with its
holder. The file lies in the study's results, which two runs of any checkout must not share.
"""

import atexit
import fcntl
import json
import os
import socket
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from storage.sealed import PARTIAL

RESULTS = Path("results")

_LOCK = ".running"
_open_locks: dict[Path, IO[str]] = {}  # open files, and with them the locks, live as long as the process


class BusyError(RuntimeError):
    """Another process runs the same study."""


def claim(
    studies: Mapping[str, Mapping[str, Any]],
    results: str | Path = RESULTS,
    sources: Mapping[str, str] | None = None,
    states: Mapping[str, Iterable[str]] | None = None,
) -> None:
    """Reserve studies for this process until it ends, however it ends; `states` are their parameters of rules."""
    for name, content in sorted(studies.items()):
        path = (Path(results) / name / _LOCK).absolute()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _open_locks[path] = file = _locked(name, path)
            file.truncate(0)
            record = {
                "host": socket.gethostname(),
                "process": os.getpid(),
                "study": content,
                "sources": dict(sources or {}),
                "states": sorted((states or {}).get(name, ())),
            }
            json.dump(record, file)
            file.flush()
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(Path(results) / name / _LOCK)) from None


@atexit.register
def release() -> None:
    """Release all studies of this process, as at its end, and remove their locks from the results."""
    while _open_locks:
        path, file = _open_locks.popitem()
        with suppress(OSError):
            path.unlink()
        file.close()


def begun(name: str, results: str | Path = RESULTS) -> Any:
    """Return the frozen content with which the run of a study began; None where there is no run."""
    return _read(Path(results) / name / _LOCK).get("study")


def results(name: str, output: Path) -> Path:
    """Return the folder of all results that a study's file lies in, below the prefix of a Snakemake module."""
    return next(folder.parent for folder in output.parents if (folder.parent.name, folder.name) == (RESULTS.name, name))


def sources(output: Path) -> dict[str, str]:
    """Return the digests of sources at the beginning of the run that makes a file; none where there is no run."""
    return dict(_lock_above(output).get("sources", {}))


def states(output: Path) -> frozenset[str]:
    """Return the parameters of the study's state in the run that makes a file; none where there is no run."""
    return frozenset(_lock_above(output).get("states", ()))


def _lock_above(output: Path) -> dict[str, Any]:
    """Return the content of the lock of the run that makes a file; empty where there is no run."""
    locks = (folder / _LOCK for folder in output.absolute().parents)
    return next((_read(path) for path in locks if path.is_file()), {})


def sweep(folder: Path, orphans: Iterable[Path]) -> None:
    """Remove files of a killed run from the folder of a study that this process has claimed."""
    for file in (*folder.rglob(f".*{PARTIAL}"), *orphans):
        file.unlink(missing_ok=True)


def _locked(name: str, path: Path) -> IO[str]:
    """Return the lock's file, open and locked."""
    while True:
        file = path.open("a", encoding="utf-8")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            with suppress(FileNotFoundError):  # its last holder may have removed it in between
                if os.path.samestat(os.fstat(file.fileno()), path.stat()):
                    return file
        except BlockingIOError:
            file.close()
            raise BusyError(f"study {name!r} is already being run ({_holder(path)}): wait until that ends") from None
        except OSError:
            file.close()
            raise
        file.close()


def _holder(path: Path) -> str:
    holder = _read(path)
    where = "" if holder.get("host") == socket.gethostname() else f" on {holder.get('host', 'unknown')}"
    return f"process {holder.get('process', 'unknown')}{where}"


def _read(path: Path) -> dict[str, Any]:
    """Return the content of a lock, empty where it is absent or being written."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
