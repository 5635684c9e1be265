"""The documentation: every command and every block of Python in it is run, its pictures are the code's, it builds."""

import html
import io
import re
import shlex
import shutil
import subprocess
import tokenize
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import nbformat
import pytest
import yaml

import solver
import surrogate
from docs import picture, rooms, tutorial
from tests.workflow import nursery
from tests.workflow.conftest import Project
from workflow.design.told import words
from workflow.design.verdict import netcdf
from workflow.run.provenance import ROOT
from workflow.study.model import load

PAGES = sorted((ROOT / "docs").glob("*.md"))
SHOWN = [ROOT / "README.md", *PAGES]  # the README's Python is run by tests/test_documents.py
WRITTEN = [*SHOWN, *tutorial.PAGES, *(ROOT / "docs/api").glob("*.md")]
MADE = {"calculator.html", "commands.md", "study.md", "changelog.md"}  # by docs/pages.py and docs
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
def project(quickstart_run: Project, tmp_path_factory: pytest.TempPathFactory) -> Project:
    """A folder of its own, in which the quickstart has run."""
    project = Project(tmp_path_factory.mktemp("docs") / "project")
    shutil.copytree(quickstart_run.folder, project.folder, symlinks=True)
    return project


def commands() -> list[Any]:
    """Blocks of commands; those of Node.js read files by ncdump, too."""
    needs = pytest.mark.needs("node", "ncdump")
    return [
        pytest.param(page, text, marks=[needs] if re.search(r"^node ", text, re.MULTILINE) else [], id=page)
        for page, text in blocks("sh", SHOWN)
    ]


@pytest.mark.parametrize(("page", "text"), commands())
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
        elif command[0] == "node":
            assert subprocess.run(command, cwd=project.folder, capture_output=True, check=True).stdout
        else:
            assert command[0] in ("meecontact", "snakemake")
            _once(project, *command)


@cache
def _once(project: Project, *command: str) -> None:
    """Run what some pages say alike."""
    project.run(*command)


def test_the_first_run_ends_with_designs_that_can_be_built(quickstart_run: Project) -> None:
    for name in ("sensor", "actuator"):
        answer = netcdf.read(quickstart_run.folder / f"results/quickstart/design/{name}.nc")
        assert words.verdict(answer).kind == words.RECOMMENDED


@pytest.mark.parametrize(("page", "text"), [*blocks("python")], ids=lambda part: part if part.endswith(".md") else "")
def test_every_block_of_python_runs(page: str, text: str, project: Project) -> None:
    assert project.run("python", "-W", "error", "-c", text).stdout.strip()


@pytest.mark.parametrize(("page", "text"), [*blocks("yaml")], ids=lambda part: part if part.endswith(".md") else "")
def test_every_study_in_the_documents_is_one(page: str, text: str, tmp_path: Path) -> None:
    study = tmp_path / "shown.yaml"
    study.write_text(text, encoding="utf-8")
    assert load(study).cases > 0


def test_there_are_commands_and_python_to_run() -> None:
    assert len(blocks("sh")) >= 4
    assert len(blocks("python")) >= 1
    other = {kind for page in PAGES for kind, _ in BLOCK.findall(page.read_text(encoding="utf-8"))}
    assert other <= {"sh", "python", "yaml"}


@pytest.mark.process
def test_the_picture_of_the_pipeline_is_the_code_s() -> None:
    graph = nursery.run(picture.ASKED, ROOT, ROOT).stdout
    assert (ROOT / "docs/pipeline.svg").read_text(encoding="utf-8") == picture.draw(picture.arrows(graph))


def test_a_picture_leaves_out_what_a_longer_way_implies() -> None:
    assert picture.shortened({("a", "b"), ("b", "c"), ("a", "c"), ("a", "d")}) == {("a", "b"), ("b", "c"), ("a", "d")}
    at = picture.places({("a", "b"), ("b", "c"), ("a", "c"), ("a", "d")})
    assert [at[rule][0] for rule in "abcd"] == [0, 1, 2, 1]


def test_the_picture_of_the_rooms_is_that_of_the_imports() -> None:
    pairs = rooms.imports()
    assert (ROOT / "docs/rooms.svg").read_text(encoding="utf-8") == rooms.draw(pairs), "make docs draws it anew"
    row = {name: row for name, (_, row) in rooms.places(pairs).items()}
    assert all(row[above] > row[below] for above, below in pairs)
    assert {("workflow.report", "solver.names"), ("surrogate.face", "storage")} <= pairs
    assert not {below for above, below in pairs if above.startswith("solver")} & {"storage", "workflow", "surrogate"}


def test_every_module_is_listed_with_the_first_line_of_its_docstring() -> None:
    page = rooms.PAGE.read_text(encoding="utf-8")
    assert rooms.listed(page) == page, "make docs writes the list anew"
    assert all(f"- `{path.name}`: " in page for path in (ROOT / "workflow").rglob("[a-z]*.py"))
    paths = re.findall(r"`((?:workflow|solver|surrogate|storage)/[\w/]+\.\w+)`", page)
    assert len(paths) >= 8
    assert all((ROOT / path).is_file() for path in paths)


NAMED = re.compile(r"(?<![\w./-])((?:solver|surrogate|workflow|storage|verification)(?:\.[a-z]\w*)+)(?![\w-])")
PATH = re.compile(
    r"(?<![\w./*-])((?:solver|surrogate|workflow|storage|verification|docs)/[\w/-]+\.(?:py|md|toml|smk|js|j2|svg|rst))\b"
)


def prose(path: Path) -> str:
    """A page, or the comments and docstrings of a module."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return text
    parts = [part for part in tokenize.generate_tokens(io.StringIO(text).readline) if part.type == tokenize.COMMENT]
    return "\n".join([part.string for part in parts] + re.findall(r'"""(.*?)"""', text, re.DOTALL))


def stands(name: str) -> bool:
    """Whether a dotted name is a module, or something that one holds."""
    folder = ROOT
    for part in name.split("."):
        if (folder / f"{part}.py").is_file():
            return True
        if not (folder / part).is_dir():
            return part in ("js", "md", "nc", "py") or f'"{part}"' in (folder / "__init__.py").read_text(
                encoding="utf-8"
            )
        folder /= part
    return True


def test_every_module_that_a_text_names_is_there() -> None:
    root = [ROOT / name for name in ("CONTRIBUTING.md", "Makefile", "mkdocs.yml", ".pre-commit-config.yaml")]
    pages = [*WRITTEN, *root]
    modules = [path for room in rooms.COLUMNS for path in (ROOT / room).rglob("*.py")]
    astray = {
        (str(path.relative_to(ROOT)), name)
        for path in [*pages, *modules]
        for text in [prose(path)]
        for name in {one for one in NAMED.findall(text) if not stands(one)}
        | {one for one in PATH.findall(text) if not (ROOT / one).is_file()}
    }
    assert not astray
    assert not stands("solver.labelled")
    assert not stands("workflow.design.judgement")
    assert stands("workflow.study.load")
    assert stands("solver.face.solution.solve")


@pytest.fixture(scope="module")
def site(project: Project) -> Path:
    """The site of a project in which the quickstart has run."""
    for name in ("docs", "mkdocs.yml", "CHANGELOG.md"):
        put = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        put(ROOT / name, project.folder / name)
    project.run("python", "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", "build/docs")
    return project.folder / "build/docs"


def test_the_site_is_whole_and_needs_no_network(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert {page.stem for page in pages} >= {page.stem for page in WRITTEN} - {"README"}
    assert (site / "results/quickstart/report.html").is_file()
    for page in pages:
        for tag in re.findall(r"<(?:script|link|img)\b[^>]*>", page.read_text(encoding="utf-8")):
            assert not re.search(r"(?:src|href)=\"(?:https?:)?//", tag), tag


def test_every_link_of_the_site_leads_somewhere(site: Path) -> None:
    """Also those into pages that are made from the code, and to files: MkDocs looks at Markdown only."""
    texts = {page: page.read_text(encoding="utf-8") for page in site.rglob("*.html") if page.name != "404.html"}
    places = {page: set(re.findall(r"\b(?:id|name)=\"([^\"]+)\"", text)) for page, text in texts.items()}
    links = 0
    for page, text in texts.items():
        for link in re.findall(r"(?:href|src)=\"([^\"]+)\"", text):
            path, _, place = unquote(html.unescape(link)).partition("#")
            if re.match(r"[a-z]+:|//", path):
                continue
            target = (page.parent / path.partition("?")[0]).resolve() if path else page
            assert target.is_file() or (target / "index.html").is_file(), (page.name, link)
            assert not place or target not in places or place in places[target], (page.name, link)
            links += 1
    assert links > 1000


def test_the_reference_has_every_public_name(site: Path) -> None:
    for room in (solver, surrogate):
        text = (site / f"api/{room.__name__}.html").read_text(encoding="utf-8")
        assert all(f'id="{room.__name__}.{name}"' in text for name in room.__all__)
        assert not re.search(r":(?:func|class|meth|mod):", text)
    said = (site / "commands.html").read_text(encoding="utf-8")
    assert all(f'id="meecontact-{name}"' in said for name in ("solve", "query", "design", "invert", "run"))
    assert "worst_case" in (site / "study.html").read_text(encoding="utf-8")


def test_search_finds_words_in_a_folder_without_a_server(site: Path) -> None:
    """The script of the page, with the little of a browser that it needs."""
    browser = """
      const [site, words] = process.argv.slice(1), fs = require("fs"), vm = require("vm");
      const read = (name) => fs.readFileSync(`${site}/${name}`, "utf8");
      const element = () => ({ dataset: { noResultsText: "none" }, addEventListener: () => {} });
      const ids = { "mkdocs-search-results": element(), "mkdocs-search-query": element() };
      const loaded = [];
      const document = {
        getElementById: (id) => ids[id], createElement: element, head: { append: (script) => loaded.push(script.src) },
      };
      const page = vm.createContext({ document, location: { search: `?q=${words}` }, base_url: ".", URLSearchParams });
      vm.runInContext(read("search.js"), page);
      loaded.forEach((name) => vm.runInContext(read(name), page));
      console.log(ids["mkdocs-search-results"].innerHTML);
    """

    def found(words: str) -> list[str]:
        command = ["node", "-e", browser, str(site), words]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return re.findall(r'href="\./([^"]+)"', done.stdout)

    assert any("names.html" in one for one in found("trailing_tension"))
    assert any("theory" in one for one in found("Stroh")[:5])
    assert any("citing" in one for one in found("cit")[:5])  # the beginning of a word
    assert not found("nosuchword")
    assert not found("%5E%2B~")  # nothing of lunr's own grammar


def test_a_tutorial_is_a_notebook_too(site: Path) -> None:
    for page in tutorial.PAGES:
        book = nbformat.read(site / f"tutorials/{page.stem}.ipynb", as_version=4)
        nbformat.validate(book)
        said = page.read_text(encoding="utf-8")
        code = [cell.source for cell in book.cells if cell.cell_type == "code"]
        assert len(code) == sum(said.count(f"```{kind}\n") for kind in ("python", "sh", "yaml", "csv"))
        assert f"({page.stem}.ipynb)" in said


@pytest.mark.parametrize("name", sorted(tutorial.ON_QUICKSTART))
def test_a_tutorial_on_the_quickstart_says_what_is_printed(name: str, project: Project) -> None:
    page = (tutorial.FOLDER / f"{name}.md").read_text(encoding="utf-8")
    assert tutorial.told(page, project.folder, nursery.printed) == page


def test_every_page_is_in_the_navigation() -> None:
    def listed(entry: object) -> list[str]:
        if isinstance(entry, str):
            return [entry]
        inner = entry.values() if isinstance(entry, dict) else entry
        return [name for one in inner for name in listed(one)]  # type: ignore[attr-defined]

    nav = re.search(r"^nav:\n(?:  .*\n)+", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
    assert nav
    pages = {page.relative_to(ROOT / "docs").as_posix() for page in (ROOT / "docs").rglob("*.md")}
    assert sorted(listed(yaml.safe_load(nav[0])["nav"])) == sorted([*pages, *MADE])


def test_citation_names_the_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert f'version = "{citation["version"]}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert {"cff-version", "message", "title", "authors", "license"} <= citation.keys()
