"""The sources that a job was planned with: what it has imported is what they were when its run began, or it refuses.

Snakemake records the hash of the sources as its run begins. A job that imported what was edited since, and put back
before the next run, would leave results of other sources under that hash, and the next run would find nothing to be
done.
"""

import hashlib
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("approximation", "storage", "solver", "surrogate", "workflow", "verification")

#: Endings of the data files that a job may read beside its modules.
DATA = (".toml", ".j2", ".js", ".css", ".svg")


class ChangedError(RuntimeError):
    """A source is another than when the run of this job began."""


def digests(files: Iterable[Path] | None = None) -> dict[str, str]:
    """Hash of every file of the rooms, or of some of them, by its path below the root; empty for one that is gone."""
    wanted = [file for room in ROOMS for file in sorted((ROOT / room).rglob("*"))] if files is None else files
    source_files = [file for file in wanted if "__pycache__" not in file.parts and not file.is_dir()]
    return {file.relative_to(ROOT).as_posix(): _digest(file) for file in source_files}


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16] if file.is_file() else ""


def used(script: str) -> set[Path]:
    """A script, the modules of the rooms that this process has imported by now, and the data files beside these."""
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
