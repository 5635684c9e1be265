"""Fixtures of the workflow's tests: a small study, and a copy of the project in which it has run."""

import compileall
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.workflow import nursery, plans
from workflow.run.provenance import ROOMS, ROOT

SMALL = """\
title: A small study
fixed: {composite: fibrous}
factors:
  volume_fraction: {low: 0.4, high: 0.8, levels: 8}
  friction: {low: 0.0, high: 0.5, levels: 4}
  radius: {low: 0.02, high: 0.2, levels: 4, scale: log}
  load: {low: 5e3, high: 5e4, levels: 5, scale: log}
dataset: {slabs: 2, positions: {inside: 12, outside: 8}}
surrogate: {outputs: [voltage_sensitivity, stroke_per_volt, trailing_tension, peak_pressure]}
validation: {cases: 200, tolerance: 1e-3}
design:
  sensor:
    maximise: abs(voltage_sensitivity)
    over: [volume_fraction, radius]
    at: {load: 1e4}
    worst_case: {friction: [0.1, 0.4]}
    subject_to: [trailing_tension <= 50 MPa, peak_pressure <= 500 MPa]
  impossible:
    maximise: abs(stroke_per_volt)
    over: [volume_fraction, radius]
    at: {load: 5e4}
    worst_case: {friction: [0.1, 0.4]}
    subject_to: [trailing_tension <= 1 MPa]
effects:
  baseline: {volume_fraction: 0.5, radius: 0.05, load: 1e5, friction: 0.3}
  vary: {friction: [0.0, 0.3], material: [BaTiO3, PZT-4]}
  positions: {inside: 30, outside: 30}
  interior: {across: 21, down: 11}
"""


@dataclass(frozen=True)
class Project:
    """A copy of the project's files with room for results of its own."""

    folder: Path
    modules: Path | None = None  # where Python finds the project's packages; by default in the copy

    def run(
        self, *command: str, check: bool = True, said: str = "", cold: bool = False
    ) -> subprocess.CompletedProcess[str]:
        """Run a command of the virtual environment inside the copy; a fork of a warm process, unless it is cold."""
        packages = self.modules or self.folder
        if command[0] in nursery.PROGRAMS and not cold:
            done = nursery.run(command, self.folder, packages, said)
        else:
            done = subprocess.run(
                [Path(sys.executable).with_name(command[0]), *command[1:]],
                cwd=self.folder,
                env={**os.environ, "PYTHONPATH": str(packages), "OMP_NUM_THREADS": "1"},
                input=said,
                capture_output=True,
                text=True,
                check=False,
            )
        assert not check or done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
        return done

    def snakemake(self, *arguments: str, check: bool = True, cold: bool = False) -> subprocess.CompletedProcess[str]:
        """Run Snakemake on two cores."""
        return self.run("snakemake", "--cores", "2", *arguments, check=check, cold=cold)

    def planned(self, target: str) -> set[str]:
        """Rules that a dry run would execute for a target."""
        done = self.snakemake("-n", "--quiet", "host", "--", target)
        return set(plans.rules(done.stdout + done.stderr))

    def planned_after(self, edits: Sequence[Sequence[tuple[str, str, str]]], target: str) -> list[set[str]]:
        """The same after edits that are made together, (file, old, new), and then others alone; from one process."""
        done = self.run("python", plans.__file__, target, said=json.dumps(edits))
        return [set(found) for found in json.loads(done.stdout)]


@pytest.fixture(scope="session")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the project's files with their bytecode, which copies of it take along."""
    folder = tmp_path_factory.mktemp("compiled")
    for part in (*ROOMS, "meecontact", "config", "examples"):
        shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", folder)
    (folder / "config" / "small.yaml").write_text(SMALL, encoding="utf-8")
    assert compileall.compile_dir(folder, quiet=1)
    return folder


@pytest.fixture(scope="session")
def copy(compiled: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Project]:
    """Make copies of the project that hold the small study."""

    def make(name: str) -> Project:
        return Project(Path(shutil.copytree(compiled, tmp_path_factory.mktemp(name), dirs_exist_ok=True)))

    return make


@pytest.fixture(scope="session")
def ran(copy: Callable[[str], Project]) -> Project:
    """A copy in which the small study has run to its report."""
    project = copy("ran")
    project.run("meecontact", "run", "small", "--cores", "2")
    return project
