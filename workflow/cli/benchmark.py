"""``meecontact benchmark``: the table of solved problems, and verdicts on another code's numbers."""

import argparse
import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workflow.cli.textfile import sheet, with_point
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, located, number, one_line

TABLE = Path(__file__).with_name("benchmark.csv")
_COLUMNS = ("problem", "quantity", "value")
_MOST_BYTES = 2**20
#: Problem and quantity of a number in the table.
Key = tuple[str, str]


def benchmark(options: argparse.Namespace) -> None:
    """Print the table, or a verdict for each of its numbers."""
    known = {(row["problem"], row["quantity"]): row for row in _rows(TABLE)[0].values()}
    if options.answers is None:
        for (problem, quantity), row in known.items():
            print(f"{problem:26s} {quantity:20s} {row['value']:>17s} {row['units']}")
        return
    answers = _answers(options.answers, known)
    verdicts = {key: verdict(row["value"], answers.get(key)) for key, row in known.items()}
    for (problem, quantity), words in verdicts.items():
        print(one_line(f"{problem:26s} {quantity:20s} {known[problem, quantity]['value']:>17s} {words}"))
    agreeing = sum(words.startswith("agrees") for words in verdicts.values())
    print(f"{agreeing} of {len(answers)} numbers agree to the last digit; {len(known) - len(answers)} are missing")


def verdict(expected: str, answer: float | None) -> str:
    """Return the verdict on an answer: it agrees within one unit of the table's last digit, or its relative error."""
    if answer is None:
        return "missing"
    exact = float(expected)
    mantissa, exponent = expected.split("e")
    unit = 10.0 ** (int(exponent) - len(mantissa.partition(".")[2]))
    if abs(answer - exact) <= unit * (1 + 1e-6):
        return "agrees to the last digit"
    return f"off by {abs(answer - exact) / abs(exact):.1e}"


def _rows(path: Path) -> tuple[dict[int, dict[str, str]], str]:
    """Return the rows of a table with a header, as texts by line of the file, and the separator of cells."""
    table = sheet(path, _MOST_BYTES)
    with located(path, (UnicodeDecodeError, csv.Error)), table.open() as file:
        header, *rows = list(table.rows(file, _MOST_BYTES)) or [(0, [""])]
    names = [name.strip() for name in header[1]]
    cells = {line: [*map(str.strip, row), *[""] * len(names)] for line, row in rows}
    return {line: dict(zip(names, row, strict=False)) for line, row in cells.items()}, table.separator


def _answers(path: Path, known: Mapping[Key, Any]) -> dict[Key, float]:
    """Read the numbers of a file; each must be in the table."""
    answers: dict[Key, float] = {}
    rows, separator = _rows(path)
    if not rows:
        raise InputError(f"{path}: is empty: needs the columns {', '.join(_COLUMNS)} and a row or more")
    for line, row in rows.items():
        for name in _COLUMNS:
            if name not in row:
                raise InputError(f"{path}: no column {name}; must have {', '.join(_COLUMNS)}")
        key = row["problem"], row["quantity"]
        if key not in known:
            choices = [quantity for problem, quantity in known if problem == key[0]]
            wrong, allowed = (key[1], choices) if choices else (key[0], list(dict.fromkeys(name for name, _ in known)))
            raise InputError(f"{path}: line {line}: {wrong}: not in the table; {nearest(wrong, allowed)}")
        if key in answers:
            raise InputError(f"{path}: line {line}: {key[0]}, {key[1]}: given twice")
        try:
            answers[key] = number(with_point(row["value"], separator))
        except ValueError:
            answers[key] = math.nan
        if not math.isfinite(answers[key]):
            raise InputError(f"{path}: line {line}: value: {row['value']!r} is not a finite number")
    return answers
