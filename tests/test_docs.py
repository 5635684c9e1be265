"""The documentation: the site builds strictly, every command and every Python block on its pages runs."""

import re
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

import solver
import surrogate
from docs import tutorial
from tests import programs, warm
from tests.workflow.conftest import Project
from workflow.run.provenance import ROOT
from workflow.study.model import load

README = ROOT / "README.md"
PAGES = sorted((ROOT / "docs").glob("*.md"))
SHOWN = [README, *PAGES]
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)


def blocks(kind: str, shown: Sequence[Path] = SHOWN) -> list[Any]:
    """Blocks of one language, each with the name of its page; a block that calls Node.js needs it and ncdump."""
    needs = pytest.mark.needs("node", "ncdump")
    return [
        pytest.param(text, marks=[needs] if re.search(r"^node ", text, re.MULTILINE) else [], id=page.stem)
        for page in shown
        for language, text in BLOCK.findall(page.read_text(encoding="utf-8"))
        if language == kind
    ]


@pytest.fixture(scope="module")
def project(quickstart_run: Project, tmp_path_factory: pytest.TempPathFactory) -> Project:
    """Copy of a folder in which the quickstart has run."""
    project = Project(tmp_path_factory.mktemp("docs") / "project")
    shutil.copytree(quickstart_run.folder, project.folder, symlinks=True)
    return project


@pytest.mark.parametrize("text", blocks("sh"))
def test_every_command_runs(text: str, project: Project) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for line in text.strip().replace("\\\n", " ").splitlines():
        command = shlex.split(line, comments=True)
        if command[0] == "make":
            assert re.search(rf"^{command[1]}:", makefile, re.MULTILINE)
            assert all((ROOT / f"config/{word.partition('=')[2]}.yaml").is_file() for word in command[2:])
        elif command[0] == "node":
            node = [programs.path("node"), *command[1:]]
            assert subprocess.run(node, cwd=project.folder, capture_output=True, check=True).stdout
        elif command != [".", ".venv/bin/activate"] and "slurm" not in command:  # tests/slurm runs that one
            run_once(project, *command)


@cache
def run_once(project: Project, *command: str) -> None:
    """Run a command that several pages show."""
    project.run(*command)


@pytest.mark.parametrize("text", blocks("python", PAGES))
def test_every_block_of_python_runs(text: str, project: Project) -> None:
    assert project.run("python", "-W", "error", "-c", text).stdout.strip()


@pytest.mark.parametrize("text", blocks("yaml"))
def test_every_study_on_a_page_is_one(text: str, tmp_path: Path) -> None:
    study = tmp_path / "shown.yaml"
    study.write_text(text, encoding="utf-8")
    assert load(study).cases > 0


def test_the_readme_prints_its_numbers(tmp_path: Path) -> None:
    text = README.read_text(encoding="utf-8")
    assert all((ROOT / name).exists() for name in re.findall(r"\]\(([\w./-]+)\)", text))  # without a built site
    (code,) = (code for language, code in BLOCK.findall(text) if language == "python")
    done = warm.run(["python", "-W", "error", "-c", code], tmp_path, ROOT)
    assert done.returncode == 0, done.stderr
    radius, _, charge, *_ = done.stdout.splitlines()
    stated = re.search(r"prints (.*?) um of contact radius, and (.*?) pC/N", " ".join(text.split()))
    assert stated
    for line, words, digits in ((radius, stated[1], 2), (charge, stated[2], 1)):
        values = [float(number) for number in re.findall(r"\d+\.\d+", line)]
        assert [f"{value:.{digits}f}" for value in values] == re.findall(r"\d+\.\d+", words)


def test_the_site_builds_strictly_needs_no_network_and_has_every_name(project: Project) -> None:
    for name in ("docs", "mkdocs.yml"):
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        copy(ROOT / name, project.folder / name)
    project.run("mkdocs", "build", "--strict", "--quiet", "--site-dir", "build/docs")
    site = project.folder / "build/docs"
    for page in site.rglob("*.html"):
        html = page.read_text(encoding="utf-8")
        assert "$$" not in html, page  # every formula is MathML
        for tag in re.findall(r"<(?:script|link|img)\b[^>]*>", html):
            assert not re.search(r"(?:src|href)=\"(?:https?:)?//", tag), (page, tag)
    assert (site / "results/quickstart/report.html").is_file()
    api = (site / "api.html").read_text(encoding="utf-8")
    for room in (solver, surrogate):
        assert all(f'id="{room.__name__}.{name}"' in api for name in room.__all__)


@pytest.mark.parametrize("name", sorted(tutorial.ON_QUICKSTART))
def test_a_tutorial_on_the_quickstart_shows_what_it_prints(name: str, project: Project) -> None:
    page = (tutorial.FOLDER / f"{name}.md").read_text(encoding="utf-8")
    assert tutorial.updated(page, project.folder, warm.printed) == page


def test_citation_names_the_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert f'version = "{citation["version"]}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert {"cff-version", "message", "title", "authors", "license"} <= citation.keys()


def test_no_file_names_a_registry() -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    hosts = re.compile("|".join(["python" + "hosted", "pypi" + r"\.org", "npm" + "js", "deb" + r"\.debian"]))
    for name in (name for name in listed.split("\0") if (ROOT / name).is_file()):
        assert not hosts.search((ROOT / name).read_text(encoding="utf-8", errors="replace")), name
