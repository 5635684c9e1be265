"""What the site takes from elsewhere: a hook of MkDocs.

Pages made from the code (every command, every key of a study, the changelog), files of the project that pages link to,
tutorials as notebooks, the report of the quickstart where one was run, and an index that is searched without a server.
"""

import contextlib
import io
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File
from pygments.formatters import HtmlFormatter

from docs.notebook import notebook
from workflow.cli.helping import EXAMPLES
from workflow.cli.main import main

ROOT = Path(__file__).parents[1]
REPORT = "results/quickstart/report.html"
_LINK = re.compile(rf"\[([^\]]+)\]\((?:\.\./)+((?:examples|config)/[\w.-]+|{re.escape(REPORT)})\)")
_SCRIPT = re.compile(r"^\[`(examples/\w+\.py)`\]\(\.\./\1\)$", re.MULTILINE)
_ROLE = re.compile(r":\w+:<code>~?([\w.]+)</code>")


def on_config(config: Any) -> Any:
    """The theme's search reads its index from a server; that of search.js needs none."""
    config.extra_javascript = [
        "search.js" if str(script) == "search/main.js" else script for script in config.extra_javascript
    ]
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add what does not stand in this folder; MkDocs calls it by this name."""
    written = {
        "commands.md": commands(),
        "study.md": study(),
        "changelog.md": (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").replace("](docs/", "]("),
        "pygments.css": HtmlFormatter(style="friendly").get_style_defs(".highlight"),
    }
    for page in sorted((ROOT / "docs/tutorials").glob("*.md")):
        written[f"tutorials/{page.stem}.ipynb"] = notebook(page.read_text(encoding="utf-8"))
    for name, content in written.items():
        files.append(File.generated(config, name, content=content))
    for source in [*ROOT.glob("examples/*.*"), *ROOT.glob("config/*.yaml"), *ROOT.glob(REPORT)]:
        files.append(File.generated(config, source.relative_to(ROOT).as_posix(), abs_src_path=str(source)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Links to files of the project lead to their copies; a link to a script on a line of its own shows the script."""
    up = "../" * page.file.src_uri.count("/")

    def linked(link: re.Match[str]) -> str:
        words, path = link.groups()
        return f"[{words}]({up}{path})" if (ROOT / path).is_file() else words

    return _LINK.sub(linked, _SCRIPT.sub(_shown, markdown))


def on_page_content(html: str, **_: Any) -> str:
    """Roles of Sphinx in docstrings are plain code here."""
    return _ROLE.sub(r"<code>\1</code>", html)


def on_post_build(config: Any) -> None:
    """The index of words as a script, which a page may load from a folder; MkDocs calls it by this name."""
    folder = Path(config.site_dir) / "search"
    index = (folder / "search_index.json").read_text(encoding="utf-8")
    (folder / "index.js").write_text(f"searched({index})\n", encoding="utf-8")


def commands() -> str:
    """The page of every command with its help."""
    parts = [f"## meecontact {name}\n\n```text\n{_help(name)}```\n" for name in EXAMPLES]
    opening = "Bad input is one line that names field, value and what is allowed, exit status 2, and nothing written."
    return "\n".join(["# Every command\n", opening + "\n", f"```text\n{_help()}```\n", *parts])


def study() -> str:
    """The page of every key of a study."""
    keys = (ROOT / "config/schema/default.yaml").read_text(encoding="utf-8")
    examples = ", ".join(f"[{file.stem}](../config/{file.name})" for file in sorted((ROOT / "config").glob("*.yaml")))
    return f"""# The study file

A study is one YAML file of at most 1 MB. A number is decimal and has its unit behind it (`20 um`), or is in SI
([numbers with units](units.md)). A key that is not known is refused by name. Every key stands below
with its default. [Design and read-out](design.md) explains questions, [the data set](data.md) films and layers,
[the surrogate](surrogate.md) levels that are left open.

Studies to begin with: {examples}.

```yaml
{keys}```
"""


def _help(*command: str) -> str:
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.suppress(SystemExit):
        main([*command, "--help"])
    return said.getvalue()


def _shown(link: re.Match[str]) -> str:
    code = (ROOT / link[1]).read_text(encoding="utf-8").rstrip()
    lines = [f"[Download](../{link[1]})", "", "```python", *code.splitlines(), "```"]
    return "\n".join([f'??? example "{link[1]}"', "", *(f"    {line}".rstrip() for line in lines)])
