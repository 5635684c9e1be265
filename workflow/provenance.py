"""What a result depends on: the sources behind a script, the versions behind a run."""

import ast
import hashlib
import json
import platform
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("solver", "surrogate", "workflow")
PACKAGES = ("meecontact", "numpy", "scipy", "xarray", "netCDF4", "scikit-learn", "snakemake", "pydantic", "matplotlib")


@cache
def sources(module: Path) -> frozenset[Path]:
    """Files of the rooms that a module imports, directly or not, itself included; a package's data files too."""
    found: set[Path] = set()
    waiting = [module]
    while waiting:
        path = waiting.pop()
        if path in found:
            continue
        found.add(path)
        if path.suffix == ".py":
            waiting += _imported(path)
            if path.name == "__init__.py":
                waiting += [data for data in path.parent.iterdir() if data.suffix == ".toml"]
    return frozenset(found)


def code(*paths: str) -> str:
    """Hash over the sources behind scripts (and over plain files, such as templates), relative to the project's root.

    Snakemake sees an edit in a script but not in a package that the script imports: this hash, as a parameter of the
    rule, makes the edit rerun exactly what depends on it.
    """
    files = sorted({file for path in paths for file in sources(ROOT / path)})
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.relative_to(ROOT).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def versions() -> dict[str, str]:
    """Versions of Python and of the named packages."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def write(path: Path, study_digest: str, seed: int, results: list[Path]) -> None:
    """Write ``provenance.json``: versions, hashes of sources, study and results, the seed and the machine."""
    content = {
        "study_sha256": study_digest,
        "seed": seed,
        "sources_sha256": code(*(f"{room}/{file.relative_to(ROOT / room)}" for room in ROOMS for file in _room(room))),
        "versions": versions(),
        "platform": platform.platform(),
        "results_sha256": {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in results},
    }
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _room(room: str) -> list[Path]:
    return sorted(file for file in (ROOT / room).rglob("*") if file.is_file() and "__pycache__" not in file.parts)


def _imported(path: Path) -> Iterator[Path]:
    """Files of the rooms that one module's import statements name."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        for name in names:
            parts = name.split(".")
            if parts[0] not in ROOMS:
                continue
            for depth in range(1, len(parts) + 1):  # importing a.b runs a/__init__.py as well
                target = ROOT.joinpath(*parts[:depth])
                yield from (file for file in (target / "__init__.py", target.with_suffix(".py")) if file.is_file())
