"""Tables in text files of programs and spreadsheets: encoding, separator, decimal mark, rows, headings."""

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

from solver.units import CELSIUS
from storage.files import regular
from workflow.language.grammar import measures
from workflow.language.wordings import plain
from workflow.study.reading import InputError, number

LONGEST_CELL = 200  # characters of a cell; a name or a number has a tenth of that
_LONGEST_ROW = 1 << 16  # characters
_WRITTEN_TOGETHER = 1 << 14  # rows
_HEAD = 1 << 16  # bytes that decide encoding and separator
_SEPARATORS = {"\t": "tabs", ";": "semicolons", ",": "commas"}
_FORMATS = {
    b"PK\x03\x04": "a workbook (Excel .xlsx, LibreOffice .ods) or another archive; save the sheet as CSV",
    b"\xd0\xcf\x11\xe0": "an Excel workbook (.xls); save the sheet as CSV",
    b"\x1f\x8b": "compressed (gzip); unpack it",
    b"%PDF": "a PDF; a table is a text file (CSV)",
    b"\x89HDF": "an HDF5 or netCDF-4 file; a table is a text file (CSV)",
    b"CDF": "a netCDF file; a table is a text file (CSV)",
    b"\x89PNG": "a picture; a table is a text file (CSV)",
    b"TDSm": "a LabVIEW file (.tdms); export it as text (.lvm, CSV)",
    b"MATLAB 5": "a MATLAB file (.mat); export it as CSV",
    b"{\\rtf": "a formatted text (RTF); save it as plain text",
}
_MARKUP = re.compile(rb"\s*<(!doctype|html|\?xml|table|body)", re.IGNORECASE)
_MISSING_WORDS = """
na n/a n.a. n.a #n/a #na nan -nan null none nil - -- --- n.d. n.d nd n.m. ? ?? missing void empty tbd . .. ...
<na> nat \\n k.a. undefined unknown #value! #div/0! #null! #num! #ref!
"""
_MISSING = frozenset(_MISSING_WORDS.split())
_FILLS = re.compile(r"-9{4,6}(\.0*)?")  # numbers that stand for a missing value
_BRACKETED = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*(?:\([^()]*\))?)\))\s*")
_DIVIDED = re.compile(r"(?P<name>[^,;/|]+?)\s*[,;/|]\s*(?P<unit>.+)|(?P<before>.+?)\s+in\s+(?P<behind>\S.*)")
_DIGITS = re.compile(r"[-+\u2212]?[0-9.,]+")
_GROUPS = re.compile(
    r"[-+\u2212]?[0-9]{1,3}(?:(?P<mark>[ '\u2019_\u00a0\u2009\u202f])[0-9]{3})(?:(?P=mark)[0-9]{3})*(?:[.,][0-9]*)?"
)
_THOUSANDS = re.compile(r"[-+\u2212]?[1-9][0-9]{0,2}(,[0-9]{3})+")
_BY_POINTS = re.compile(r"[-+\u2212]?[1-9][0-9]{0,2}(\.[0-9]{3})+(?![0-9.,]).*")
_WITH_COMMA = re.compile(r"[-+\u2212]?[0-9]+,[0-9]+(?![0-9.,]).*")
_ERROR = re.compile(r"±|\+/-|\+-")


@dataclass(frozen=True)
class Sheet:
    """A table's file with its encoding and separator."""

    path: Path
    encoding: str
    separator: str  # one character

    def open(self) -> TextIO:
        """Open the file as text."""
        return self.path.open(newline="", encoding=self.encoding)

    def rows(self, file: TextIO, most_lines: int) -> Iterator[tuple[int, list[str]]]:
        """Yield the rows that are neither blank nor begin with #, each with its last line's number."""
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
            if row and row[0].startswith("sep="):
                continue
            if any(map(str.strip, row)) and not row[0].lstrip().startswith("#"):
                yield reader.line_num, row
        if next(reader, None) is not None:
            raise InputError(f"{self.path}: more than {most_lines} lines")

    @property
    def separators(self) -> str:
        """Separator in words."""
        return _SEPARATORS[self.separator]


def sheet(path: Path, largest: int) -> Sheet:
    """Return a table's file with encoding and separator; InputError if it is no text table."""
    if regular(path).stat().st_size > largest:
        raise InputError(f"{path}: larger than {largest} bytes")
    with path.open("rb") as file:
        head = file.read(_HEAD)
    for magic, what in _FORMATS.items():
        if head.startswith(magic):
            raise InputError(f"{path}: is {what}")
    if path.suffix in (".yaml", ".yml"):
        raise InputError(f"{path}: is YAML; a table is a text file (CSV), and --materials takes a material's file")
    if _MARKUP.match(head.removeprefix(b"\xef\xbb\xbf")):
        raise InputError(f"{path}: is a page of HTML or XML; save its table as CSV")
    encoding = _encoding(path, head)
    text = head.decode(encoding, errors="ignore")
    if control := re.search(r"[\x00-\x08\x0e-\x1b]", text):
        raise InputError(f"{path}: is no text file: it holds the character {control[0]!r}; a table is CSV in UTF-8")
    separator = _separator(path, text)
    if separator in ";\t":
        _refuse_both_marks(path, text, separator)
    return Sheet(path, encoding, separator)


def _refuse_both_marks(path: Path, text: str, separator: str) -> None:
    """Raise InputError for ``1.000`` in a table with decimal commas, which may be one thousand."""
    rows = [[cell.strip().strip('"') for cell in line.split(separator)] for line in text.splitlines()]
    if any(_WITH_COMMA.fullmatch(cell) for row in rows for cell in row):
        grouped = next((cell for row in rows for cell in row if _BY_POINTS.fullmatch(cell)), None)
        if grouped is not None:
            raise InputError(
                f"{path}: {grouped[:40]!r} may group its digits: other numbers have decimal commas; do not group"
            )


def _encoding(path: Path, head: bytes) -> str:
    """Return the encoding by the byte-order mark, by zero bytes, or UTF-8, else Windows' own."""
    for mark, name in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig")):
        if head.startswith(mark):
            return name
    if len(head) > 3 and b"\x00" in head[:4]:
        return "utf-16-le" if head[1] == 0 else "utf-16-be"
    for name in ("utf-8-sig", "cp1252"):
        try:
            with path.open(encoding=name) as file:
                while file.read(1 << 20):
                    pass
        except UnicodeDecodeError as error:
            reason = error
        else:
            return name
    raise InputError(f"{path}: encoding: is neither UTF-8 nor UTF-16 ({reason.reason}); save it as 'CSV UTF-8'")


def _separator(path: Path, text: str) -> str:
    """Return the separator of most cells at the beginning of a file."""
    quoted = re.sub(r'"[^"]*"', '""', text)
    lines = [line for line in quoted.splitlines()[:400] if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        return ","
    if (match := re.fullmatch("sep=(.)", lines[0].strip())) and match[1] in _SEPARATORS:  # as Excel writes it
        return match[1]
    counts = {mark: [line.count(mark) for line in lines] for mark in _SEPARATORS}
    for mark in ("\t", ";"):
        if counts[mark][0] or sum(map(bool, counts[mark])) > len(lines) / 2:
            return mark
    if sum(map(bool, counts[","])) <= len(lines) / 2 and "|" in lines[0]:
        raise InputError(f"{path}: separator: columns are separated by '|'; use commas, semicolons or tabs")
    return ","


def is_number(text: str) -> bool:
    """Return whether a cell is a number without a unit."""
    try:
        number(text)
    except ValueError:
        return False
    return True


def heading(cell: str, known: Collection[str]) -> tuple[str, str | None]:
    """Return name and unit, or None, of a column from its heading; an unknown name as it is written.

    Headings: ``force [N]``, ``force (N)``, ``force, N``, ``force / N``, ``force in N``, ``force_N`` and ``Force N``.
    """
    text = " ".join(cell.split())
    if name := _named(text, known):
        return name, None
    if match := _BRACKETED.fullmatch(text):
        unit = match["square"] if match["square"] is not None else match["round"]
        return _named(match["name"], known) or match["name"], unit.strip()
    if match := _DIVIDED.fullmatch(text):
        name, unit = match["name"] or match["before"], (match["unit"] or match["behind"]).strip()
        if _named(name, known) or is_unit(unit):
            return _named(name, known) or name, unit
    for mark in ("_", " "):
        head, separator, tail = text.rpartition(mark)
        if separator and (name := _named(head, known)) and is_unit(tail):
            return name, tail
    return text, None


def _named(text: str, known: Collection[str]) -> str | None:
    """Return the known name of a text, whatever its case, blanks and hyphens; None for an unknown one."""
    text = text.strip().strip("\"'")
    if text in known:
        return text
    plain = re.sub(r"[\s\-_]+", "_", text).casefold()
    return plain if plain in known else None


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, or one in brackets."""
    unit = text.strip().strip("[]()")
    return unit in CELSIUS or (bool(text.strip()) and not is_number(text) and measures(unit))


def quick_number(text: str) -> float | None:
    """Return the number of a cell in plain ASCII digits; None for a cell that needs a closer look."""
    if not text.isascii() or "_" in text:
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if isfinite(value) and "-999" not in text else None


def missing(text: str) -> bool:
    """Return whether a cell holds one of the words or numbers for a missing value."""
    return text.casefold() in _MISSING or text in ("\u2013", "\u2014", "\u2212") or bool(_FILLS.fullmatch(text))


def with_point(text: str, separator: str) -> str:
    """Return a cell with a point for its decimal comma; ValueError where a comma may separate or group digits."""
    if _GROUPS.fullmatch(text):
        raise ValueError(f"{text!r} groups its digits; write plain digits")
    digits = _DIGITS.match(text)
    if digits is None or "," not in digits[0]:
        return text
    if digits[0].count(",") > 1 or "." in digits[0]:
        raise ValueError(f"{text!r} groups its digits; write plain digits")
    if separator == "," and _THOUSANDS.fullmatch(digits[0]):
        raise ValueError(f"{text!r} groups its digits, or has a decimal comma; write plain digits and a point")
    if separator == ",":
        raise ValueError(f"{text!r} has a decimal comma in a table with commas between its cells; write a point")
    return text.replace(",", ".", 1)


def refused(text: str) -> str | None:
    """Return a common reason for which a cell is not a number; None without one."""
    if missing(text):
        return f"{text!r} stands for a missing value; leave the cell empty"
    if _ERROR.search(text):
        return f"{text!r} has an error behind it; write the value alone, and its error in a column of its own"
    return None


def write_columns(file: BinaryIO, columns: Mapping[str, NDArray[Any]], *, headed: bool = True) -> None:
    """Write columns by their headings as CSV: every digit of a number, nothing for NaN and None."""
    frame = pd.DataFrame(columns)
    for begin in range(0, len(frame), _WRITTEN_TOGETHER):
        block = frame.iloc[begin : begin + _WRITTEN_TOGETHER].astype(object).map(plain)
        block.to_csv(file, header=headed and not begin, index=False, lineterminator="\n")
