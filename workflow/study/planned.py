"""The study that a job was planned with: as it was when its run began, whatever has been edited since.

Snakemake reads a study once and records its digests. A job that read an edited file would file the answers to the new
study under the digest of the old one, and the next run would find nothing to be done.
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
    """A parameter of a rule that changes when sections of the study change."""
    names = sections or tuple(Study.model_fields)
    return f"{' '.join(names)}: {study.digest(*names)}"


def start(script: Mapping[str, Any]) -> tuple["Snakemake", Study]:
    """Snakemake's job of a script from its ``globals()``, its log begun, and the study that it was planned with."""
    from workflow.run import joblog  # for jobs, not for the Snakefile

    job = joblog.start(script)
    return job, study(job)


def study(job: "Snakemake") -> Study:
    """The study of a job, whose rule has it as wildcard ``study`` and its `parameter` as ``study``."""
    name, (sections, _, digest) = job.wildcards.study, job.params.study.partition(": ")
    current = begun(name, lock.results(name, Path(job.output[0])))
    if current is None or current.digest(*sections.split()) != digest:
        current = partition.with_slabs(studies.named(name))
    if current.digest(*sections.split()) == digest:
        return current
    raise InputError(f"{current.path}: was changed ({sections}) after this job was planned; run the study again")


def pressed(job: "Snakemake", study: Study) -> Study:
    """The study whose design is pressed in a study's section ``signal``: itself, or another as it was planned with."""
    assert study.signal is not None
    results = lock.results(job.wildcards.study, Path(job.output[0]))
    return (study.signal.study and begun(study.signal.study, results)) or studies.pressed(study) or study


def begun(name: str, results: str | Path) -> Study | None:
    """The study as it was when its run began; None where there is no run."""
    frozen = lock.begun(name, results)
    return None if frozen is None else studies.thawed(frozen)
