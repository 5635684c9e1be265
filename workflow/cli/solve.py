"""``meecontact solve`` and ``meecontact interior``: tables of cases to exact answers."""

import argparse
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import chain, product
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from tqdm import tqdm

import solver
from approximation.arrays import Indices
from solver import FactorError, Material, MaterialError, SmallStrainWarning, solve, solve_interior
from solver.body import around, kind_of, solids
from solver.face.factorvalues import settled
from solver.face.rows import joined
from solver.face.strain import Excess, sentence
from solver.material.punches import RIGID_PUNCH
from solver.names import (
    ALL_QUANTITIES,
    CHOICES,
    ELECTRODE_QUANTITIES,
    FACTORS,
    HEAT_QUANTITIES,
    OF_A_FILM,
    OF_A_PUNCH,
    OF_AN_ELECTRODE,
    OF_HEAT,
    POINT_SLIDING,
)
from solver.units import written
from storage.files import output, writing
from storage.netcdf import write_whole
from workflow.cli.casetable import Table, one_case, read_blocks, read_cases
from workflow.cli.textfile import write_columns
from workflow.cli.words import numbers, say
from workflow.language.given import DESTRUCTIVE_PRESSURE, lost_unit
from workflow.study.reading import InputError, one_line, read_material

_NAMED = 8  # quantities that a message names
_PHASES = ("BaTiO3", "CoFe2O4")  # the solver's phases of a composite
_PRINTED = 6  # digits of a printed value
_DEFAULTS: dict[str, float | str | None] = {name: factor.default for name, factor in FACTORS.items()}
_DEFAULTS |= {name: choices[0] for name, choices in CHOICES.items() if name not in ("composite", "corner")}
# a case without these is on a half-plane, under a rigid punch
_DEFAULTS |= {name: np.nan if name in FACTORS else "" for name in (*OF_A_FILM, *OF_A_PUNCH)}
# choices that decide which outputs a case has
_OUTPUT_CHOICES = ("profile", "corner", "electric", "magnetic", "surroundings", "electrode")
_CASES = 512  # solved at a time at most: searched contacts (tilted flats) take 100 kB of temporaries each
_CLOSED_FORM_CASES = 2**14  # the same in closed form
_VALUES = 2**17  # of a field at a time: some hundred temporaries of 8 bytes each inside the body
_BLOCK = 2**16  # cases of a written table at a time: some 200 MB with answers and texts
_MOST_BYTES = 2**32  # of an answer, which stays in memory until it is written
_OF_OPTIONS = ("positions", "x", "y", "fields")  # first words of messages that are about no row
_REFUSALS = (FactorError, MaterialError, np.linalg.LinAlgError)


def solve_table(options: argparse.Namespace) -> None:
    """Solve a table and write its answer, as the options say; a table of answers is written block by block."""
    _check_files(options)
    if options.output is not None and options.output.suffix == ".csv":
        columns: dict[str, str] = {}
        while (count := _write_blocks(options, columns)) is None:
            pass  # a block has further columns: all rows again, with those of all blocks so far
        _tell_written(options, count, f"{sum(name in ALL_QUANTITIES for name in columns)} quantities")
        return
    positions = None if options.positions is None else numbers("--positions", options.positions)
    points = len(positions or [0.0])
    answer = partial(solve, positions=positions, materials=options.known, peaks=options.peaks)
    table, out = _solved(options, answer, points)
    _check_units(table, out)
    _tell_missing(*_lacking(table, out), out.attrs.get("heat", ""))
    if options.output is None:
        case = out.isel(case=0)
        print("\n".join([*_lines(case, si=options.si), "", *_notes(table, case, options.known)]))
    else:
        write_whole(out, options.output)
        _tell_written(options, table.count, f"{sum(name in ALL_QUANTITIES for name in out.data_vars)} quantities")


def _check_files(options: argparse.Namespace) -> None:
    """Refuse other than one source of cases, fields in a table, and a path that cannot be written; read materials."""
    if (options.cases is None) == (options.at is None):
        raise InputError(f"{options.command}: give either a table CASES.csv or --at NAME=VALUE,...")
    if options.output is not None:
        options.output = output(options.output, *filter(None, [options.cases]), *options.materials)
        if options.output.suffix == ".csv" and options.positions is not None:
            raise InputError(f"{options.output}: fields over position go to netCDF; name a file that ends in .nc")
    options.known = dict(read_material(path) for path in options.materials)


def _write_blocks(options: argparse.Namespace, columns: dict[str, str]) -> int | None:
    """Write answers block by block, and return their number; None where a block adds further columns."""
    count, strains = 0, list[Excess]()
    missing: dict[str, None] | None = None
    incomplete: dict[str, None] = {}
    heat = ""
    with suppress(_FurtherColumnsError), writing(options.output) as file:
        for table in read_blocks(options.cases, _BLOCK) if options.cases else [one_case("--at", options.at)]:
            out = solved(table, partial(solve, materials=options.known, peaks=options.peaks), strains=strains)
            _check_units(table, out)
            units = _units(out)
            if columns and units.keys() - columns.keys():
                columns |= units
                raise _FurtherColumnsError
            if not count:
                columns |= units
            write_columns(file, _columns(out, columns), headed=not count)
            lacking, partly = _lacking(table, out)
            heat = heat or out.attrs.get("heat", "")
            incomplete |= dict.fromkeys([*partly, *(name for name in columns if name not in out)])
            missing = dict.fromkeys(name for name in lacking if missing is None or name in missing)
            count += table.count
        if strains:
            say(f"meecontact: warning: {sentence(strains, count)}")
        _tell_missing(list(missing or ()), [name for name in incomplete if name in ALL_QUANTITIES], heat)
        return count
    return None


class _FurtherColumnsError(Exception):
    """A block of a long table has columns that earlier blocks lack."""


def _lacking(table: Table, out: xr.Dataset) -> tuple[list[str], list[str]]:
    """Return the quantities that no case has, and those that some case lacks."""
    names = [str(name) for name in out.coords]
    profiles, surroundings = (
        dict.fromkeys(out[name].values.flat) if name in names else [CHOICES[name][0]]
        for name in ("profile", "surroundings")
    )
    known = {str(value) for name in ("material", "base") if name in names for value in out[name].values.flat}
    kinds = [kind_of(names, *pair, known) for pair in product(profiles, surroundings)]
    quantities = list(dict.fromkeys(name for kind in kinds for name in kind.quantities))
    optional = _optional_quantities(table)
    missing = [name for name in quantities if name not in out and name not in optional]
    return missing, [name for name in quantities if name in out and bool(out[name].isnull().any())]


def _tell_missing(missing: Sequence[str], incomplete: Sequence[str], heat: str) -> None:
    """Print which quantities no case has, why there is no heat, and which quantities some cases lack."""
    if missing:
        say(f"left out, because no case has them: {', '.join(missing)}")
    if heat:
        say(f"heat: {heat}")
    if incomplete:
        others = f" and {len(incomplete) - _NAMED} more" if len(incomplete) > _NAMED else ""
        say(f"empty where a case has no such quantity: {', '.join(incomplete[:_NAMED])}{others}")


def _lines(case: xr.Dataset, *, si: bool) -> Iterator[str]:
    """Yield a line for each quantity of a case: name, value, unit."""
    for name, (value, unit) in solver.table(case).iterrows():
        plain = float(case[name].values.item()), written(ALL_QUANTITIES[str(name)].units)
        value, unit = plain if si else (value, unit)
        yield one_line(f"{name:34s} {value + 0.0:.{_PRINTED}g} {unit}".rstrip())  # no -0


def _notes(table: Table, out: xr.Dataset, known: Mapping[str, Material]) -> Iterator[str]:
    """Yield lines with the defaults of the one case of a table, and with the effects that the model leaves out."""
    # a table needs neither studies nor designs
    from workflow.design.verdict import leftout
    from workflow.study.allowable import allowable

    case = {name: cells.tolist()[0] for name, cells in table.columns.items()}
    profile = str(case.get("profile") or CHOICES["profile"][0])
    surroundings = str(case.get("surroundings") or around(case))
    kind = kind_of([*case], profile, surroundings, solids(case))
    coupled = {"electric": "voltage", "magnetic": "magnetic_potential"}
    charged = [name for name, potential in coupled.items() if potential in solver.table(out).index]
    fields = [name for name in coupled if name in charged or name in case]
    taken: dict[str, object] = {"composite": CHOICES["composite"][0]} if "volume_fraction" in case else {}
    taken |= {"profile": profile} | ({} if case.keys() & {*OF_A_PUNCH} else {"punch": RIGID_PUNCH}) | {"friction": 0}
    taken |= {name: CHOICES[name][0] for name in fields}
    taken |= {f"interface_{name}": CHOICES[f"interface_{name}"][0] for name in fields if kind.layered}
    taken |= {name: 0 for name, field in zip(kind.loads.charges, coupled, strict=True) if field in charged}
    taken |= {"surroundings": surroundings} if kind.layered else {}
    taken |= {"datum": "1 m"} if kind.contact == "line" else {}
    yield "defaults: " + ", ".join(f"{name} {value}" for name, value in taken.items() if name not in case)
    solve_case = partial(solve, materials=known)
    limit = partial(allowable, factors=case, materials=known, phases=_PHASES)
    solved_case = leftout.SolvedCase(kind, case, solve_case, limit, {}, materials=known)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SmallStrainWarning)  # which the case itself has shown
        yield from [one_line(f"left out: {effect.left_out_words}") for effect in leftout.budget(solved_case)]


def _check_units(table: Table, out: xr.Dataset) -> None:
    """Refuse a bare force that would destroy any ceramic: it has probably lost its unit."""
    for name in sorted({"force", "load"} & table.bare):
        if "peak_pressure" not in out:
            continue
        pressures = np.broadcast_to(out["peak_pressure"].values, out.sizes["case"])
        excessive = (pressures > DESTRUCTIVE_PRESSURE) & np.isfinite(pressures) & ~table.empty(name)
        if excessive.any():
            row = int(excessive.argmax())
            value, unit = float(table.columns[name][row]), FACTORS[name].units
            raise InputError(f"{table.at(row)}: {name}: {lost_unit(value, unit, float(pressures[row]))}")


def _optional_quantities(table: Table) -> set[str]:
    """Return the quantities of electrodes, heat and sliding points, where no case has factors of these."""
    electrodes = () if {*OF_AN_ELECTRODE} & {*table.columns} else (*ELECTRODE_QUANTITIES,)
    heat = () if {*OF_HEAT} & {*table.columns} else (*HEAT_QUANTITIES,)
    return {*electrodes, *heat, *(() if "friction" in table.columns else POINT_SLIDING)}


def solve_inside(options: argparse.Namespace) -> None:
    """Solve a table on a grid inside the body and write its answer, as the options say."""
    _check_files(options)
    x, y = numbers("--x", options.x), numbers("--y", options.y)
    fields = [name.strip() for name in options.fields.split(",")] if options.fields else None
    answer = partial(solve_interior, x=x, y=y, fields=fields, materials=options.known)
    table, out = _solved(options, answer, len(x) * len(y), checked=True)
    write_whole(out, options.output)
    _tell_written(options, table.count, f"{len(out.data_vars)} fields on {len(x)} x {len(y)} points")


def _solved(
    options: argparse.Namespace, answer: Callable[[xr.Dataset], xr.Dataset], points: int, *, checked: bool = False
) -> tuple[Table, xr.Dataset]:
    """Return a table of cases and its answer; checked: whether bare forces are judged by their pressures before."""
    table = one_case("--at", options.at) if options.cases is None else read_cases(options.cases)
    if options.output is None and (table.count > 1 or options.positions is not None):
        what = "fields" if options.positions is not None else f"{table.count} cases"
        raise InputError(f"solve: {what} need -o OUT.nc or OUT.csv; one case is printed")
    if checked and {"force", "load"} & table.bare:
        _check_units(table, solved(table, partial(solve, materials=options.known)))
    return table, solved(table, answer, points)


def _tell_written(options: argparse.Namespace, count: int, what: str) -> None:
    say(f"wrote {options.output}: {count} case{'s' if count != 1 else ''}, {what}")


def solved(
    table: Table, solve: Callable[[xr.Dataset], xr.Dataset], points: int = 1, strains: list[Excess] | None = None
) -> xr.Dataset:
    """Solve a table with progress on a terminal; contacts beyond small strain join `strains`, or cause a warning.

    Returns outputs over dimension ``case`` in the order of the rows.
    """
    table = _surrounded(table)
    # the solver itself divides cylinders on half-planes
    most = _CASES if {"profile", "thickness", "surroundings"} & table.columns.keys() else _CLOSED_FORM_CASES
    excesses, parts, rows_of_parts, size = list[Excess](), list[xr.Dataset](), list[Indices](), 0.0
    with tqdm(total=table.count, unit=" cases", delay=2, disable=None, leave=False) as bar:
        for names, rows in _blocks(table, min(most, max(1, _VALUES // points))):
            try:
                with warnings.catch_warnings(record=True) as caught:
                    warnings.simplefilter("always", SmallStrainWarning)
                    part = solve(_factors(table, names, rows))
            except _REFUSALS as error:
                raise _explained(table, names, rows, solve, error) from None
            for warning in caught:
                if isinstance(warning.message, SmallStrainWarning):
                    excesses += warning.message.excesses
                else:
                    say(f"meecontact: warning: {warning.message}")
            size += part.nbytes
            if size > _MOST_BYTES:
                raise InputError(f"{table.source}: {table.count} cases give more than {_MOST_BYTES} bytes; split it")
            parts.append(part)
            rows_of_parts.append(rows)
            bar.update(len(rows))
    if strains is not None:
        strains += excesses
    elif excesses:
        say(f"meecontact: warning: {sentence(excesses, table.count)}")
    return joined(rows_of_parts, parts)


def _surrounded(table: Table) -> Table:
    """Return the table with the surroundings of every contact where any is a film: they decide the outputs."""
    around = settled({name: xr.DataArray(cells, dims="case") for name, cells in table.columns.items()})
    if "surroundings" not in around:
        return table
    column = np.broadcast_to(around["surroundings"].values.astype(object), table.count)
    return replace(table, columns=table.columns | {"surroundings": column})


def _blocks(table: Table, most: int) -> Iterator[tuple[list[str], Indices]]:
    """Yield rows that are solved together, and the factors that they have."""
    columns: list[NDArray[Any]] = [~table.empty(name) | (_DEFAULTS.get(name) is not None) for name in table.columns]
    choices: list[NDArray[Any]] = [_numbered(table, name) for name in _OUTPUT_CHOICES if name in table.columns]
    choices += [table.empty(name) for name in OF_A_FILM[:1] if name in table.columns]
    patterns, first, pattern = np.unique(np.stack(columns + choices, 1), axis=0, return_index=True, return_inverse=True)
    for k in np.argsort(first):
        rows = np.flatnonzero(pattern.ravel() == k)
        count = -(-len(rows) // most)
        names = [name for name, has in zip(table.columns, patterns[k], strict=False) if has]
        # rows from all over the table: the solver iterates until the last case of a block has converged, and with hard
        # cases in every block all cases take as many steps as in one block
        for begin in range(count):
            yield names, rows[begin::count]


def _numbered(table: Table, name: str) -> Indices:
    """Return the number of the factor's choice in every row; an empty cell has the default."""
    cells = table.columns[name].copy()
    cells[table.empty(name)] = _DEFAULTS.get(name) or ""
    return np.unique(cells.astype(str), return_inverse=True)[1].ravel()


def _factors(table: Table, names: list[str], rows: Indices) -> xr.Dataset:
    """Return the cells of some rows, with defaults where they are empty."""
    columns = {}
    for name in names:
        cells = table.columns[name][rows]
        cells[table.empty(name)[rows]] = _DEFAULTS.get(name)
        columns[name] = ("case", cells.astype(float if name in FACTORS else str))
    return xr.Dataset(columns)


def _explained(
    table: Table, names: list[str], rows: Indices, solve: Callable[[xr.Dataset], xr.Dataset], error: Exception
) -> InputError:
    """Return the error of the first row that cannot be solved, with its line, found by halving."""
    if str(error).partition(":")[0] in _OF_OPTIONS:
        return InputError(f"{table.source}: {error}")

    from workflow.dataset.factorial import refused_region  # which a table that is solved does without

    cases = {str(name): cells for name, cells in _factors(table, names, rows).data_vars.items()}
    region, error = refused_region(lambda part: solve(xr.Dataset(part)), cases, error, _REFUSALS)
    # without a region only several rows together fail
    where = table.source if region is None else table.at(int(rows[region["case"].start]))
    if isinstance(error, np.linalg.LinAlgError):
        return InputError(f"{where}: constants beyond what double precision can solve ({error})")
    return InputError(f"{where}: {error}")


def _units(answer: xr.Dataset) -> dict[str, str]:
    """Return the units of an answer's columns by name."""
    columns = {str(name): column for name, column in chain(answer.coords.items(), answer.data_vars.items())}
    return {
        name: column.attrs.get("units", "1") if column.dtype.kind == "f" else "1" for name, column in columns.items()
    }


def _columns(answer: xr.Dataset, units: Mapping[str, str]) -> dict[str, NDArray[Any]]:
    """Return an answer's columns by their headings; empty cells where it lacks them."""
    return {
        name if unit == "1" else f"{name} [{unit}]": np.broadcast_to(
            answer[name].values if name in answer.variables else "", answer.sizes["case"]
        )
        for name, unit in units.items()
    }
