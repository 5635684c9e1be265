"""The Workflow Run RO-Crate of a study: what was run, from what, by which programs, and which files came out.

https://w3id.org/ro/wfrun/workflow/0.5, on RO-Crate 1.1. The folder `results/<study>/` is the crate: it holds copies of
the workflow's main file and of the study. The crate's date is that of the run; results have none.
"""

from collections.abc import Iterable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from storage.described import LICENSE

METADATA, WORKFLOW, STUDY = "ro-crate-metadata.json", "Snakefile", "study.yaml"
_CRATE = "https://w3id.org/ro/crate/1.1"
_TERMS = {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}
_PROFILES = [
    "https://w3id.org/ro/wfrun/process/0.5",
    "https://w3id.org/ro/wfrun/workflow/0.5",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
]
_LICENSE = f"https://spdx.org/licenses/{LICENSE}"
_SNAKEMAKE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
_FORMATS = {
    ".nc": "application/x-netcdf",
    ".json": "application/json",
    ".csv": "text/csv",
    ".html": "text/html",
    ".md": "text/markdown",
    ".txt": "text/plain",
}


def crate(
    name: str, title: str, results: Mapping[str, str], versions: Mapping[str, str], ended: datetime
) -> dict[str, Any]:
    """Metadata of a run as JSON-LD."""
    run = f"#run-{name}"
    files = [_file(path, digest) for path, digest in results.items()]
    tools = [
        _entity(f"#{tool}", "SoftwareApplication", name=tool, version=version) for tool, version in versions.items()
    ]
    root = _entity(
        "./",
        "Dataset",
        name=title,
        description=f"Results of the study {name}, made by the pipeline of meecontact.",
        license=_id(_LICENSE),
        datePublished=ended.date().isoformat(),
        conformsTo=_ids(_PROFILES),
        mainEntity=_id(WORKFLOW),
        hasPart=_ids([WORKFLOW, STUDY, *results]),
        mentions=_id(run),
    )
    about = _ids([_CRATE, _PROFILES[-1]])
    graph = [_entity(METADATA, "CreativeWork", about=_id("./"), conformsTo=about), root, *_workflow(name, versions)]
    profiles = [
        _entity(profile, "CreativeWork", name=profile.split("/")[-2], version=profile.split("/")[-1])
        for profile in _PROFILES
    ]
    terms = _entity(_LICENSE, "CreativeWork", name=f"{LICENSE} License")
    action = _entity(
        run,
        "CreateAction",
        name=f"run of the study {name}",
        instrument=_id(WORKFLOW),
        description=f"The pipeline's rules for the study {name}, by Snakemake; equal studies give equal results.",
        endTime=ended.isoformat(timespec="seconds"),
        object=_id(STUDY),
        result=_ids(results),
        actionStatus="http://schema.org/CompletedActionStatus",
    )
    return {"@context": [f"{_CRATE}/context", _TERMS], "@graph": [*graph, terms, *profiles, *tools, *files, action]}


def _workflow(name: str, versions: Mapping[str, str]) -> list[dict[str, Any]]:
    """The workflow's main file, its language, its one parameter and what that was."""
    return [
        _entity(
            WORKFLOW,
            ["File", "SoftwareSourceCode", "ComputationalWorkflow"],
            name="pipeline of meecontact",
            version=versions["meecontact"],
            programmingLanguage=_id(_SNAKEMAKE),
            input=_id("#study"),
            encodingFormat="text/plain",
            softwareRequirements=_ids(f"#{tool}" for tool in versions),
            license=_id(_LICENSE),
        ),
        _entity(_SNAKEMAKE, "ComputerLanguage", name="Snakemake", url=_id("https://snakemake.github.io")),
        _entity(
            "#study",
            "FormalParameter",
            name="study",
            additionalType="File",
            valueRequired=True,
            conformsTo=_id("https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE"),
        ),
        _entity(STUDY, "File", name=f"study {name}", encodingFormat="application/yaml", exampleOfWork=_id("#study")),
    ]


def _file(path: str, digest: str) -> dict[str, Any]:
    kind = _FORMATS[Path(path).suffix]
    return _entity(path, "File", name=path, encodingFormat=kind, **({"sha256": digest} if digest else {}))


def _entity(identifier: str, kind: str | list[str], **properties: Any) -> dict[str, Any]:
    return {"@id": identifier, "@type": kind, **properties}


def _id(identifier: str) -> dict[str, str]:
    return {"@id": identifier}


def _ids(identifiers: Iterable[str]) -> list[dict[str, str]]:
    return [_id(identifier) for identifier in identifiers]
