"""``meecontact benchmark``: the table of solved problems, and what another code's numbers are worth beside it."""

import argparse
import csv
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from storage.files import regular
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, located, number, one_line

TABLE = Path(__file__).with_name("benchmark.csv")
_COLUMNS = ("problem", "quantity", "value")
_MOST_BYTES = 2**20
#: A number of the table, by problem and quantity.
Key = tuple[str, str]


def benchmark(options: argparse.Namespace) -> None:
    """Print the table, or a verdict for each of its numbers."""
    known = {(row["problem"], row["quantity"]): row for row in _rows(TABLE)}
    if options.answers is None:
        for (problem, quantity), row in known.items():
            print(f"{problem:26s} {quantity:20s} {row['value']:>17s} {row['units']}")
        return
    answers = _answers(options.answers, known)
    verdicts = {key: verdict(row["value"], answers.get(key)) for key, row in known.items()}
    for (problem, quantity), said in verdicts.items():
        print(one_line(f"{problem:26s} {quantity:20s} {known[problem, quantity]['value']:>17s} {said}"))
    within = sum(said.startswith("agrees") for said in verdicts.values())
    print(f"{within} of {len(answers)} numbers agree to the last digit; {len(known) - len(answers)} are missing")


def verdict(expected: str, answer: float | None) -> str:
    """Verdict on an answer: it agrees within one unit of the table's last digit, or by how much it is off."""
    if answer is None:
        return "missing"
    exact = float(expected)
    mantissa, exponent = expected.split("e")
    unit = 10.0 ** (int(exponent) - len(mantissa.partition(".")[2]))
    if abs(answer - exact) <= unit * (1 + 1e-6):
        return "agrees to the last digit"
    return f"off by {abs(answer - exact) / abs(exact):.1e}"


def _rows(path: Path) -> list[dict[str, str]]:
    """Rows of a table with a header, as texts."""
    if regular(path).stat().st_size > _MOST_BYTES:
        raise InputError(f"{path}: larger than {_MOST_BYTES} bytes")
    with located(path, (UnicodeDecodeError, csv.Error)):
        lines = path.read_text(encoding="utf-8-sig").splitlines()
        rows = list(csv.DictReader(lines, strict=True))
    return [{str(name).strip(): str(cell or "").strip() for name, cell in row.items()} for row in rows]


def _answers(path: Path, known: Mapping[Key, Any]) -> dict[Key, float]:
    """The numbers of a file, each of the table."""
    answers: dict[Key, float] = {}
    rows = _rows(path)
    if not rows:
        raise InputError(f"{path}: is empty: needs the columns {', '.join(_COLUMNS)} and a row or more")
    for line, row in enumerate(rows, 2):
        for name in _COLUMNS:
            if name not in row:
                raise InputError(f"{path}: no column {name}; must have {', '.join(_COLUMNS)}, between commas")
        key = row["problem"], row["quantity"]
        if key not in known:
            choices = [quantity for problem, quantity in known if problem == key[0]]
            wrong, allowed = (key[1], choices) if choices else (key[0], list(dict.fromkeys(name for name, _ in known)))
            raise InputError(f"{path}: line {line}: {wrong}: not in the table; {nearest(wrong, allowed)}")
        if key in answers:
            raise InputError(f"{path}: line {line}: {key[0]}, {key[1]}: given twice")
        try:
            answers[key] = number(row["value"])
        except ValueError:
            answers[key] = math.nan
        if not math.isfinite(answers[key]):
            raise InputError(f"{path}: line {line}: value: {row['value']!r} is not a finite number")
    return answers
