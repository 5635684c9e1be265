"""Tables in text files (CSV in UTF-8): what separates cells, decimal mark, rows, headings with units."""

import csv
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import Any, BinaryIO, TextIO

import pandas as pd
from numpy.typing import NDArray

from storage.files import regular
from workflow.language.grammar import measures
from workflow.language.wordings import plain
from workflow.study.reading import InputError, number

LONGEST_CELL = 200  # characters of a cell; a name or a number has a tenth of that
_LONGEST_ROW = 1 << 16  # characters
_WRITTEN_TOGETHER = 1 << 14  # rows
_HEAD = 1 << 16  # bytes from which separator and decimal mark are seen
_SEPARATORS = {"\t": "tabs", ";": "semicolons", ",": "commas"}
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1b]")
_DECIMAL_COMMA = re.compile(r'(?:^|[;\t])\s*"?[-+\u2212]?[0-9]*,[0-9]', re.MULTILINE)
_DIGITS = re.compile(r"[-+\u2212]?[0-9.,]+")
_HEADING = re.compile(
    r"(?P<name>.*?)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*(?:\([^()]*\))?)\)|/\s*(?P<over>.+))\s*"
)


@dataclass(frozen=True)
class Sheet:
    """A table's file: how its cells and numbers are told apart."""

    path: Path
    separator: str  # one character
    decimal_comma: bool

    def open(self) -> TextIO:
        """The file as text."""
        return self.path.open(newline="", encoding="utf-8-sig")

    def rows(self, file: TextIO, most_lines: int) -> Iterator[tuple[int, list[str]]]:
        """Rows that are neither blank nor begin with #, each with its last line's number."""
        characters = 0

        def pieces() -> Iterator[str]:
            nonlocal characters
            while piece := file.readline(_LONGEST_ROW + 1):
                characters += len(piece)
                if characters > _LONGEST_ROW:
                    raise InputError(f"{self.path}: line {reader.line_num + 1}: longer than {_LONGEST_ROW} characters")
                yield piece

        reader = csv.reader(pieces(), strict=True, delimiter=self.separator)
        for row in islice(reader, most_lines):
            characters = 0
            if any(map(str.strip, row)) and not row[0].lstrip().startswith("#"):
                yield reader.line_num, row
        if next(reader, None) is not None:
            raise InputError(f"{self.path}: more than {most_lines} lines")

    def with_point(self, text: str) -> str:
        """A cell with a decimal point in place of the table's mark; ValueError where a mark may group digits."""
        mark, other = ",." if self.decimal_comma else ".,"
        if (digits := _DIGITS.match(text)) and (other in digits[0] or digits[0].count(mark) > 1):
            raise ValueError(f"{text!r}: the decimal mark of this table is {mark!r}; do not group digits")
        return text.replace(mark, ".", 1)

    @property
    def separators(self) -> str:
        """The separator in words."""
        return _SEPARATORS[self.separator]


def sheet(path: Path, largest: int) -> Sheet:
    """Separator and decimal mark of a table's file; InputError if it is no text."""
    if regular(path).stat().st_size > largest:
        raise InputError(f"{path}: larger than {largest} bytes")
    with path.open("rb") as file:
        text = file.read(_HEAD).decode("utf-8-sig", errors="ignore")
    if control := _CONTROL.search(text):
        raise InputError(f"{path}: is no text file: it holds the character {control[0]!r}; a table is CSV in UTF-8")
    header = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    unquoted = re.sub(r'"[^"]*"', "", header)
    separator = next((mark for mark in _SEPARATORS if mark in unquoted), ",")
    return Sheet(path, separator, separator != "," and bool(_DECIMAL_COMMA.search(text)))


def is_number(text: str) -> bool:
    """Return whether a cell is a number without a unit."""
    try:
        number(text)
    except ValueError:
        return False
    return True


def heading(cell: str, known: Collection[str]) -> tuple[str, str | None]:
    """Name and unit of a column from its heading: ``force [N]``, ``force (N)``, ``force / N`` or ``force_N``.

    The unit is None where there is none. A name that is not known is returned as it is written.
    """
    text = " ".join(cell.split())
    if name := _named(text, known):
        return name, None
    if match := _HEADING.fullmatch(text):
        unit = next(match[key] for key in ("square", "round", "over") if match[key] is not None)
        return _named(match["name"], known) or match["name"], unit.strip()
    head, _, tail = text.rpartition("_")
    if (name := _named(head, known)) and is_unit(tail):
        return name, tail
    return text, None


def _named(text: str, known: Collection[str]) -> str | None:
    """A known name behind how it is written: case, blanks and hyphens count for nothing."""
    text = text.strip().strip("\"'")
    if text in known:
        return text
    plain = re.sub(r"[\s\-_]+", "_", text).casefold()
    return plain if plain in known else None


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, or one in brackets."""
    return bool(text.strip()) and not is_number(text) and measures(text.strip().strip("[]()"))


def quick_number(text: str) -> float | None:
    """Return the number of a cell in plain ASCII digits; None for a cell that needs a closer look."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if isfinite(value) and text.isascii() and "_" not in text else None


def write_columns(file: BinaryIO, columns: Mapping[str, NDArray[Any]], *, headed: bool = True) -> None:
    """Write columns by their headings as CSV: every digit of a number, nothing for NaN and None."""
    frame = pd.DataFrame(columns)
    for begin in range(0, len(frame), _WRITTEN_TOGETHER):
        block = frame.iloc[begin : begin + _WRITTEN_TOGETHER].astype(object).map(plain)
        block.to_csv(file, header=headed and not begin, index=False, lineterminator="\n")
