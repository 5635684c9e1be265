"""Tables of cases that people write: CSV with a header of factor names, read in bounded memory and time."""

import csv
import re
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from solver import units
from solver.names import CHOICES, MATERIALS
from storage.files import regular
from workflow.language.factors import FACTORS
from workflow.language.renamed import renamed
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, number

_LARGEST = 1 << 28  # bytes
_MOST_CASES = 1_000_000
_MOST_LINES = 4 * _MOST_CASES  # blank ones among them
_LONGEST_ROW = 1 << 16  # characters
_NAME = re.compile(r"(?P<name>\w+)\s*\[(?P<unit>[^\[\]]*)\]")
_LONGEST_CELL = 200  # characters; a name or a number has a tenth of that

#: Factors whose values are names.
TEXT_FACTORS = (*MATERIALS, *CHOICES)
_COLUMNS = (*TEXT_FACTORS, *FACTORS)


@dataclass(frozen=True)
class Table:
    """Cases by column."""

    source: str  # What the table was read from
    # One array a factor, one entry a case: numbers as float64, NaN where the cell is empty; names as objects, None
    # where the cell is empty
    columns: dict[str, NDArray[Any]]
    lines: NDArray[np.int64]  # Line of the file that each case stands on; none of what was not read from a file

    def at(self, row: int) -> str:
        """Where a case stands, for messages."""
        return f"{self.source}: line {self.lines[row]}" if self.lines.size else self.source

    def empty(self, name: str) -> NDArray[np.bool_]:
        """Which cells of a column are empty."""
        column = self.columns[name]
        empty: NDArray[np.bool_] = np.isnan(column) if column.dtype.kind == "f" else column == np.array(None)
        return empty

    def numbers(self, name: str, needs: str) -> NDArray[np.float64]:
        """A column of numbers of which every row of a file has one."""
        if name not in self.columns:
            raise InputError(f"{self.source}: {name}: missing; {needs}")
        column = self.columns[name]
        if column.dtype.kind != "f":
            raise InputError(f"{self.source}: {name}: holds names; must hold numbers")
        if (empty := self.empty(name)).any() and self.lines.size:
            raise InputError(f"{self.at(int(empty.argmax()))}: {name}: empty; must be a number")
        return column


def read_cases(path: Path, more: Mapping[str, str] = MappingProxyType({})) -> Table:
    """Read a table of cases: a header of factor names, then one row a case; a cell may be empty.

    A number may have its unit behind it, as ``20 um``, or its column has it, as ``thickness [um]``;
    the table holds SI units. What begins with # is
    a remark.
    """
    try:
        if regular(path).stat().st_size > _LARGEST:
            raise InputError(f"{path}: larger than {_LARGEST} bytes")
        with path.open(newline="", encoding="utf-8-sig") as file:
            return _read(path, file, more)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: not a CSV table in UTF-8: {error}") from None


def _read(path: Path, file: TextIO, more: Mapping[str, str]) -> Table:
    rows = _rows(path, file)
    _, first = next(rows, (0, []))
    scales = _header(path, first, more)
    header = list(scales)
    numbers: dict[str, array[float]] = {name: array("d") for name in header if name not in TEXT_FACTORS}
    texts: dict[str, list[str | None]] = {name: [] for name in header if name in TEXT_FACTORS}
    lines = array("q")
    known: dict[str, str | None] = {"": None}  # every name is kept once, however often it occurs
    for line, row in rows:
        if len(lines) == _MOST_CASES:
            raise InputError(f"{path}: line {line}: more than {_MOST_CASES} cases; split the table")
        if len(row) != len(header):
            raise InputError(f"{path}: line {line}: {len(row)} cells, the header has {len(header)}")
        for name, cell in zip(header, row, strict=True):
            text = cell.strip()
            if len(text) > _LONGEST_CELL:
                shown = f"{text[:20]}..."
                raise InputError(f"{path}: line {line}: {name}: {shown!r} has more than {_LONGEST_CELL} characters")
            if name in numbers:
                numbers[name].append(_number(path, line, name, text, more, scales[name]))
            else:
                if text and text not in (allowed := CHOICES.get(name, (text,))):
                    raise InputError(f"{path}: line {line}: {name}: {text!r} is not one of {', '.join(allowed)}")
                texts[name].append(known.setdefault(text, text))
        lines.append(line)
    if not lines:
        raise InputError(f"{path}: needs a header of factor names and at least one case")
    columns: dict[str, NDArray[Any]] = {name: np.frombuffer(values) for name, values in numbers.items()}
    columns |= {name: np.array(cells, dtype=object) for name, cells in texts.items()}
    return Table(str(path), {name: columns[name] for name in header}, np.frombuffer(lines, dtype=np.int64))


def _rows(path: Path, file: TextIO) -> Iterator[tuple[int, list[str]]]:
    """Rows that are neither blank nor begin with #, with their last lines; one too long is never held."""
    read = 0

    def pieces() -> Iterator[str]:
        nonlocal read
        while piece := file.readline(_LONGEST_ROW + 1):
            read += len(piece)
            if read > _LONGEST_ROW:
                raise InputError(f"{path}: line {reader.line_num + 1}: longer than {_LONGEST_ROW} characters")
            yield piece

    reader = csv.reader(pieces(), strict=True)
    for row in islice(reader, _MOST_LINES):
        read = 0
        if row and not row[0].startswith("#"):
            yield reader.line_num, row
    if next(reader, None) is not None:
        raise InputError(f"{path}: more than {_MOST_LINES} lines")


def _header(path: Path, row: list[str], more: Mapping[str, str]) -> dict[str, float]:
    """Names of the columns, and what SI units their numbers have to be multiplied by."""
    scales: dict[str, float] = {}
    known = (*_COLUMNS, *more)
    for cell in row[: len(known) + 1]:  # one of them is unknown or stands there twice
        shown = cell.strip()[:_LONGEST_CELL]
        match = _NAME.fullmatch(shown)
        name, unit = (match["name"], match["unit"]) if match else (shown, None)
        name = renamed(name, known)
        if name not in known and name not in FACTORS:
            kind = "column" if more else "factor"
            raise InputError(f"{path}: column {shown!r}: unknown {kind}; {nearest(name, list(known))}")
        if name in scales:
            raise InputError(f"{path}: column {name!r}: given twice")
        scales[name] = 1.0 if unit is None else _scale(path, name, unit, more)
    return scales


def _scale(path: Path, name: str, unit: str, more: Mapping[str, str]) -> float:
    if name in TEXT_FACTORS:
        raise InputError(f"{path}: column {name!r}: holds names, which have no unit")
    own = more.get(name) or FACTORS[name].units
    try:
        parsed = units.parse(unit)
    except ValueError as error:
        raise InputError(f"{path}: column {name!r}: {error}") from None
    if not parsed.fits(units.parse(own)):
        raise InputError(f"{path}: column {name!r}: unit mismatch: {unit!r} does not measure what {own!r} measures")
    return parsed.scale


def _number(path: Path, line: int, name: str, text: str, more: Mapping[str, str], scale: float) -> float:
    if not text:
        return np.nan
    allowed = f"a finite number [{more[name]}]" if name in more else FACTORS[name].allowed
    try:
        value = number(text)
        value = value if scale == 1 else units.scaled(text, scale)
    except ValueError:
        value = _with_unit(path, line, name, text, more.get(name) or FACTORS[name].units, allowed)
    if not np.isfinite(value):
        raise InputError(f"{path}: line {line}: {name}: {value:g} is not {allowed}")
    return value


def _with_unit(path: Path, line: int, name: str, text: str, own: str, allowed: str) -> float:
    """A cell that bears its own unit, whatever the column's."""
    try:
        return units.in_si(text, own)
    except ValueError as error:
        wrong = str(error) if "mismatch" in str(error) else f"{text!r} is not {allowed}"
        raise InputError(f"{path}: line {line}: {name}: {wrong}") from None
