"""The documentation: every command and every block of Python in it is run, its picture is the code's, it builds."""

import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import pytest
import yaml

from tests.workflow.conftest import Project
from workflow.run.provenance import ROOT

PAGES = sorted((ROOT / "docs").glob("*.md"))
SHOWN = [ROOT / "README.md", *PAGES]  # the README's Python is run by tests/test_documents.py
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
# run elsewhere: a cluster's by `make slurm`
ELSEWHERE = {"meecontact run quickstart --profile slurm": "tests/slurm/test_slurm.py"}


def blocks(kind: str, pages: Sequence[Path] = PAGES) -> list[tuple[str, str]]:
    """Pages and blocks of one kind, in the order of the pages."""
    return [
        (page.name, text)
        for page in pages
        for found, text in BLOCK.findall(page.read_text(encoding="utf-8"))
        if found == kind
    ]


@pytest.fixture(scope="module")
def project(quickstart: Project, tmp_path_factory: pytest.TempPathFactory) -> Project:
    """A folder of its own, in which the quickstart has run."""
    project = Project(tmp_path_factory.mktemp("docs") / "project")
    shutil.copytree(quickstart.folder, project.folder)
    return project


@pytest.mark.parametrize(
    ("page", "text"), [*blocks("sh", SHOWN)], ids=lambda part: part if part.endswith(".md") else ""
)
def test_every_command_runs(page: str, text: str, project: Project) -> None:
    for line in text.strip().replace("\\\n", " ").splitlines():
        command = shlex.split(line, comments=True)
        if line in ELSEWHERE:
            called = (ROOT / ELSEWHERE[line]).read_text(encoding="utf-8")
            assert ", ".join(f'"{word}"' for word in command) in called
        elif command[0] == ".":
            assert command[1:] == [".venv/bin/activate"]  # beside the programs that `project.run` takes
        elif command[0] == "make":
            makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
            assert re.search(rf"^{command[1]}:", makefile, re.MULTILINE)
            for setting in command[2:]:
                assert (ROOT / "config" / f"{setting.partition('=')[2]}.yaml").is_file()
        else:
            assert command[0] in ("meecontact", "snakemake")
            project.run(*command)


@pytest.mark.parametrize(("page", "text"), [*blocks("python")], ids=lambda part: part if part.endswith(".md") else "")
def test_every_block_of_python_runs(page: str, text: str, project: Project) -> None:
    environment = {**os.environ, "PYTHONPATH": str(project.folder)}
    command = [sys.executable, "-W", "error", "-c", text]
    done = subprocess.run(command, cwd=project.folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()


def test_there_are_commands_and_python_to_run() -> None:
    assert len(blocks("sh")) >= 4
    assert len(blocks("python")) >= 1
    other = {kind for page in PAGES for kind, _ in BLOCK.findall(page.read_text(encoding="utf-8"))}
    assert other <= {"sh", "python"}


def test_the_picture_is_the_code_s() -> None:
    picture = picture_module()
    assert (ROOT / "docs/pipeline.svg").read_text(encoding="utf-8") == picture.draw(picture.arrows(picture.rulegraph()))


def test_the_picture_leaves_out_what_a_longer_way_implies() -> None:
    picture = picture_module()
    assert picture.shortened({("a", "b"), ("b", "c"), ("a", "c"), ("a", "d")}) == {("a", "b"), ("b", "c"), ("a", "d")}
    at = picture.places({("a", "b"), ("b", "c"), ("a", "c"), ("a", "d")})
    assert [at[rule][0] for rule in "abcd"] == [0, 1, 2, 1]


def picture_module() -> ModuleType:
    spec = importlib.util.spec_from_file_location("picture", ROOT / "docs/picture.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_documentation_builds_and_needs_no_network(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    pages = list(tmp_path.glob("*.html"))
    assert {page.stem for page in pages} >= {page.stem for page in PAGES}
    for page in pages:
        for tag in re.findall(r"<(?:script|link|img)\b[^>]*>", page.read_text(encoding="utf-8")):
            assert not re.search(r"(?:src|href)=\"(?:https?:)?//", tag), tag


def test_every_page_is_in_the_navigation() -> None:
    listed = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]
    assert {name for entry in listed for name in entry.values()} == {page.name for page in PAGES}


def test_citation_names_the_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert f'version = "{citation["version"]}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert {"cff-version", "message", "title", "authors", "license"} <= citation.keys()
