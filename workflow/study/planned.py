"""The study that a job was planned with, as it was when its run began.

Snakemake records a study's digests when it plans a run. A job that read an edited file would file its answers under the
old digest, and the next run would find nothing to do.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflow.run import lock
from workflow.study import model as studies
from workflow.study import partition
from workflow.study.model import Study
from workflow.study.reading import InputError

if TYPE_CHECKING:
    from snakemake.iocontainers import Snakemake


def parameter(study: Study, *sections: str) -> str:
    """Return a rule's parameter that changes when sections of the study change."""
    names = sections or tuple(Study.model_fields)
    return f"{' '.join(names)}: {study.digest(*names)}"


def start(script: Mapping[str, Any]) -> tuple["Snakemake", Study]:
    """Begin the log of a script's job; return the job, from the script's ``globals()``, and its study."""
    from workflow.run import joblog  # for jobs, not for the Snakefile

    job = joblog.start(script)
    return job, study(job)


def study(job: "Snakemake") -> Study:
    """Return the study of a job, whose rule has the wildcard ``study``, and its `parameter` as ``study``."""
    name, (sections, _, digest) = job.wildcards.study, job.params.study.partition(": ")
    current = begun(name, lock.results(name, Path(job.output[0])))
    if current is None or current.digest(*sections.split()) != digest:
        current = partition.with_slabs(studies.named(name))
    if current.digest(*sections.split()) == digest:
        return current
    raise InputError(f"{current.path}: was changed ({sections}) after this job was planned; run the study again")


def pressed(job: "Snakemake", study: Study) -> Study:
    """Return the study whose design the section ``signal`` presses: the job's own, or another as it was planned."""
    assert study.signal is not None
    results = lock.results(job.wildcards.study, Path(job.output[0]))
    return (study.signal.study and begun(study.signal.study, results)) or studies.pressed(study) or study


def begun(name: str, results: str | Path) -> Study | None:
    """Return the study as it was when its run began; None where there is no run."""
    frozen = lock.begun(name, results)
    return None if frozen is None else studies.thawed(frozen)
