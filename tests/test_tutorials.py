"""The tutorials, followed from an empty folder: what they say is printed is printed, and their figures are drawn."""

from pathlib import Path

import pytest

from docs import notebook, tutorial
from tests.workflow import nursery

# the others are followed by tests/test_docs.py
PAGES = [page for page in tutorial.PAGES if page.stem not in tutorial.ON_QUICKSTART]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_a_tutorial_says_what_is_printed(path: Path, tmp_path: Path) -> None:
    page = path.read_text(encoding="utf-8")
    assert tutorial.told(page, tmp_path, nursery.printed) == page
    assert page.count("```text\n") >= 2
    drawn = {figure.name for figure in tmp_path.glob("*.svg")}
    assert {name for name in drawn if f"({name})" in page and (path.parent / name).is_file()} == drawn


def test_a_wrong_page_is_told(tmp_path: Path) -> None:
    code = "from pathlib import Path\nprint(Path('a.csv').read_text())"
    page = f"Into `a.csv`:\n\n```csv\nload\n```\n\n```python\n{code}\n```\n\n```text\nloads\n```\n"
    assert tutorial.told(page, tmp_path) == page.replace("loads\n", "load\n\n")
    assert [part.kind for part in notebook.parts(page)] == ["markdown", "csv", "python", "text"]
