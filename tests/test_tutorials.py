"""The tutorials, followed from an empty folder: they show what they print, draw their figures and are notebooks."""

import re
from pathlib import Path

import nbformat
import pytest

from docs import pages, tutorial
from tests import warm

# tests/test_docs.py follows the others
PAGES = [page for page in tutorial.PAGES if page.stem not in tutorial.ON_QUICKSTART]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_a_tutorial_shows_what_it_prints(path: Path, tmp_path: Path) -> None:
    page = path.read_text(encoding="utf-8")
    assert tutorial.updated(page, tmp_path, warm.printed) == page
    drawn = {figure.name for figure in tmp_path.glob("*.svg")}
    assert drawn == set(re.findall(r"\]\(([\w-]+\.svg)\)", page))


@pytest.mark.parametrize("path", tutorial.PAGES, ids=lambda path: path.stem)
def test_a_tutorial_is_a_notebook(path: Path) -> None:
    page = path.read_text(encoding="utf-8")
    book = nbformat.reads(pages.notebook(page), as_version=4)
    nbformat.validate(book)
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    assert len(code) == len(re.findall(r"^```(?:python|sh|yaml|csv)$", page, re.MULTILINE))
    assert f"({path.stem}.ipynb)" in page
