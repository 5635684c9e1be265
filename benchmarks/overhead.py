"""Overhead of the pipeline: a study run to its report, with Snakemake and without.

The share of a run that is overhead is ``1 - direct / run``. ``run`` is the time of ``meecontact run STUDY``, start
included, in a copy of the project without results. ``direct`` is the time that the same scripts take in the same copy
under a plain driver (`benchmarks.direct`): in the order of their dependencies, on as many cores, one process a core
instead of one a job, so that libraries are imported once a core; planning is not counted. Overhead is therefore the
start and the planning of Snakemake, the start of a process a job with its imports, and what Snakemake does between
jobs. Every output of the two is compared, so that they are the same work.

``python -m benchmarks.overhead [STUDY ...]``
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.timing import printed, timed
from workflow.run.provenance import ROOT

PARTS = ("approximation", "storage", "solver", "surrogate", "workflow", "benchmarks", "config")
# what holds measured times
NOT_COMPARED = {
    "timing.json", "datacard.json", "datacard.md", "croissant.json", "provenance.json", "ro-crate-metadata.json",
    "report.html",
}  # fmt: skip


def measure(studies: tuple[str, ...] = ("quickstart", "large"), repeats: int = 2) -> dict[str, float]:
    """Seconds and processor seconds of both ways, the best of some repeats taken in turn, and the overhead's share."""
    cores = len(os.sched_getaffinity(0))
    measured = {"cores": float(cores)}
    for study in studies:
        times: dict[str, list[float]] = {}
        with tempfile.TemporaryDirectory(dir=ROOT, prefix=".overhead.") as name:
            folder = Path(name)
            _copy(folder)
            for _ in range(repeats):
                for key, value in {**_run(folder, study, cores), **_direct(folder, study, cores)}.items():
                    times.setdefault(key, []).append(value)
        best = {key: min(values) for key, values in times.items()}
        best["overhead_share"] = 1 - best["seconds_direct"] / best["seconds_run"]
        best["overhead_share_of_processor_time"] = 1 - best["processor_seconds_direct"] / best["processor_seconds_run"]
        measured |= {f"{study}_{key}": value for key, value in best.items()}
    return measured


def _copy(folder: Path) -> None:
    for part in PARTS:
        shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", folder)


def _run(folder: Path, study: str, cores: int) -> dict[str, float]:
    """The way of the command line; its results are put aside."""
    shutil.rmtree(folder / "other", ignore_errors=True)
    program = Path(sys.executable).with_name("meecontact")
    _, cost = timed(lambda: _done([str(program), "run", study, "--cores", str(cores)], folder))
    _clear(folder, study)
    return {"seconds_run": cost.seconds, "processor_seconds_run": cost.processor}


def _direct(folder: Path, study: str, cores: int) -> dict[str, float]:
    """The plain driver's way; its results must be those that were put aside."""
    output = _done([sys.executable, "-m", "benchmarks.direct", f"results/{study}/report.html", str(cores)], folder)
    measured = json.loads(output.splitlines()[-1])
    _compare(folder / "other", folder / "results" / study)
    shutil.rmtree(folder / "results")
    return {
        "seconds_direct": measured["seconds"],
        "processor_seconds_direct": measured["processor"],
        "jobs": measured["jobs"],
    }


def _clear(folder: Path, study: str) -> None:
    (folder / "results" / study).rename(folder / "other")
    for name in ("results", "logs", ".snakemake"):
        shutil.rmtree(folder / name)


def _compare(first: Path, other: Path) -> None:
    for file in sorted(first.rglob("*")):
        if file.is_file() and file.name not in NOT_COMPARED and not file.name.startswith("."):
            twin = other / file.relative_to(first)
            if not twin.is_file() or file.read_bytes() != twin.read_bytes():
                raise RuntimeError(f"{file.relative_to(first)}: the two ways do not make the same")


def _done(command: list[str], folder: Path) -> str:
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr[-2000:]}")
    return done.stdout


if __name__ == "__main__":
    print(printed(measure(tuple(sys.argv[1:])) if sys.argv[1:] else measure()))
