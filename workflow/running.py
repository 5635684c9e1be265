"""One run a study at a time, and what a killed one leaves is swept away.

Snakemake's own lock outlives a killed run and then wants a manual `--unlock`; a lock of the kernel (`flock`) dies with
its holder. It is taken when Snakemake has something to do, whether `meecontact run` or `snakemake` was called.
"""

import fcntl
import os
from collections.abc import Iterable
from pathlib import Path
from typing import IO

FOLDER = Path(".snakemake/meecontact")
RESULTS = Path("results")

#: What a file that is being written is called: hidden, and with this ending.
PARTIAL = ".partial"

_held: list[IO[str]] = []  # open files, and with them the locks, live as long as the process


class BusyError(RuntimeError):
    """Another process runs the same study."""


def claim(studies: Iterable[str]) -> None:
    """Reserve studies for this process until it ends, however it ends.

    Raises
    ------
    BusyError
        Another process has one of them; in one line with the study and the process.
    """
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in sorted(studies):
        file = (FOLDER / f"{name}.lock").open("a+", encoding="ascii")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            holder = file.read(100).strip() or "unknown"
            file.close()
            raise BusyError(f"study {name!r} is already being run (process {holder}): wait until that ends") from None
        file.truncate(0)
        file.write(f"{os.getpid()}\n")
        file.flush()
        _held.append(file)


def sweep(studies: Iterable[str], results: str | Path = RESULTS) -> None:
    """Remove the temporary files that killed writers left in the results of studies which this process has claimed."""
    for name in studies:
        for left in (Path(results) / name).rglob(f".*{PARTIAL}"):
            left.unlink(missing_ok=True)
