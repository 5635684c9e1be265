"""Histories of forces in the files of load cells, testing machines, loggers and oscilloscopes."""

import csv
import re
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import chain
from pathlib import Path

import numpy as np

from approximation.arrays import Array
from solver import units
from workflow.cli.textfile import Sheet, heading, is_number, missing, quick_number, sheet, with_point
from workflow.device.signal import History
from workflow.study.reading import InputError, located, number

MOST_ROWS = 10_000_000
_LARGEST = 1 << 30  # bytes
_MOST_TITLES = 500  # rows before the header
_MOST_RESULTS = 50  # rows of numbers among them: results of specimens
_NOISE = 0.02  # of the largest force, down to which a force below 0 is noise or an offset
_RESOLVED = 1e-6  # of the smallest step, to which times must be representable
_LATE = 1e6  # from which times are subtracted in decimal digits
_RECENT = 1e9  # s from 1970, from which a time is one of Unix
_GRAVITY = 9.80665  # m/s^2
_UNIX = 1e11  # s: 3,000 years, beyond which a time without a unit counts ms, us or ns from 1970

_TIME_UNITS = {
    **dict.fromkeys(["s", "sec", "secs", "second", "seconds", "sekunde", "sekunden", "seg"], 1.0),
    **dict.fromkeys(["ms", "msec", "millisecond", "milliseconds", "millis"], 1e-3),
    **dict.fromkeys(["us", "µs", "μs", "usec", "microsecond", "microseconds", "micros"], 1e-6),
    **dict.fromkeys(["ns", "nsec", "nanoseconds"], 1e-9),
    **dict.fromkeys(["min", "minute", "minutes", "minuten"], 60.0),
    **dict.fromkeys(["h", "hr", "hour", "hours", "stunden"], 3600.0),
}
_WEIGHTS = {  # units of load cells that weigh, in newtons
    **dict.fromkeys(["kgf", "kp", "kg"], _GRAVITY),
    **dict.fromkeys(["gf", "g", "gram", "grams", "p"], 1e-3 * _GRAVITY),
    **dict.fromkeys(["lbf", "lb", "lbs"], 0.45359237 * _GRAVITY),
    "ozf": 0.028349523125 * _GRAVITY,
    "dyn": 1e-5,
    **dict.fromkeys(["newton", "newtons"], 1.0),
    "kn": 1e3,
    **dict.fromkeys(["volt", "volts"], 1.0),
}
_TIME_NAMES = """
time t elapsed_time test_time total_time run_time running_time relative_time x_value zeit prüfzeit
versuchszeit messzeit testzeit temps tiempo tempo timestamp date_time time_stamp datetime date/time x_axis x
time_axis elapsed zeitstempel
"""
_TIMES = frozenset([*_TIME_NAMES.split(), *_TIME_UNITS])
_FORCE_NAMES = """
force load f fn fz f_n axial_force axial_load load_cell loadcell normal_force standard_force compressive_load
compressive_force compression_load contact_force applied_force kraft standardkraft prüfkraft normalkraft
druckkraft fuerza forza carga weight force_z normal_load applied_load test_force force_reading load_reading
force_1 load_1 gewicht
"""
_FORCES = frozenset([*_FORCE_NAMES.split()])
_TEMPERATURES = frozenset(["temperature", "temp", "temperatur", "température", "temperatura", "touch_temperature"])
_ZEROS = {"k": 0.0, **dict.fromkeys(["°c", "℃", "degc", "deg_c", "c", "celsius"], 273.15)}  # of the scales [K]
_KNOWN = _TIMES | _FORCES | _TEMPERATURES
_CHANNEL = re.compile(
    r"(ch|channel|chan|c|kanal|ai|dev\d+/ai)[ _]*[0-9a-h]|[0-9]|volts?|voltage|ampl(itude)?|spannung|signal|"
    r"value|y_value|untitled( \d+)?|y|y_axis|sensor|reading",
    re.IGNORECASE,
)
_STAMP = re.compile(r"(?:\d{4}-\d\d-\d\d[T ])?\d\d:\d\d:\d\d[.,]\d+ -> ")  # of the Arduino's serial monitor
_CLOCK = re.compile(
    r"(?:(?P<day>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[ T,]+)?"
    r"(?:(?P<hours>\d{1,3}):(?P<minutes>\d\d):(?P<seconds>\d\d(?:[.,]\d+)?)|(?P<only>\d{1,3}):(?P<fine>\d\d[.,]\d+))"
    r"(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"
)
_DATE = re.compile(
    r"(?P<date>\d{4}-\d\d-\d\d)[T ](?P<clock>\d\d:\d\d(?::\d\d)?)(?:[.,](?P<fraction>\d{1,9}))?\s*"
    r"(?P<zone>Z|UTC|[-+]\d\d:?\d\d)?"
)
_NEEDS = "a history has columns of time and force in its header, as 'time [s],force [N]'"


@dataclass(frozen=True)
class ForceFile:
    """A history as it was read, with remarks for the user."""

    history: History
    column: str  # heading of the force
    per_metre: bool  # whether the forces are loads of a line [N m-1]
    bare: bool  # whether the force has no unit
    remarks: list[str]


@dataclass(frozen=True)
class _Columns:
    """Places, headings and units of the two columns of a history."""

    time: int
    force: int
    heading: str
    time_unit: str | None
    force_unit: str | None
    count: int = 0  # cells of the header; 0 where rows may be longer
    start: Decimal = Decimal(0)  # of the time, where rows are counted
    increment: Decimal | None = None  # of the time, where rows are counted [s]
    warm: int | None = None  # place of the temperature
    warm_unit: str | None = None


def read_history(path: Path, *, line: bool, scale: str | None = None) -> ForceFile:
    """Read a history; ``line`` is whether the contact is a line, ``scale`` the force of a volt, as ``20 N/V``."""
    try:
        file = sheet(path, _LARGEST, blanks=True)
        with file.open() as text:
            return _read(file, file.rows(text, MOST_ROWS + _MOST_TITLES, remarks=True), line, scale)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: not a table in {file.encoding}: {error}") from None


def _read(file: Sheet, rows: Iterator[tuple[int, list[str]]], line: bool, scale: str | None) -> ForceFile:
    path = file.path
    columns, rows = _header(file, rows, scaled=scale is not None)
    factor, per_metre = _force_scale(path, columns, line, scale)
    texts: list[str] = []  # of the times, empty as long as these are plain numbers
    seconds, values, warm, lines = array("d"), array("d"), array("d"), array("q")
    stray: tuple[int, str] | None = None
    last = max(columns.time, columns.force, columns.warm or 0)
    degrees: float | None = None
    for place, row in rows:
        if (
            stray is None
            and len(row) == columns.count
            and len(values) < MOST_ROWS
            and (value := quick_number(row[columns.force])) is not None
            and (columns.warm is None or (degrees := quick_number(row[columns.warm])) is not None)
            and row[0][:1] != "#"
            and "->" not in row[0]
        ):
            plain = quick_number(row[columns.time])
            if plain is not None and abs(plain) < _LATE and not texts:
                seconds.append(plain)
            else:
                texts = texts or [repr(time) for time in seconds]
                texts.append(row[columns.time].strip())
            values.append(value)
            if degrees is not None:
                warm.append(degrees)
            lines.append(place)
            continue
        if row[0].lstrip().startswith("#"):
            continue
        cells = [_STAMP.sub("", cell) for cell in row] if "->" in row[0] else row
        if not any(is_number(_pointed(cell, file)) for cell in cells) and not _is_clock(
            cells[columns.time : columns.time + 1]
        ):
            if any(cell.strip() for cell in cells):
                stray = stray or (place, " ".join(cells)[:40].strip())
            continue
        if stray:
            raise InputError(
                f"{path}: line {stray[0]}: {stray[1]!r} is no row of numbers; remove it, or begin it with #"
            )
        if len(cells) <= last:
            raise InputError(f"{path}: line {place}: {len(cells)} cells; {columns.heading} is in column {last + 1}")
        if columns.count and any(cell.strip() for cell in cells[columns.count :]):
            hint = "; a decimal comma? then separate columns by semicolons or tabs" if file.separator == "," else ""
            raise InputError(f"{path}: line {place}: {len(cells)} cells, the header has {columns.count}{hint}")
        if len(values) == MOST_ROWS:
            raise InputError(f"{path}: more than {MOST_ROWS} rows; a history has 2 to {MOST_ROWS}")
        values.append(_force(f"{path}: line {place}: {columns.heading}", cells[columns.force].strip(), file))
        if columns.warm is not None:
            warm.append(_force(f"{path}: line {place}: temperature", cells[columns.warm].strip(), file))
        texts = texts or [repr(time) for time in seconds]
        texts.append(cells[columns.time].strip())
        lines.append(place)
    if stray and len(values) < 2:
        raise InputError(f"{path}: line {stray[0]}: {stray[1]!r} is no row of numbers and times; {_NEEDS}")
    if len(values) < 2:
        raise InputError(f"{path}: {len(values)} rows; a history has 2 to {MOST_ROWS}")
    temperatures = None if columns.warm is None else _kelvin(path, columns.warm_unit, np.frombuffer(warm), lines)
    times, origin = _times(file, texts, seconds, lines, columns, temperatures)
    forces = np.frombuffer(values) * factor
    remarks = []
    if columns.time_unit is None and columns.increment is None and not origin and times[0] < _RECENT:
        remarks.append(f"time has no unit and is read in s: {times[-1] - times[0]:.4g} s from first to last row")
    if origin:
        remarks.append(f"times are counted from the first row, at {origin}")
    if (unit := (columns.force_unit or "").casefold()) in ("kg", "g", "lb", "lbs", "gram", "grams"):
        remarks.append(f"{columns.heading}: {unit} is read as the weight of this mass, by 9.80665 m/s2")
    forces = _pressing(path, columns.heading, forces, lines, remarks)
    return ForceFile(
        History(times, forces, temperatures), columns.heading, per_metre, columns.force_unit is None, remarks
    )


def _kelvin(path: Path, unit: str | None, degrees: Array, lines: "array[int]") -> Array:
    """Temperatures in kelvin; InputError for a scale that is none, and below absolute zero."""
    zero = _ZEROS.get((unit or "").strip().casefold())
    if zero is None:
        has = f"unit {unit!r}" if unit else "has no unit"
        raise InputError(f"{path}: temperature: {has}; must be 'temperature [K]' or 'temperature [degC]'")
    kelvin = degrees + zero
    if (bad := ~(kelvin > 0)).any():
        row = int(bad.argmax())
        raise InputError(f"{path}: line {lines[row]}: temperature: {kelvin[row]:g} K is not a finite number > 0 [K]")
    return np.asarray(kelvin)


def _pointed(cell: str, file: Sheet) -> str:
    """A cell with a decimal point; as it is where its comma cannot be one."""
    try:
        return with_point(cell.strip(), file.separator)
    except ValueError:
        return cell.strip()


def _is_clock(cells: list[str]) -> bool:
    return any(_CLOCK.fullmatch(cell.strip()) or _DATE.fullmatch(cell.strip()) for cell in cells)


def _force(where: str, text: str, file: Sheet) -> float:
    """A force as its column has it."""
    if not text:
        raise InputError(f"{where}: empty; must be a number")
    if missing(text):
        raise InputError(f"{where}: {text!r} stands for a missing value; remove the row")
    try:
        value = number(with_point(text, file.separator))
    except ValueError as error:
        reason = str(error) if "decimal" in str(error) or "groups" in str(error) else f"{text[:40]!r} is not a number"
        raise InputError(f"{where}: {reason}") from None
    if not np.isfinite(value):
        raise InputError(f"{where}: {value:g} is not a finite number")
    return value


def _header(
    file: Sheet, rows: Iterator[tuple[int, list[str]]], *, scaled: bool
) -> tuple[_Columns, Iterator[tuple[int, list[str]]]]:
    """The columns of a history from the rows before its numbers, and the rows of numbers."""
    titles: dict[str, list[str]] = {}
    earlier: list[list[str]] = []
    numeric = 0
    for place, row in rows:
        cells = [_STAMP.sub("", cell).strip() for cell in row]
        cells[0] = cells[0].lstrip("#").strip()
        if cells[0] == "" and len(cells) > 1 and row[0].strip() == "#":
            cells = cells[1:]  # a header behind a # that stands alone
        if file.separator == " ":
            cells = _joined(cells)
        if cells[0] == "Record Length" and len(cells) > 4:
            return _tektronix(place, row, rows)
        if columns := _matched(file, cells, channels=False) or _matched(file, cells, channels=True):
            if columns.time_unit is None and (unit := titles.get("horizontal units") or titles.get("unit:")):
                columns = _with_units(columns, [*unit, ""][1].strip("()"), None)
            if columns.force_unit is None and (unit := titles.get("y_unit_label") or titles.get("vertical units")):
                columns = _with_units(columns, columns.time_unit, (unit + [""] * 99)[min(columns.force, len(unit) - 1)])
            return _below(columns, rows)
        titles[cells[0].casefold()] = cells
        earlier.append(cells)
        if len(earlier) > _MOST_TITLES:
            break
        numeric += len([cell for cell in cells if cell]) > 1 and _all_numbers(file, cells)
        if numeric > _MOST_RESULTS:
            break
    raise InputError(f"{file.path}: {_reason(file, earlier)}")


def _joined(cells: list[str]) -> list[str]:
    """Headings between blanks, each with the unit that stands in brackets behind it."""
    joined: list[str] = []
    for cell in filter(None, cells):
        if joined and cell[0] in "[(":
            joined[-1] += f" {cell}"
        else:
            joined.append(cell)
    return joined or [""]


def _all_numbers(file: Sheet, cells: list[str]) -> bool:
    return all(is_number(_pointed(cell, file)) for cell in cells if cell)


def _reason(file: Sheet, rows: list[list[str]]) -> str:
    """Reason for which no header was read."""
    if not any(any(row) for row in rows):
        return "is empty: needs a header, as 'time [s],force [N]', and two rows or more"
    if all(_all_numbers(file, row) for row in rows):
        return f"has no header; {_NEEDS}"
    names = {heading(cell, _KNOWN)[0] for row in rows for cell in row if cell}
    if not names & _TIMES:
        return f"time: missing; {_NEEDS}"
    if not names & _FORCES:
        return f"force: missing; {_NEEDS}"
    return f"no row has the headings of both columns; {_NEEDS}"


def _matched(file: Sheet, cells: list[str], *, channels: bool) -> _Columns | None:
    """The columns of a header; None for another row. With ``channels``, a channel of an oscilloscope is the force."""
    named = [heading(cell.replace("in ", "time in ", 1) if cell.startswith("in ") else cell, _KNOWN) for cell in cells]
    times = [place for place, (name, _) in enumerate(named) if name in _TIMES]
    forces = [place for place, (name, _) in enumerate(named) if name in _FORCES]
    if not channels:
        times = (
            times
            or [place for place, (_, unit) in enumerate(named) if (unit or "").rstrip(".").casefold() in _TIME_UNITS][
                :1
            ]
        )
        forces = forces or [place for place, (_, unit) in enumerate(named) if unit and _is_force(unit)]
    if channels and not forces:
        forces = [place for place, (name, _) in enumerate(named) if _CHANNEL.fullmatch(name) and place not in times[:1]]
        if times and named[times[0]][0] in ("x", "x_axis", "t") and not forces:
            return None
    if not times or not forces or (channels and _all_numbers(file, cells)):
        return None
    if len(forces) > 1:
        in_newtons = [place for place in forces if (named[place][1] or "").endswith("N")]
        if len(in_newtons) != 1 or channels:
            said = " and ".join(repr(cells[place]) for place in forces[:3])
            raise InputError(f"{file.path}: {said} may both be the force; leave one of them")
        forces = in_newtons
    time, force = times[0], forces[0]
    name, unit = named[time]
    unit = unit or (name if name in _TIME_UNITS else "s" if name == "x_value" else None)  # LabVIEW's is in s
    warm = [place for place, (name, _) in enumerate(named) if name in _TEMPERATURES and place not in (time, force)]
    if len(warm) > 1:
        said = " and ".join(repr(cells[place]) for place in warm[:3])
        raise InputError(f"{file.path}: {said} may both be the temperature; leave one of them")
    columns = _Columns(time, force, cells[force], unit, named[force][1], len(cells))
    return replace(columns, warm=warm[0], warm_unit=named[warm[0]][1]) if warm else columns


def _with_units(columns: _Columns, time_unit: str | None, force_unit: str | None) -> _Columns:
    """The columns with the units of a row of units, where they have none."""
    return replace(
        columns,
        time_unit=columns.time_unit or time_unit or None,
        force_unit=columns.force_unit or force_unit or None,
    )


def _below(
    columns: _Columns, rows: Iterator[tuple[int, list[str]]]
) -> tuple[_Columns, Iterator[tuple[int, list[str]]]]:
    """The columns with the units of rows below the header, and the rows of numbers."""
    for place, row in rows:
        cells = [cell.strip().strip("[]()").strip() for cell in row] + [""] * (max(columns.time, columns.force) + 1)
        time, force = cells[columns.time], cells[columns.force]
        if time.casefold() == "sequence":  # Rigol: rows are counted, from a start by an increment
            start, increment = (Decimal(cell) for cell in cells[2:4])
            columns = _Columns(columns.time, columns.force, columns.heading, "s", force, 0, start, increment)
            continue
        if not row[0].lstrip().startswith("#") and (is_number(time.replace(",", ".")) or _is_clock([time])):
            return columns, chain([(place, row)], rows)
        if columns.warm is not None and columns.warm_unit is None and len(cells) > columns.warm:
            scale = cells[columns.warm]
            columns = replace(columns, warm_unit=scale if scale.casefold() in _ZEROS else None)
        if time.casefold() in _TIME_UNITS or _unit_of(force):
            columns = _with_units(
                columns, time if time.casefold() in _TIME_UNITS else None, force if _unit_of(force) else None
            )
            continue
        if not row[0].lstrip().startswith("#") and (
            ((time or force) and "->" in row[0]) or (time[:1].isdigit() and force[:1].isdigit())
        ):
            return columns, chain([(place, row)], rows)
    return columns, iter(())


def _tektronix(
    place: int, row: list[str], rows: Iterator[tuple[int, list[str]]]
) -> tuple[_Columns, Iterator[tuple[int, list[str]]]]:
    """Columns of a Tektronix file without a header: settings in the first columns, time and channel behind them."""
    first = [(place, row)]
    for entry in rows:
        first.append(entry)
        if len(first) == 20:
            break
    settings = {cells[0].strip(): cells[1].strip() for _, cells in first if len(cells) > 1}
    name = settings.get("Source", "CH1")
    columns = _Columns(3, 4, name, settings.get("Horizontal Units") or "s", settings.get("Vertical Units"))
    return columns, chain(first, rows)


def _unit_of(text: str) -> units.Unit | None:
    """The unit of a force or of a channel; None for any other text."""
    newton = units.parse("N")
    if text.casefold() in _WEIGHTS:
        unit = units.parse("V") if text.casefold().startswith("volt") else newton
        return units.Unit(_WEIGHTS[text.casefold()], unit.exponents)
    try:
        unit = units.parse(text)
    except ValueError:
        return None
    return unit if text.strip() and not is_number(text) else None


def _is_force(text: str) -> bool:
    """Return whether a text is a unit of a force, but for one of mass."""
    unit = None if text.casefold() in ("g", "kg", "p", "lb", "lbs", "gram", "grams") else _unit_of(text)
    return unit is not None and unit.fits(units.parse("N"))


def _force_scale(path: Path, columns: _Columns, line: bool, scale: str | None) -> tuple[float, bool]:
    """Factor that takes the force's column to SI units, and whether it is a load of a line."""
    name, text = columns.heading, columns.force_unit
    newton, per_metre = units.parse("N"), units.parse("N/m")
    if scale is not None:
        with located(f"--scale: {scale!r}"):
            match = re.fullmatch(r"\s*([-+.\d]*(?:[eE][-+]?\d+)?)\s*(\S.*)", scale)
            value, unit_text = match.groups() if match else (scale, "")
            product = units.parse(unit_text) * ((_unit_of(text) if text else None) or units.parse("V"))
            factor = number(value) * product.scale
        if not product.fits(newton) or not 0 < abs(factor) < np.inf:
            raise InputError(f"--scale: {scale!r} times {text or 'V'!r} is no force; must be as '20 N/V'")
        return factor, False
    if text is None:
        known, _ = heading(name, _FORCES)
        if known == "load" and line:
            return 1.0, True
        if known == "force":
            return 1.0, False
        raise InputError(f"{path}: {name}: has no unit; write it behind the name, as '{name} [N]'; {_NEEDS}")
    unit = _unit_of(text)
    if unit is None:
        raise InputError(f"{path}: column {name!r}: {text!r} is not a unit")
    if unit.fits(newton):
        return unit.scale, False
    if line and unit.fits(per_metre):
        return unit.scale, True
    if unit.fits(units.parse("V")):
        raise InputError(f"{path}: {name}: is in {text}; --scale 'NUMBER N/V' says the force of a volt")
    raise InputError(f"{path}: {name}: unit mismatch: {text!r} does not measure a force in N")


def _times(
    file: Sheet,
    texts: list[str],
    plain: "array[float]",
    lines: "array[int]",
    columns: _Columns,
    temperatures: Array | None = None,
) -> tuple[Array, str]:
    """Ascending times [s] of texts, or else of plain numbers; the first text where times are counted from it."""
    path = file.path
    unit = (columns.time_unit or "s").strip().rstrip(".").casefold()
    clock = _is_clock(texts[:1])
    if unit not in _TIME_UNITS and not clock and columns.increment is None:
        raise InputError(f"{path}: time: unit mismatch: {columns.time_unit!r} does not measure a time in s")
    scale = 1.0 if clock else _TIME_UNITS.get(unit, 1.0)
    times, late = _read_times(file, texts, lines, clock) if texts else (np.frombuffer(plain), False)
    if not np.isfinite(times).all():
        raise InputError(f"{path}: line {lines[int((~np.isfinite(times)).argmax())]}: time: is not a finite number")
    if columns.time_unit is None and not clock and columns.increment is None:
        latest = abs(float(times[-1]) + (float(with_point(texts[0], file.separator)) if late else 0.0))
        if latest > _UNIX:
            raise InputError(
                f"{path}: time: has no unit, and {latest:.4g} s are no time; write 'time [ms]' or its like"
            )
    if columns.increment is not None:
        times = float(columns.start) + times * float(columns.increment)
    times = times * scale
    back = np.diff(times) <= 0
    if back.any():
        row = int(back.argmax()) + 1
        before, behind = texts[row - 1 : row + 1] or [f"{time:g}" for time in plain[row - 1 : row + 1]]
        again = "is there twice" if times[row] == times[row - 1] else f"is not after {before}"
        if temperatures is not None and times[row] == times[row - 1] and temperatures[row] != temperatures[row - 1]:
            again += (
                f", at {temperatures[row - 1]:.6g} and {temperatures[row]:.6g} K: no temperature jumps without time"
            )
        raise InputError(f"{path}: line {lines[row]}: time: {behind} {again}; time runs forwards")
    if late:
        offset = float(Decimal(with_point(texts[0], file.separator))) * scale
        if np.spacing(abs(offset)) > _RESOLVED * float(np.diff(times).min()):
            return times, texts[0]
        return times + offset, ""
    return times, texts[0] if clock else ""


def _read_times(file: Sheet, texts: list[str], lines: "array[int]", clock: bool) -> tuple[Array, bool]:
    """Times in the unit of their column, and whether they are late ones that are counted from the first."""
    read: Callable[[str], float] = (
        _seconds(texts[0]) if clock else lambda text: number(with_point(text, file.separator))
    )
    values = array("d")
    try:
        for text in texts:
            values.append(read(text))
        if clock or abs(values[0]) < _LATE:
            return np.frombuffer(values), False
        first = Decimal(with_point(texts[0], file.separator))  # digits that a double of a late time does not have
        return np.array([float(Decimal(with_point(text, file.separator)) - first) for text in texts]), True
    except (ValueError, ArithmeticError) as error:
        row = len(values) if len(values) < len(texts) else 0
        where = f"{file.path}: line {lines[row]}: time"
        if not texts[row] or missing(texts[row]):
            raise InputError(f"{where}: {texts[row]!r}: must be a number; remove the row") from None
        telling = any(word in str(error) for word in ("decimal", "groups", "date changes"))
        reason = str(error) if telling else f"{texts[row][:40]!r} is no time"
        raise InputError(f"{where}: {reason}; times are numbers, clock times hh:mm:ss or ISO dates") from None


def _seconds(first: str) -> Callable[[str], float]:
    """Function that takes a clock time or a date to seconds after the first one."""
    if _DATE.fullmatch(first):
        begin = _nanoseconds(first)
        return lambda text: (_nanoseconds(text) - begin) * 1e-9
    day, start = _clock_seconds(first)

    def seconds(text: str) -> float:
        now, time = _clock_seconds(text)
        if now != day:  # day and month stand in either order
            raise ValueError(f"the date changes from {day} to {now}; day and month may stand in either order")
        return float(time - start)

    return seconds


def _clock_seconds(text: str) -> tuple[str | None, Decimal]:
    """The date as it is written, and the time of that day [s]."""
    match = _CLOCK.fullmatch(text)
    if match is None:
        raise ValueError(f"{text!r} is no clock time")
    if match["only"] is not None:
        return match["day"], 60 * int(match["only"]) + Decimal(match["fine"].replace(",", "."))
    hours = int(match["hours"])
    if match["half"]:
        hours = hours % 12 + 12 * (match["half"] in "Pp")
    return match["day"], 3600 * hours + 60 * int(match["minutes"]) + Decimal(match["seconds"].replace(",", "."))


def _nanoseconds(text: str) -> int:
    """A date of ISO 8601 in nanoseconds from 1970 on."""
    match = _DATE.fullmatch(text)
    if match is None:
        raise ValueError(f"{text!r} is no date")
    whole = int(np.datetime64(f"{match['date']}T{match['clock']}", "s").astype(np.int64))
    if (zone := match["zone"]) and zone[0] in "+-":
        minutes = 60 * int(zone[1:3]) + int(zone[-2:])
        whole -= 60 * minutes * (1 if zone[0] == "+" else -1)
    return whole * 10**9 + int((match["fraction"] or "0").ljust(9, "0"))


def _pressing(path: Path, name: str, forces: Array, lines: "array[int]", remarks: list[str]) -> Array:
    """Forces that press, as positive numbers; a compression that is counted negative is turned."""
    low, high = float(forces.min()), float(forces.max())
    if not forces.any():
        raise InputError(f"{path}: {name}: is 0 all the time; nothing presses")
    if -low > high and max(high, 0.0) <= -_NOISE * low:
        remarks.append(f"{name}: counts compression negative; its sign is turned")
        forces, low, high = -forces, -high, -low
    if low < -_NOISE * high:
        row = int(forces.argmin())
        raise InputError(
            f"{path}: line {lines[row]}: {name}: {forces[row]:g} N is not a finite number >= 0; subtract the load "
            "cell's offset, or leave out what pulls"
        )
    if low < 0:
        remarks.append(f"{name}: {int((forces < 0).sum())} forces down to {low:.3g} N are taken as 0")
    return np.asarray(np.maximum(forces, 0.0))
