"""A tutorial in parts: its prose, its Python, its commands and the files that its reader writes; as a notebook too."""

import json
import re
from dataclasses import dataclass

_BLOCK = re.compile(r"```(\w+)\n(.*?)```\n?", re.DOTALL)
_FILE = re.compile(r"`([\w/-]+\.(?:yaml|csv))`:\s*\Z")


@dataclass(frozen=True)
class Part:
    """A part of a page."""

    kind: str  # ``markdown``, ``python``, ``sh``, ``text`` (what is printed), or another: the content of a file
    text: str  # What stands there
    file: str = ""  # Where the reader writes it, as the last word of the prose before it says: "`config/mine.yaml`:"


def parts(page: str) -> list[Part]:
    """The parts of a page in their order."""
    found, end = [], 0
    for block in _BLOCK.finditer(page):
        prose = page[end : block.start()].strip()
        file = _FILE.search(prose) if block[1] not in ("python", "sh", "text") else None
        found += [Part("markdown", prose), Part(block[1], block[2].rstrip("\n"), file[1] if file else "")]
        end = block.end()
    return [part for part in [*found, Part("markdown", page[end:].strip())] if part.text]


def notebook(page: str) -> str:
    """The page as a Jupyter notebook, without what is printed."""
    cells = [_cell(k, part) for k, part in enumerate(parts(page)) if part.kind != "text"]
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}, indent=1)


def _cell(number: int, part: Part) -> dict[str, object]:
    common = {"id": f"part-{number}", "metadata": {}}
    if part.kind == "markdown":
        return {"cell_type": "markdown", "source": part.text, **common}
    source = part.text
    if part.kind == "sh":
        source = "\n".join(f"!{line}" for line in part.text.splitlines())
    elif part.file:
        source = f"%%writefile {part.file}\n{part.text}"
    return {"cell_type": "code", "source": source, "outputs": [], "execution_count": None, **common}
