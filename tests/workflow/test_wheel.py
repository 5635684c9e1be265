"""The wheel, away from any checkout: it holds what `meecontact run` needs."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.workflow.conftest import Copy, Project
from workflow.run.provenance import ROOMS, ROOT

MATERIAL = "c11: 166e9\nc12: 77e9\nc13: 78e9\nc33: 162e9\nc44: 43e9\neps11: 11.2e-9\neps33: 12.6e-9\n"
STUDY = """\
title: Effects of a material of our own
materials: [materials/own.yaml]
effects:
  baseline: {material: own, radius: 0.05, load: 1e5}
  vary: {friction: [0.0, 0.4]}
  positions: {inside: 30, outside: 30}
"""


def test_the_installed_program_runs_a_study_from_anywhere(copy: Copy, tmp_path: Path) -> None:
    source = copy("wheel", whole=True).folder
    shutil.copy(ROOT / "pyproject.toml", source)
    (source / "README.md").write_text("# meecontact\n", encoding="utf-8")
    build = "from setuptools.build_meta import build_wheel; print(build_wheel('.'))"
    build_output = subprocess.run([sys.executable, "-c", build], cwd=source, capture_output=True, text=True, check=True)
    site, work = tmp_path / "site", tmp_path / "work"
    with zipfile.ZipFile(source / build_output.stdout.split()[-1]) as wheel:
        held = {name for name in wheel.namelist() if ".dist-info/" not in name}
        wheel.extractall(site)
    files = {file for room in (*ROOMS, "meecontact") for file in (ROOT / room).rglob("*") if file.is_file()}
    wanted = {str(file.relative_to(ROOT)) for file in files if "__pycache__" not in file.parts}
    studies = (*ROOT.glob("config/*.yaml"), source / "config/small.yaml")
    wanted |= {f"meecontact/studies/{file.name}" for file in studies}
    assert held - {"meecontact/studies/small.yaml"} == wanted - {"meecontact/studies/small.yaml"}

    study = tmp_path / "studies/mine.yaml"
    (study.parent / "materials").mkdir(parents=True)
    study.write_text(STUDY, encoding="utf-8")
    (study.parent / "materials/own.yaml").write_text(MATERIAL, encoding="utf-8")
    work.mkdir()
    installed = Project(work, modules=site)
    done = installed.run("meecontact", "run", "quickstar", check=False)
    assert done.returncode == 2
    assert f"study: 'quickstar' is unknown: {work} has no config/*.yaml; go to a folder that has one" in done.stderr
    assert done.stderr.count("\n") == 1
    assert "did you mean 'quickstart'?" in done.stderr
    assert not list(work.iterdir())
    done = installed.run("meecontact", "run", "quickstart", "-n")
    assert done.stdout.endswith("writing the page\n")  # the steps in words
    done = installed.run("meecontact", "run", "../studies/mine.yaml", "--cores", "2")
    assert "workflow specific profile" not in done.stderr  # no path of this machine before the first step
    assert done.stdout.endswith("report: results/mine/report.html\n")
    assert "Effects of a material of our own" in (work / "results/mine/report.html").read_text(encoding="utf-8")
    assert sorted(file.name for file in work.iterdir()) == [".snakemake", "logs", "results"]


SOLVE = """
import importlib.util, sys
absent = dict.fromkeys(("matplotlib", "snakemake", "pygments"))
sys.modules |= absent  # as if they were not installed
find = importlib.util.find_spec
importlib.util.find_spec = lambda name: None if name in absent else find(name)
from workflow.cli.main import main
print(main(["solve", "cases.csv", "-o", "out.nc"]), main(["run", "quickstart"]))
"""


@pytest.mark.slow
def test_cases_are_solved_without_what_runs_need(tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("material,radius,load\nPZT-4,5 cm,10 kN/m\n", encoding="utf-8")
    done = Project(tmp_path, modules=ROOT).run("python", "-c", SOLVE, cold=True)
    assert done.stdout == "0 2\n"
    assert "meecontact: run: snakemake and matplotlib not installed; pip install 'meecontact[run]'" in done.stderr
    assert (tmp_path / "out.nc").is_file()
