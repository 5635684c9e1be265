"""The beginning of a job: what Snakemake gives it, and its log: what was done, the whole story where it failed."""

import logging
import sys
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from workflow.run import lock, sources

if TYPE_CHECKING:
    from snakemake.iocontainers import Snakemake

log = logging.getLogger("meecontact")


def start(script: Mapping[str, Any]) -> "Snakemake":
    """The job of a script, by its ``globals()``: Snakemake's with its log, or a stand-in for a script that runs alone.

    Alone it takes the file to make as its argument, and logs to the terminal: see `workflow.run.standin`.
    """
    if "snakemake" in script:
        job: Snakemake = script["snakemake"]
        _log_to(job.log[0])
        sources.check(lock.sources(Path(job.output[0])), script["__file__"])
        return job
    from workflow.run import standin  # all of Snakemake: seconds, and not for its own jobs

    logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    return standin.job(Path(script["__file__"]), *sys.argv[1:2])


def _log_to(path: str) -> None:
    """Log to a file; an exception goes there in full and to the terminal in one line."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    logging.captureWarnings(capture=True)
    logging.raiseExceptions = False  # a log that cannot be written (disk full) must not hide the job's own error
    logging.basicConfig(
        filename=path, filemode="w", force=True, level=logging.INFO, format="%(levelname)s %(name)s: %(message)s"
    )

    def report(raised: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        log.error("failed", exc_info=(raised, error, trace))
        print(f"{raised.__name__}: {error}", file=sys.stderr)

    sys.excepthook = report
