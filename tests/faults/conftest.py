"""A study small enough to be run many times, its undisturbed results, and how they are compared."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.workflow.conftest import Copy, Project

TINY = """\
title: A tiny study
fixed: {composite: fibrous}
factors:
  volume_fraction: {low: 0.4, high: 0.6, levels: 5}
  friction: {low: 0.0, high: 0.5, levels: 4}
  load: {low: 5e3, high: 5e4, levels: 4, scale: log}
  radius: {low: 0.02, high: 0.2, levels: 4, scale: log}
dataset: {slabs: 2, positions: {inside: 12, outside: 8}}
surrogate: {outputs: [voltage_per_load, trailing_tension, peak_pressure]}
validation: {cases: 100, tolerance: 1e-3}
effects:
  baseline: {volume_fraction: 0.5, radius: 0.05, load: 1e5, friction: 0.3}
  vary: {friction: [0.0, 0.3]}
  positions: {inside: 30, outside: 30}
"""
RESULTS = Path("results/tiny")
REPORT = str(RESULTS / "report.html")
#: They need all that is solved and learnt.
FILES = ("validation.nc", "figures/fields.svg", "figures/effect_friction.svg")

# what holds measured times, or is written for people
NOT_COMPARED = {
    "timing.json", "datacard.json", "datacard.md", "provenance.json", "report.html", "study.yaml",
}  # fmt: skip


def contents(project: Project, study: str = "tiny") -> dict[str, bytes]:
    """Bytes of every file of a study's results, hidden ones too, that a fault must not change."""
    results = project.folder / "results" / study
    files = [file for file in results.rglob("*") if file.is_file() and file.name not in NOT_COMPARED]
    return {str(file.relative_to(results)): file.read_bytes() for file in files}


@pytest.fixture(scope="session")
def tiny(copy: Copy) -> Callable[[str], Project]:  # the fixture of that name
    """Make copies of the project that hold the tiny study."""

    def make(name: str) -> Project:
        project = copy(name)
        (project.folder / "config/tiny.yaml").write_text(TINY, encoding="utf-8")
        return project

    return make


@pytest.fixture(scope="session")
def undisturbed(tiny: Callable[[str], Project]) -> Project:
    """A copy in which the tiny study has run to these files without any fault."""
    project = tiny("undisturbed")
    project.snakemake(*(str(RESULTS / name) for name in FILES))
    return project
