"""The table of docs/measurements.md from a run: ``python docs/measurements.py`` writes it into the page."""

import re
from collections.abc import Sequence
from pathlib import Path

from workflow.language.numbers import number
from workflow.measured.comparison import Row, compared
from workflow.study.model import load

ROOT = Path(__file__).parents[1]
PAGE, STUDY = ROOT / "docs/measurements.md", ROOT / "config/measured.yaml"
_HEAD = "| row | measured | model | standard deviations off | verdict |\n|---|---|---|---|---|\n"


def rows() -> list[Row]:
    """The rows of the study, compared."""
    return compared(load(STUDY).measurements)


def table(compared_rows: Sequence[Row]) -> str:
    """A line a row, as Markdown."""
    return _HEAD + "".join(f"| {' | '.join(_cells(row))} |\n" for row in compared_rows)


def _cells(row: Row) -> list[str]:
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    error = f" ± {number(row['error'])}" if row["error"] else ""
    model = [
        number(quantity["value"]) + (f" ± {number(quantity['deviation'], 1)}" if quantity["deviation"] else "")
        for quantity in row["model"]
    ]
    off = ["–" if quantity["off"] is None else _short(quantity["off"]) for quantity in row["model"]]
    link = " because " if row["verdict"] == "cannot be told" else ": "
    verdict = f"{row['verdict']}{link}{row['because']}"
    value = number(row["value"]) if row["value"] else "–"
    return [row["of"], f"{value}{error}{unit}", "; ".join(model) or "–", "; ".join(off) or "–", verdict]


def _short(deviations: float) -> str:
    return number(round(deviations, 2), 2)


def written(text: str, compared_rows: Sequence[Row]) -> str:
    """The page with the table in place of the one that it has."""
    return re.sub(re.escape(_HEAD) + r"(\|.*\n)*", lambda _: table(compared_rows), text)


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8"), rows()), encoding="utf-8")
