"""Pages that MkDocs makes from the code: commands, keys of a study, modules, figures, notebooks (a hook of MkDocs)."""

import ast
import contextlib
import io
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File
from pygments.formatters import HtmlFormatter

from solver import names
from solver.described import Described
from solver.fields import FIELDS, POINT_FIELDS
from workflow.cli.main import COMMANDS, main
from workflow.report.page import TEMPLATES
from workflow.study.schema import default_text

ROOT = Path(__file__).parents[1]
#: Files that ``python -m docs`` draws; a site without them leaves their figures out.
DRAWN = ROOT / "build/figures"
ROOMS = ("solver", "surrogate", "workflow", "storage", "approximation", "verification")
_REPORT = "results/quickstart/report.html"
_LINK = re.compile(rf"\[([^\]]+)\]\((?:\.\./)+((?:examples|config)/[\w.-]+|{re.escape(_REPORT)})\)")
_IMAGE = re.compile(r"^!\[[^\]]*\]\(([\w.-]+)\)$", re.MULTILINE)
_SCRIPT = re.compile(r"^\[`(examples/\w+\.py)`\]\(\.\./\1\)$", re.MULTILINE)
_ROLE = re.compile(r":\w+:<code>~?([\w.]+)</code>")
_BLOCK = re.compile(r"```(\w+)\n(.*?)```\n?", re.DOTALL)
_FILE = re.compile(r"`([\w/-]+\.(?:yaml|csv))`:\s*\Z")


def on_config(config: Any) -> Any:
    """Replace the theme's search, which reads its index from a server; list the calculator where it was drawn."""
    if (DRAWN / "calculator.html").is_file():
        config.nav[1]["Get started"].append({"Calculator": "calculator.html"})
    config.extra_javascript = [
        "search.js" if str(script) == "search/main.js" else script for script in config.extra_javascript
    ]
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add the generated pages, and copies of the examples, studies and figures that pages link to."""
    pages = {
        "commands.md": commands(),
        "study.md": study(),
        "modules.md": modules(),
        "quantities.md": quantities(),
        "problem.svg": (TEMPLATES / "halfplane.svg").read_text(encoding="utf-8"),
        "pygments.css": HtmlFormatter(style="friendly").get_style_defs(".highlight"),
    }
    for page in sorted((ROOT / "docs/tutorials").glob("*.md")):
        pages[f"tutorials/{page.stem}.ipynb"] = notebook(page.read_text(encoding="utf-8"))
    for name, content in pages.items():
        files.append(File.generated(config, name, content=content))
    for source in [*ROOT.glob("examples/*.*"), *ROOT.glob("config/*.yaml"), *ROOT.glob(_REPORT)]:
        files.append(File.generated(config, source.relative_to(ROOT).as_posix(), abs_src_path=str(source)))
    for source in [*DRAWN.rglob("*.svg"), *DRAWN.glob("*.html")]:
        files.append(File.generated(config, source.relative_to(DRAWN).as_posix(), abs_src_path=str(source)))
    return files


def on_page_markdown(markdown: str, page: Any, files: Any, **_: Any) -> str:
    """Point links to project files at their copies, show linked scripts, drop images that were not drawn."""
    folder, _, _ = page.file.src_uri.rpartition("/")
    up = "../" if folder else ""

    def linked(link: re.Match[str]) -> str:
        words, path = link.groups()
        return f"[{words}]({up}{path})" if (ROOT / path).is_file() else words

    def drawn(image: re.Match[str]) -> str:
        return image[0] if files.get_file_from_path(f"{folder}/{image[1]}".lstrip("/")) else ""

    return _LINK.sub(linked, _SCRIPT.sub(_shown, _IMAGE.sub(drawn, markdown)))


def on_page_content(html: str, **_: Any) -> str:
    """Show Sphinx roles of docstrings as plain code."""
    return _ROLE.sub(r"<code>\1</code>", html)


def on_post_build(config: Any) -> None:
    """Write the search index as a script, which a browser may load from a folder."""
    folder = Path(config.site_dir) / "search"
    index = (folder / "search_index.json").read_text(encoding="utf-8")
    (folder / "index.js").write_text(f"searched({index})\n", encoding="utf-8")


def commands() -> str:
    """Markdown page with the help of every command."""
    parts = [f"## meecontact {name}\n\n```text\n{_help(name)}```\n" for name in COMMANDS]
    opening = "Bad input ends with exit status 2 and one line: field, value and what is allowed. Nothing is written."
    return "\n".join(["# Every command\n", opening + "\n", f"```text\n{_help()}```\n", *parts])


def study() -> str:
    """Markdown page with every key of a study and its default."""
    examples = ", ".join(f"[{file.stem}](../config/{file.name})" for file in sorted((ROOT / "config").glob("*.yaml")))
    return f"""# The study file

A study is one YAML file of at most 1 MB. A number is in SI, or has its unit behind it (`20 um`, see
[numbers with units](names.md#numbers-with-units)). An unknown key is refused by name. Every key stands
below with its default. [Design and read-out](design.md) explains design questions,
[the data set](data.md) films and layers, [the surrogate](surrogate.md) levels that are left open.

Studies to begin with: {examples}.

```yaml
{default_text()}```
"""


def quantities() -> str:
    """Markdown page with the factors, quantities, fields and limits of `solver.names`."""
    head = "# Every factor and quantity\n\n[Factors, quantities, materials](names.md) explains choices and formulas.\n"
    factors = [
        f"| `{name}` | {entry.units} | {'' if entry.default is None else f'{entry.default:g}'} | "
        f"{entry.allowed.removeprefix('a finite number').partition('[')[0].strip() or 'any'} | {entry.long_name} |"
        for name, entry in names.FACTORS.items()
    ]
    limits = [
        f"| `{name}` | {entry.units} | {entry.long_name} | {', '.join(f'`{bound}`' for bound in names.LIMITED[name])} |"
        for name, entry in names.LIMITS.items()
    ]
    return "\n".join(
        [
            head,
            _table("Factors", "factor | unit | default | allowed | meaning", factors),
            *(_table(title, "name | unit | meaning", _rows(described)) for title, described in _QUANTITIES.items()),
            _table("Limits", "limit of a material | unit | meaning | bounds", limits),
        ]
    )


_QUANTITIES: dict[str, dict[str, Described]] = {
    "Half-planes": names.EVERY_QUANTITY,
    "Films": names.EVERY_FILM_QUANTITY,
    "Contacts in air": names.GAP_QUANTITIES | names.POINT_GAP_QUANTITIES,
    "Electrodes": names.ELECTRODE_QUANTITIES,
    "Heat of a touch": names.HEAT_QUANTITIES,
    "Constants for heat": names.THERMAL,
    "Points": names.POINT_QUANTITIES,
    "Sliding points": names.POINT_SLIDING,
    "Contacts in space": names.SPACE_QUANTITIES,
    "Maps of contacts in space": names.MAPS,
    "Fields": FIELDS,
    "Fields of points": POINT_FIELDS,
}


def _rows(described: Mapping[str, Described]) -> list[str]:
    """Rows of a table of names, units and meanings."""
    return [f"| `{name}` | {entry.units} | {entry.long_name} |" for name, entry in described.items()]


def _table(title: str, head: str, rows: list[str]) -> str:
    """A section with one table."""
    return "\n".join([f"## {title}\n", f"| {head} |", "|---" * (head.count("|") + 1) + "|", *rows, ""])


def modules() -> str:
    """Markdown page with the first docstring line of every module, room by room."""
    parts = [
        "# Every module\n",
        "The first line of each module's docstring. [Architecture](architecture.md) explains the rooms.\n",
    ]
    for package in sorted(file for room in ROOMS for file in (ROOT / room).rglob("__init__.py")):
        room = package.parent
        rows = [f"- `{file.name}`: {_opening(file)}" for file in sorted(room.glob("*.py")) if file != package]
        parts += [f"## {room.relative_to(ROOT)}\n", f"{_opening(package)}\n", "\n".join(rows) + "\n"]
    return "\n".join(parts)


def _opening(path: Path) -> str:
    """First line of a module's docstring."""
    return (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]


def _help(*command: str) -> str:
    """Help text of the command line, or of one command."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
        main([*command, "--help"])
    return printed.getvalue()


def _shown(link: re.Match[str]) -> str:
    """Folded listing of a linked script."""
    code = (ROOT / link[1]).read_text(encoding="utf-8").rstrip()
    lines = [f"[Download](../{link[1]})", "", "```python", *code.splitlines(), "```"]
    return "\n".join([f'??? example "{link[1]}"', "", *(f"    {line}".rstrip() for line in lines)])


@dataclass(frozen=True)
class Part:
    """A part of a tutorial."""

    kind: str  # "markdown", "python", "sh", "text" (printed output), or the language of a file's content
    text: str
    file: str = ""  # where the reader writes the content, if the prose before it ends in "`config/mine.yaml`:"


def tutorial_parts(page: str) -> list[Part]:
    """Parts of a tutorial in their order."""
    parts, end = [], 0
    for block in _BLOCK.finditer(page):
        prose = page[end : block.start()].strip()
        file = _FILE.search(prose) if block[1] not in ("python", "sh", "text") else None
        parts += [Part("markdown", prose), Part(block[1], block[2].rstrip("\n"), file[1] if file else "")]
        end = block.end()
    return [part for part in [*parts, Part("markdown", page[end:].strip())] if part.text]


def notebook(page: str) -> str:
    """Tutorial as a Jupyter notebook, without printed output."""
    cells = [_cell(k, part) for k, part in enumerate(tutorial_parts(page)) if part.kind != "text"]
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}, indent=1)


def _cell(number: int, part: Part) -> dict[str, object]:
    """Notebook cell of one part."""
    common = {"id": f"part-{number}", "metadata": {}}
    if part.kind == "markdown":
        return {"cell_type": "markdown", "source": part.text, **common}
    source = part.text
    if part.kind == "sh":
        source = "\n".join(f"!{line}" for line in part.text.splitlines())
    elif part.file:
        source = f"%%writefile {part.file}\n{part.text}"
    return {"cell_type": "code", "source": source, "outputs": [], "execution_count": None, **common}
