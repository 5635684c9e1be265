"""Fixtures of the workflow's tests: a small study, and a folder in which it has run."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests import warm
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
surrogate: {outputs: [voltage_per_load, stroke_per_volt, trailing_tension, peak_pressure]}
validation: {cases: 200, tolerance: 1e-3}
design:
  sensor:
    maximise: abs(voltage_per_load)
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
    """Folder of studies and results, and the folder of the packages."""

    folder: Path
    modules: Path = ROOT

    def run(self, *command: str, check: bool = True, cold: bool = False) -> subprocess.CompletedProcess[str]:
        """Run a command of the virtual environment inside the folder, as a fork of a warm process unless it is cold."""
        if command[0] in warm.PROGRAMS and not cold:
            done = warm.run(command, self.folder, self.modules)
        else:
            done = subprocess.run(
                [Path(sys.executable).with_name(command[0]), *command[1:]],
                cwd=self.folder,
                env={**os.environ, "PYTHONPATH": str(self.modules), "OMP_NUM_THREADS": "1"},
                stdin=subprocess.DEVNULL,
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
        """Return the rules that a dry run would execute for a target."""
        done = self.snakemake("-n", "--quiet", "host", "--", target)
        output = done.stdout + done.stderr
        rules = set(re.findall(r"^(?:local)?rule (\w+):$", output, re.MULTILINE))
        assert rules or "Nothing to be done" in output, output
        return rules

    def planned_after(self, edits: Sequence[tuple[str, str, str]], target: str) -> set[str]:
        """Return the rules of a dry run after edits of files, (file, old, new), which are undone."""
        before = {file: (self.folder / file).read_text(encoding="utf-8") for file, _, _ in edits}
        try:
            for file, old, new in edits:
                text = (self.folder / file).read_text(encoding="utf-8")
                assert old in text, (file, old)
                (self.folder / file).write_text(text.replace(old, new, 1), encoding="utf-8")
            return self.planned(target)
        finally:
            for file, text in before.items():
                (self.folder / file).write_text(text, encoding="utf-8")


def job(study: str, output: str, *inputs: str, parameter: str | None = None) -> Any:
    """Job of a study that makes one file out of others, as its script sees it; its log is `a.log`."""
    from snakemake.iocontainers import InputFiles, Log, OutputFiles, Params, ResourceList, Snakemake, Wildcards

    files = InputFiles(toclone=list(inputs)), OutputFiles(toclone=[output])
    params = Params() if parameter is None else Params(fromdict={"study": parameter})
    wildcards, log = Wildcards(fromdict={"study": study}), Log(toclone=["a.log"])
    return Snakemake(*files, params, wildcards, 1, ResourceList(), log, {}, "slab", None)


#: Makes a folder of a name with the project's studies and the small one, and with the sources if it is whole.
Copy = Callable[..., Project]


@pytest.fixture(scope="session")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Copy:
    def make(name: str, *, whole: bool = False) -> Project:
        folder = tmp_path_factory.mktemp(name)
        for part in ("config", "examples", *((*ROOMS, "meecontact") if whole else ())):
            shutil.copytree(ROOT / part, folder / part)
        (folder / "config" / "small.yaml").write_text(SMALL, encoding="utf-8")
        if not whole:
            (folder / "workflow").symlink_to(ROOT / "workflow")  # where Snakemake looks for the Snakefile
        return Project(folder, folder if whole else ROOT)

    return make


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The test's folder, which is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def ran(copy: Copy) -> Project:
    """Folder in which the small study has run to its report."""
    project = copy("ran")
    project.run("meecontact", "run", "small", "--cores", "2")
    return project
