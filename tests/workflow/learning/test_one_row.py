"""One published value, as docs/learning.md reads it: its study, its row and its words."""

import shlex
from pathlib import Path

import pytest

from surrogate import save
from tests.workflow.learning.test_correction import study_of
from workflow.cli import main

PAGE = Path(__file__).parents[3] / "docs/learning.md"


def blocks(section: str) -> list[str]:
    """Indented blocks in a section of the page."""
    text = PAGE.read_text(encoding="utf-8").split(f"\n## {section}\n")[1].split("\n## ")[0]
    blocks_of_code, lines = [], list[str]()
    for line in [*text.splitlines(), ""]:
        if line.startswith("    "):
            lines.append(line[4:])
        elif lines:
            blocks_of_code.append("\n".join(lines) + "\n")
            lines = []
    return blocks_of_code


def test_one_row_is_learnt_from_as_the_page_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, row, command, words = blocks("One row")
    for folder in ("config", "results/study"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "row.csv").write_text(row, encoding="utf-8")
    surrogate = tmp_path / "results/study/surrogate.nc"
    save(study_of(text, tmp_path / "config")[1], surrogate)
    first, options = command.split(" row.csv --on results/sol_gel/surrogate.nc ")
    assert first == "make run STUDY=sol_gel\nmeecontact learn"
    assert main.main(["learn", str(tmp_path / "row.csv"), "--on", str(surrogate), *shlex.split(options)]) == 0
    assert capsys.readouterr().out == words
