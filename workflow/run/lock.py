"""One run a study at a time, and what a killed one leaves is swept away.

Snakemake's own lock outlives a killed run and then wants a manual `--unlock`; a lock of the kernel (`flock`) dies with
its holder. It is taken when Snakemake has something to do, whether `meecontact run` or `snakemake` was called. It lies
in the study's results, for these are what two runs must not share, from whichever checkout they come; and it holds the
study as it was then, for the jobs.
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
_held: dict[Path, IO[str]] = {}  # open files, and with them the locks, live as long as the process


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
            _held[path] = file = _locked(name, path)
            file.truncate(0)
            held = {
                "host": socket.gethostname(),
                "process": os.getpid(),
                "study": content,
                "sources": dict(sources or {}),
                "states": sorted((states or {}).get(name, ())),
            }
            json.dump(held, file)
            file.flush()
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(Path(results) / name / _LOCK)) from None


@atexit.register
def release() -> None:
    """Give back what this process has claimed, as it does when it ends, and leave no lock among the results."""
    while _held:
        path, file = _held.popitem()
        with suppress(OSError):
            path.unlink()
        file.close()


def begun(name: str, results: str | Path = RESULTS) -> Any:
    """The frozen content with which the run of a study began; None where there is no run."""
    return _read(Path(results) / name / _LOCK).get("study")


def results(name: str, output: Path) -> Path:
    """The folder of all results, by a file of a study in it: below the prefix of a module that uses the Snakefile."""
    return next(folder.parent for folder in output.parents if (folder.parent.name, folder.name) == (RESULTS.name, name))


def sources(output: Path) -> dict[str, str]:
    """Digests of the sources with which the run began that makes this file; none where there is no run."""
    return dict(_around(output).get("sources", {}))


def states(output: Path) -> frozenset[str]:
    """Parameters that say the state of the study in the run that makes this file; none where there is no run."""
    return frozenset(_around(output).get("states", ()))


def _around(output: Path) -> dict[str, Any]:
    """Content of the lock of the run that makes a file; empty where there is no run."""
    locks = (folder / _LOCK for folder in output.absolute().parents)
    return next((_read(path) for path in locks if path.is_file()), {})


def sweep(folder: Path, orphans: Iterable[Path]) -> None:
    """Remove what a killed run left from the folder of a study that this process has claimed."""
    for left in (*folder.rglob(f".*{PARTIAL}"), *orphans):
        left.unlink(missing_ok=True)


def _locked(name: str, path: Path) -> IO[str]:
    """The file, open and locked; its last holder may have removed it between the two."""
    while True:
        file = path.open("a", encoding="utf-8")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            with suppress(FileNotFoundError):
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
