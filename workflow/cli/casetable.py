"""Tables of cases: CSV with a header of factor names, read in bounded memory and time."""

import csv
import sys
from array import array
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from types import MappingProxyType
from typing import Any, TextIO

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver import units
from solver.names import CHOICES, HEIGHT_MAP, MATERIALS
from workflow.cli.textfile import (
    LONGEST_CELL,
    Sheet,
    heading,
    is_number,
    is_unit,
    missing,
    quick_number,
    refused,
    sheet,
    with_point,
)
from workflow.cli.words import named, quantity
from workflow.language.factors import FACTORS, own_kind
from workflow.language.given import check_bare
from workflow.language.renamed import renamed
from workflow.language.spelling import suggested
from workflow.study.reading import InputError, located, number

_LARGEST = 1 << 28  # bytes
_MOST_CASES = 1_000_000
_MOST_LINES = 4 * _MOST_CASES  # blank ones among them

#: Factors whose values are names.
TEXT_FACTORS = (*MATERIALS, *CHOICES, HEIGHT_MAP)
_COLUMNS = (*TEXT_FACTORS, *FACTORS)


@dataclass(frozen=True)
class Table:
    """Cases by column."""

    source: str  # file or option
    columns: dict[str, NDArray[Any]]  # by factor, (case,): float64 or names as objects; NaN or None in empty cells
    lines: NDArray[np.int64]  # line in the file, (case,); empty for an option
    bare: frozenset[str] = frozenset()  # columns with a number that has no unit

    @property
    def count(self) -> int:
        """Number of cases."""
        return len(next(iter(self.columns.values())))

    def at(self, row: int) -> str:
        """Return file and line of a case for messages."""
        return f"{self.source}: line {self.lines[row]}" if self.lines.size else self.source

    def empty(self, name: str) -> NDArray[np.bool_]:
        """Return whether each cell of a column is empty, (case,)."""
        return np.asarray(pd.isna(self.columns[name]))

    def numbers(self, name: str, needs: str) -> NDArray[np.float64]:
        """Return a column of numbers, (case,); InputError for an empty cell in a file."""
        if name not in self.columns:
            raise InputError(f"{self.source}: {name}: missing; {needs}")
        column = self.columns[name]
        if column.dtype.kind != "f":
            raise InputError(f"{self.source}: {name}: holds names; must hold numbers")
        if (empty := self.empty(name)).any() and self.lines.size:
            raise InputError(f"{self.at(int(empty.argmax()))}: {name}: empty; must be a number")
        return column


def one_case(option: str, text: str, units: Mapping[str, str] | None = None) -> Table:
    """Read one case from an option ``NAME=VALUE,...``, of factors, or of names with their units."""
    columns: dict[str, NDArray[Any]] = {}
    bare = set()
    for name, value in named(option, text, valued=True).items():
        if name in (FACTORS if units is None else units):
            unit, factor = (FACTORS[name].units, name) if units is None else (units[name], "")
            columns[name] = np.array([quantity(f"{option}: {name}", value, unit, factor)])
            bare |= {name} if is_number(value) else set()
        else:  # a name, or a factor that solver or surrogate will refuse
            columns[name] = np.array([value], dtype=object)
    return Table(option, columns, np.empty(0, dtype=np.int64), frozenset(bare))


def read_cases(path: Path, measured: Mapping[str, str] = MappingProxyType({})) -> Table:
    """Read a table of cases: a header of factor names, then one row a case; a cell may be empty.

    A number may have its unit behind it, as ``20 um``, or in the header, or in a row of units below the header; the
    table holds SI units. A row that begins with # is a remark. ``measured``: units of further columns by name.
    """
    (table,) = read_blocks(path, None, measured)
    return table


def read_blocks(path: Path, rows: int | None, measured: Mapping[str, str] = MappingProxyType({})) -> Iterator[Table]:
    """Read a table of any length in blocks of at most so many cases, or one table of limited size for None."""
    try:
        file = sheet(path, _LARGEST if rows is None else sys.maxsize)
        with file.open() as text:
            yield from _Reader(file, measured).tables(text, rows)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: not a CSV table in {file.encoding}: {error}") from None


def _empty(header: Collection[str]) -> tuple[dict[str, Any], "array[int]"]:
    """Return empty columns, arrays of numbers or lists of names, and lines."""
    return {name: [] if name in TEXT_FACTORS else array("d") for name in header}, array("q")


@dataclass(frozen=True)
class _Reader:
    """Reader of a table's file, which may have columns of numbers beside factors."""

    sheet: Sheet
    measured: Mapping[str, str]  # units by name

    @property
    def known(self) -> tuple[str, ...]:
        """Names of the columns that a table may have; own names of layers come on top."""
        return (*_COLUMNS, *self.measured)

    def tables(self, file: TextIO, most: int | None) -> Iterator[Table]:
        """Yield the table of a file, in blocks of at most so many cases if that is given."""
        path = self.sheet.path
        rows = self.sheet.rows(file, _MOST_LINES if most is None else sys.maxsize)
        units_of_columns = self.header(next(rows, (0, [""]))[1], rows)
        header = list(units_of_columns)
        second = next(rows, None)
        if second and (units_below := self.units_row(header, second[1])):
            units_of_columns |= {name: unit for name, unit in units_below.items() if units_of_columns[name] is None}
            second = next(rows, None)
        if second is None:
            raise InputError(f"{path}: needs a header of factor names and at least one case")
        scales = {name: 1.0 if unit is None else self.scale(name, unit) for name, unit in units_of_columns.items()}
        columns, lines = _empty(header)
        bare: set[str] = set()
        for line, row in chain([second], rows):
            where = f"{path}: line {line}"
            if len(lines) == most:
                yield self.made(columns, lines, bare)
                columns, lines = _empty(header)
            if most is None and len(lines) == _MOST_CASES:
                raise InputError(f"{where}: more than {_MOST_CASES} cases; split the table")
            if len(row) > len(header) and not any(map(str.strip, row[len(header) :])):
                row = row[: len(header)]
            if len(row) != len(header):
                raise InputError(f"{where}: {len(row)} cells, the header has {len(header)}{self.hint(row)}")
            for name, cell in zip(header, row, strict=True):
                text = cell.strip()
                try:
                    if len(text) > LONGEST_CELL:
                        raise ValueError(f"{f'{text[:20]}...'!r} has more than {LONGEST_CELL} characters")
                    if name in TEXT_FACTORS:
                        columns[name].append(self.name(name, text))
                    else:
                        columns[name].append(self.number(name, text, scales[name], units_of_columns[name], bare))
                except ValueError as error:
                    raise InputError(f"{where}: {name}: {error}") from None
            lines.append(line)
        yield self.made(columns, lines, bare)

    def made(self, columns: Mapping[str, Any], lines: "array[int]", bare: Collection[str]) -> Table:
        """Return the table of some rows."""
        arrays = {
            name: np.array(cells, dtype=object if name in TEXT_FACTORS else float) for name, cells in columns.items()
        }
        return Table(str(self.sheet.path), arrays, np.array(lines), frozenset(bare))

    def header(self, row: list[str], rows: Iterator[tuple[int, list[str]]]) -> dict[str, str | None]:
        """Return the names of the columns, and the unit of each in the header."""
        path, known = self.sheet.path, self.known
        columns: dict[str, str | None] = {}
        last = max((place for place, cell in enumerate(row) if cell.strip()), default=0)
        row = row[: last + 1]  # without separators at the end of the line
        if row and all(is_number(cell) for cell in row if cell.strip()) and any(map(str.strip, row)):
            raise InputError(f"{path}: has no header; the first row must name the columns, as 'radius [mm],force [N]'")
        for cell in row[: len(known) + 1]:  # one of them is unknown or occurs twice
            shown = " ".join(cell.split())[:LONGEST_CELL]
            name, unit = heading(shown, known)
            name = renamed(name, known)
            if name not in known and own_kind(name) is None:
                raise InputError(f"{path}: column {shown!r}: {self.unknown(cell, name, unit, rows)}")
            if name in columns:
                raise InputError(f"{path}: column {name!r}: given twice")
            if unit is not None and name in TEXT_FACTORS:
                raise InputError(f"{path}: column {name!r}: holds names, which have no unit")
            columns[name] = unit or None
            if unit:
                self.scale(name, unit)
        return columns

    def unknown(self, cell: str, name: str, unit: str | None, rows: Iterator[tuple[int, list[str]]]) -> str:
        """Return the reason for which a heading cannot be read, with the probable name."""
        if not cell.strip() and not any(True for _ in islice(rows, 1)):
            raise InputError(f"{self.sheet.path}: is empty: needs a header of factor names and at least one case")
        if not cell.strip():
            return "has no heading; a row index is left out, as by to_csv(index=False)"
        marks = [mark for mark in ("|", ";", "\t", "  ") if mark in cell.strip()]
        if marks:
            return f"separator: columns are separated by {marks[0]!r}; use commas, semicolons or tabs"
        for line, row in islice(rows, 20):
            if len(row) > 1 and all(heading(cell, self.known)[0] in self.known for cell in row):
                return f"is no heading; the header is line {line}: begin the lines above it with #, or remove them"
        kind = "column" if self.measured else "factor"
        if near := suggested(name.casefold(), self.known):
            return f"unknown {kind}; did you mean {near + (f' [{unit}]' if unit else '')!r}?"
        return f"unknown {kind}; all names: meecontact list factors"

    def units_row(self, header: list[str], row: list[str]) -> dict[str, str]:
        """Return the units by column of a row below the header; empty where it has other cells."""
        units_of_columns = {}
        for name, cell in zip(header, row, strict=False):
            text = cell.strip().strip("[]()").strip()
            if not text or text in ("-", "\u2013", "1"):
                continue
            if name in TEXT_FACTORS or not is_unit(text):
                return {}
            units_of_columns[name] = text
        return units_of_columns

    def units_of(self, name: str) -> str:
        """Return the SI units of a column of numbers."""
        return self.measured.get(name) or FACTORS[name].units

    def scale(self, name: str, unit: str) -> float:
        """Return the factor to SI units for numbers of a column; 1 for temperatures in degrees Celsius."""
        if unit in units.CELSIUS and self.units_of(name) == "K":
            return 1.0
        with located(f"{self.sheet.path}: column {name!r}"):
            parsed = units.parse(unit)
            if not parsed.fits(units.parse(self.units_of(name))):
                raise ValueError(f"unit mismatch: {unit!r} does not measure what {self.units_of(name)!r} measures")
        return parsed.scale

    def number(self, name: str, text: str, scale: float, unit: str | None, bare: set[str]) -> float:
        """Read a number in SI units, NaN from an empty cell; ValueError for any other text."""
        if not text:
            return np.nan
        value = quick_number(text) if scale == 1 else None
        if value is None:
            if reason := refused(text):
                raise ValueError(reason)
            text = with_point(text, self.sheet.separator)
            if not is_number(text):
                return self.with_unit(name, text)
            value = number(text) if scale == 1 else units.scaled(units.plain(text), scale)
            if not np.isfinite(value):
                raise ValueError(f"{value:g} is not {self.allowed(name)}")
        if unit in units.CELSIUS:
            return value + units.FREEZING
        if unit is None and value:
            bare.add(name)
            check_bare(name, value)
        return value

    def with_unit(self, name: str, text: str) -> float:
        """Read a cell with its own unit, whatever the column's."""
        try:
            return units.in_si(text, self.units_of(name))
        except ValueError as error:
            mismatch = "mismatch" in str(error)
            raise ValueError(str(error) if mismatch else f"{text!r} is not {self.allowed(name)}") from None

    def allowed(self, name: str) -> str:
        """Return the allowed numbers of a column in words."""
        return f"a finite number [{self.measured[name]}]" if name in self.measured else FACTORS[name].allowed

    def name(self, name: str, text: str) -> str | None:
        """Read a cell of names; None where it is empty."""
        if not text:
            return None
        if text not in (allowed := CHOICES.get(name, (text,))) or (name in MATERIALS and missing(text)):
            if missing(text):
                raise ValueError(f"{text!r} stands for a missing value; leave the cell empty")
            raise ValueError(f"{text!r} is not one of {', '.join(allowed)}")
        return sys.intern(text)  # stored once, however often it occurs

    def hint(self, row: list[str]) -> str:
        """Return the probable cause of a row of other length than the header's."""
        if self.sheet.separator == "," and len(row) > 1:
            return "; a decimal comma? then separate columns by semicolons or tabs"
        return f" (columns are separated by {self.sheet.separators})"
