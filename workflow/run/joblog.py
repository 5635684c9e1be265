"""The beginning of a job: its log, the check of its sources and the names in its netCDF files."""

import logging
import sys
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from solver import SmallStrainWarning
from storage import netcdf
from storage.sealed import FormatError
from workflow.run import lock, provenance

if TYPE_CHECKING:
    from snakemake.iocontainers import Snakemake

log = logging.getLogger("meecontact")


def start(script: Mapping[str, Any]) -> "Snakemake":
    """Begin the log of a script's job; return the job, from the script's ``globals()``."""
    warnings.simplefilter("ignore", SmallStrainWarning)  # which the verdict on a design reports
    job: Snakemake = script["snakemake"]
    _log_to(job.log[0])
    provenance.check(lock.sources(Path(job.output[0])), script["__file__"])
    bind(job)
    return job


def bind(job: "Snakemake") -> None:
    """Write name and state of the study into a job's netCDF files, and check those of its inputs.

    Snakemake compares times only: a slab of another study or of an earlier state is a valid file with wrong numbers.
    """
    name, output = job.wildcards.study, Path(job.output[0])
    folder, states = lock.results(name, output), lock.states(output)
    state = str(job.params.get("study", ""))

    def check(path: Path, answers: str) -> None:
        expected = path.relative_to(folder).as_posix()
        file, _, made_from = answers.partition("; ")
        if file != expected:
            raise FormatError(path, f"holds {file or 'no name of a file'}, not {expected}; remove it, and run again")
        if made_from and states and made_from not in states:
            sections = made_from.partition(": ")[0]
            raise FormatError(path, f"was made from another state of the study ({sections}); remove it, and run again")

    def files(paths: Iterable[str]) -> list[Path]:
        return [Path(path) for path in paths if path.endswith(".nc")]

    written = {path: f"{path.relative_to(folder).as_posix()}; {state}".removesuffix("; ") for path in files(job.output)}
    netcdf.bind(written, dict.fromkeys(files(job.input), check))


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
