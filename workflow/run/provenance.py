"""Provenance of a result: hashes of sources, versions of packages, and the Workflow Run RO-Crate of a study."""

import hashlib
import json
import platform
import re
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from storage.described import LICENSE
from storage.files import write_text
from storage.sealed import sha256
from workflow.run.sources import DATA
from workflow.run.sources import ROOMS as ROOMS
from workflow.run.sources import ROOT as ROOT

PACKAGES = ("meecontact", "numpy", "scipy", "xarray", "netCDF4", "scikit-learn", "snakemake", "pydantic", "matplotlib")
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


@cache
def sources(module: Path) -> frozenset[Path]:
    """Files of the rooms that a module uses, directly or not, itself included, and data files that these name.

    ``from room import name`` leads to the module that defines the name, not to everything that the room's
    ``__init__`` gathers.
    """
    files: set[Path] = set()
    waiting = [module]
    while waiting:
        path = waiting.pop()
        if path not in files:
            files.add(path)
            modules, data = _named(path)
            waiting += modules
            files |= data
    return frozenset(files)


def code(*paths: str) -> str:
    """Hash over the sources behind scripts (and over plain files, such as templates), relative to the project's root.

    Snakemake sees an edit in a script but not in a package that the script imports: this hash, as a parameter of the
    rule, makes the edit rerun exactly what depends on it.
    """
    files: set[Path] = set()
    for path in paths:
        file = ROOT / path
        files |= sources(file) if file.suffix == ".py" else {file}
    return _hash(sorted(files))


def _hash(files: list[Path]) -> str:
    digest = hashlib.sha256()
    for file in files:
        digest.update(_told(file))
    return digest.hexdigest()[:16]


@cache
def _told(file: Path) -> bytes:
    """Name and content of a file: most are behind most rules, and read once."""
    return file.relative_to(ROOT).as_posix().encode() + b"\0" + file.read_bytes() + b"\0"


def versions() -> dict[str, str]:
    """Versions of Python and of the named packages."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def write(path: Path, study: str, study_digest: str, seed: int, results: list[Path]) -> None:
    """Write ``provenance.json``: versions, hashes of sources, study and results, the seed and the machine."""
    content = {
        "study": study,
        "study_sha256": study_digest,
        "seed": seed,
        "sources_sha256": _hash([file for room in ROOMS for file in _room(room)]),
        "versions": versions(),
        "platform": platform.platform(),
        "results_sha256": {file.name: sha256(file).hex() for file in results},
    }
    write_text(path, json.dumps(content, indent=2) + "\n")


def write_crate(folder: Path, name: str, title: str, study: str, results: list[Path], others: list[str]) -> None:
    """Write the RO-Crate of a run into the results' folder, with the workflow's main file and the study as it began."""
    write_text(folder / STUDY, study)
    write_text(folder / WORKFLOW, (ROOT / "workflow/Snakefile").read_text(encoding="utf-8"))
    digests = {file.relative_to(folder).as_posix(): sha256(file).hex() for file in results}
    content = entities(name, title, digests | dict.fromkeys(others, ""), versions(), datetime.now(UTC))
    write_text(folder / METADATA, json.dumps(content, indent=1) + "\n")


def _room(room: str) -> list[Path]:
    return sorted(file for file in (ROOT / room).rglob("*") if file.is_file() and "__pycache__" not in file.parts)


@cache
def _data(room: str) -> list[Path]:
    return [file for file in _room(room) if file.suffix in DATA]


@cache
def _named(path: Path) -> tuple[frozenset[Path], frozenset[Path]]:
    """Modules and data files of the rooms that one module names, and what the templates among these name."""
    text, data_files = path.read_text(encoding="utf-8"), _data(path.relative_to(ROOT).parts[0])
    data = {file for file in data_files if file.name in text}
    shown = "".join(file.read_text(encoding="utf-8") for file in data if file.suffix == ".j2")
    return frozenset(_used(text)), frozenset(data | {file for file in data_files if file.name in shown})


def _used(text: str) -> Iterator[Path]:
    """Files of the rooms that a module's import statements lead to."""
    for module, name in imports(text):
        file = (_file(f"{module}.{name}") or _definition(module, name)) if module else _file(name)
        if file:
            yield file


_IMPORT = re.compile(r"^[ \t]*(?:from ([\w.]+) )?import (\([^)]*\)|.*)", re.MULTILINE)


def imports(text: str) -> Iterator[tuple[str, str]]:
    """Imported names of a module, ``(module, name)`` or ``("", module)``; read by lines, faster than parsing."""
    for module, names in _IMPORT.findall(text):
        for name in re.sub(r"#.*|[()]", "", names).split(","):
            if named := name.split():
                yield module, named[0]


@cache
def _file(name: str) -> Path | None:
    """The file of a module of the rooms."""
    parts = name.split(".")
    if parts[0] not in ROOMS:
        return None
    path = ROOT.joinpath(*parts)
    return next((file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()), None)


def _definition(module: str, name: str) -> Path | None:
    """The file that defines a name which a module of the rooms may only pass on."""
    file = _file(module)
    if file is None or file.name != "__init__.py":
        return file
    source = _gathered(file).get(name)
    return (_file(f"{source}.{name}") or _definition(source, name)) if source else file


@cache
def _gathered(file: Path) -> dict[str, str]:
    """Names that a module imports from others, for good or for type checkers, and from where."""
    return {name: module for module, name in imports(file.read_text(encoding="utf-8")) if module}


def entities(
    name: str, title: str, results: Mapping[str, str], versions: Mapping[str, str], ended: datetime
) -> dict[str, Any]:
    """Metadata of a run as JSON-LD."""
    run = f"#run-{name}"
    files = [_file_entity(path, digest) for path, digest in results.items()]
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


def _file_entity(path: str, digest: str) -> dict[str, Any]:
    kind = _FORMATS[Path(path).suffix]
    return _entity(path, "File", name=path, encodingFormat=kind, **({"sha256": digest} if digest else {}))


def _entity(identifier: str, kind: str | list[str], **properties: Any) -> dict[str, Any]:
    return {"@id": identifier, "@type": kind, **properties}


def _id(identifier: str) -> dict[str, str]:
    return {"@id": identifier}


def _ids(identifiers: Iterable[str]) -> list[dict[str, str]]:
    return [_id(identifier) for identifier in identifiers]
