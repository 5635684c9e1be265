"""Provenance of a result: hashes of sources, and versions of packages; a job refuses sources edited since its plan.

Snakemake records the hash of the sources as its run begins. Results of sources that were edited since, and restored
before the next run, would stay under that hash.
"""

import hashlib
import json
import platform
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path

from storage.files import write_text
from storage.sealed import sha256

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("approximation", "storage", "solver", "surrogate", "workflow", "verification")

#: Endings of the data files that a job may read beside its modules.
DATA = (".toml", ".j2", ".js", ".css", ".svg")
PACKAGES = ("meecontact", "numpy", "scipy", "xarray", "netCDF4", "scikit-learn", "snakemake", "pydantic", "matplotlib")


class ChangedError(RuntimeError):
    """A source is another than when the run of this job began."""


@cache
def sources(module: Path) -> frozenset[Path]:
    """Return the files of the rooms that a module uses, directly or not, itself included, and data files they name."""
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
    """Return a hash over the sources of scripts and over plain files, relative to the project's root.

    Snakemake does not see an edit in a module that a script imports: as a parameter of the rule, the hash does.
    """
    files: set[Path] = set()
    for path in paths:
        file = ROOT / path
        files |= sources(file) if file.suffix == ".py" else {file}
    return _hash(sorted(files))


def _hash(files: list[Path]) -> str:
    digest = hashlib.sha256()
    for file in files:
        digest.update(_content(file))
    return digest.hexdigest()[:16]


@cache
def _content(file: Path) -> bytes:
    """Return name and content of a file, which most rules hash."""
    return file.relative_to(ROOT).as_posix().encode() + b"\0" + file.read_bytes() + b"\0"


def versions() -> dict[str, str]:
    """Return the versions of Python and of `PACKAGES`."""
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


def _room(room: str) -> list[Path]:
    return sorted(file for file in (ROOT / room).rglob("*") if file.is_file() and "__pycache__" not in file.parts)


@cache
def _data(room: str) -> list[Path]:
    return [file for file in _room(room) if file.suffix in DATA]


@cache
def _named(path: Path) -> tuple[frozenset[Path], frozenset[Path]]:
    """Return the modules and data files of the rooms that a module names, and data files that its templates name."""
    text, data_files = path.read_text(encoding="utf-8"), _data(path.relative_to(ROOT).parts[0])
    data = {file for file in data_files if file.name in text}
    templates = "".join(file.read_text(encoding="utf-8") for file in data if file.suffix == ".j2")
    modules = {
        (_file(f"{module}.{name}") or _definition(module, name)) if module else _file(name)
        for module, name in imports(text)
    }
    return frozenset(filter(None, modules)), frozenset(data | {file for file in data_files if file.name in templates})


_IMPORT = re.compile(r"^[ \t]*(?:from ([\w.]+) )?import (\([^)]*\)|.*)", re.MULTILINE)


def imports(text: str) -> Iterator[tuple[str, str]]:
    """Yield imported names of a module, ``(module, name)`` or ``("", module)``; by lines, faster than parsing."""
    for module, names in _IMPORT.findall(text):
        for name in re.sub(r"#.*|[()]", "", names).split(","):
            if named := name.split():
                yield module, named[0]


@cache
def _file(name: str) -> Path | None:
    """Return the file of a module of the rooms; None for other modules."""
    parts = name.split(".")
    if parts[0] not in ROOMS:
        return None
    path = ROOT.joinpath(*parts)
    return next((file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()), None)


def _definition(module: str, name: str) -> Path | None:
    """Return the file that defines a name which a room's ``__init__`` may only pass on."""
    file = _file(module)
    if file is None or file.name != "__init__.py":
        return file
    source = _gathered(file).get(name)
    return (_file(f"{source}.{name}") or _definition(source, name)) if source else file


@cache
def _gathered(file: Path) -> dict[str, str]:
    """Return the modules from which a module imports names, by name; imports for type checkers included."""
    return {name: module for module, name in imports(file.read_text(encoding="utf-8")) if module}


def digests(files: Iterable[Path] | None = None) -> dict[str, str]:
    """Return the hash of every file of the rooms, or of `files`, by path below the root; empty for a missing one."""
    wanted = [file for room in ROOMS for file in _room(room)] if files is None else files
    return {file.relative_to(ROOT).as_posix(): _digest(file) for file in wanted}


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16] if file.is_file() else ""


def used(script: str) -> set[Path]:
    """Return a script, the modules of the rooms that this process has imported, and data files beside them."""
    modules = [file for module in tuple(sys.modules.values()) if (file := getattr(module, "__file__", None))]
    files = [file.rpartition("/") for file in (script, *modules)]
    rooms = {ROOT / room for room in ROOMS}
    within = {name: Path(name).resolve() for name in {folder for folder, _, _ in files}}  # folders are few
    within = {name: folder for name, folder in within.items() if rooms & {folder, *folder.parents}}
    imported = {within[folder] / name for folder, _, name in files if folder in within}
    folders = set(within.values())
    data_files = [data for folder in folders for part in ("*", "templates/*") for data in folder.glob(part)]
    return imported | {data for data in data_files if data.suffix in DATA}


def check(planned: Mapping[str, str], script: str) -> None:
    """Refuse sources other than those that a job was planned with."""
    for name, digest in digests(sorted(used(script))).items() if planned else ():
        if planned.get(name) != digest:
            raise ChangedError(f"{name}: was changed after this job was planned; run the study again")
