"""``meecontact solve`` and ``meecontact interior``: a table of cases, and its exact answer as a file."""

import argparse
import sys
from collections.abc import Callable, Mapping
from itertools import product
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import xarray as xr

from solver import Material, solve, solve_interior
from solver.body import kind_of
from solver.names import (
    ALL_QUANTITIES,
    CHOICES,
    ELECTRODE_QUANTITIES,
    FACTORS,
    OF_AN_ELECTRODE,
    POINT_SLIDING,
)
from storage.files import output
from storage.netcdf import write_whole
from workflow.cli.case_solver import as_csv, solved
from workflow.cli.casetable import Table, read_cases
from workflow.cli.words import numbers, say, written_as
from workflow.language.given import DESTROYED, lost_unit
from workflow.study.reading import InputError, read_material

_NAMED = 8  # quantities that a message names
Commands: TypeAlias = "argparse._SubParsersAction[Any]"


def add_solve(commands: Commands) -> None:
    """Add ``solve`` to the commands of the program."""
    command = commands.add_parser("solve", help="solve a table of cases exactly: quantities and surface fields")
    _add_cases(command, nc="netCDF", csv="CSV")
    command.add_argument("--positions", metavar="X1,X2,...", help="surface positions X = (x - c)/h, any but -1 and 1")
    command.add_argument(
        "--peaks", action="store_true", help="also find the largest stresses of the body (milliseconds a case)"
    )
    command.set_defaults(run=_solve)


def add_interior(commands: Commands) -> None:
    """Add ``interior`` to the commands of the program."""
    command = commands.add_parser("interior", help="solve a table of cases exactly: fields inside the body, on a grid")
    _add_cases(command, nc="netCDF")
    command.add_argument("--x", required=True, metavar="X1,X2,...", help="(x - c)/h")
    command.add_argument("--y", required=True, metavar="Y1,Y2,...", help="y/h <= 0")
    command.add_argument(
        "--fields", metavar="NAME,...", help="these fields only; strains and potentials have to be named"
    )
    command.set_defaults(run=_interior)


def _add_cases(command: argparse.ArgumentParser, **endings: str) -> None:
    command.add_argument(
        "cases", type=Path, metavar="CASES.csv", help="table of cases: one row a case, one column a factor"
    )
    command.add_argument(
        "-o",
        "--output",
        type=written_as(**endings),
        required=True,
        metavar="|".join(f"OUT.{ending}" for ending in endings),
    )
    command.add_argument(
        "--materials",
        type=Path,
        action="append",
        default=[],
        metavar="FILE.yaml",
        help="file of a material that the library lacks",
    )


def _solve(options: argparse.Namespace) -> None:
    positions = None if options.positions is None else numbers("--positions", options.positions)
    points = len(positions or [0.0])
    table, out = _solved(
        options, lambda factors, materials: solve(factors, positions, materials=materials, peaks=options.peaks), points
    )
    _check_units(table, out)
    names = [str(name) for name in out.coords]
    around = out["surroundings"].values.flat if "surroundings" in names else [CHOICES["surroundings"][0]]
    pressed = out["profile"].values.flat if "profile" in names else [CHOICES["profile"][0]]
    kinds = [kind_of(names, *pair) for pair in product(dict.fromkeys(pressed), dict.fromkeys(around))]
    quantities = list(dict.fromkeys(name for kind in kinds for name in kind.quantities))
    missing = [name for name in quantities if name not in out and name not in _unasked(table)]
    if missing:
        print(f"left out, because no case has them: {', '.join(missing)}", file=sys.stderr)
    partial = [name for name in quantities if name in out and bool(out[name].isnull().any())]
    if partial:
        others = f" and {len(partial) - _NAMED} more" if len(partial) > _NAMED else ""
        print(f"empty where a case has no such quantity: {', '.join(partial[:_NAMED])}{others}", file=sys.stderr)
    _wrote(options, out, f"{sum(name in ALL_QUANTITIES for name in out.data_vars)} quantities")


def _check_units(table: Table, out: xr.Dataset) -> None:
    """Refuse a bare force that would destroy any ceramic: it has probably lost its unit."""
    for name in sorted({"force", "load"} & table.bare):
        if "peak_pressure" not in out:
            continue
        pressures = np.broadcast_to(out["peak_pressure"].values, out.sizes["case"])
        crushed = (pressures > DESTROYED) & np.isfinite(pressures) & ~table.empty(name)
        if crushed.any():
            row = int(crushed.argmax())
            value, unit = float(table.columns[name][row]), FACTORS[name].units
            raise InputError(f"{table.at(row)}: {name}: {lost_unit(value, unit, float(pressures[row]))}")


def _unasked(table: Table) -> set[str]:
    """Quantities that nobody misses: of electrodes and of sliding points, where no case has such a factor."""
    electrodes = () if {*OF_AN_ELECTRODE} & {*table.columns} else (*ELECTRODE_QUANTITIES,)
    return {*electrodes, *(() if "friction" in table.columns else POINT_SLIDING)}


def _interior(options: argparse.Namespace) -> None:
    x, y = numbers("--x", options.x), numbers("--y", options.y)
    fields = [name.strip() for name in options.fields.split(",")] if options.fields else None
    points = len(x) * len(y)
    _, out = _solved(
        options, lambda factors, materials: solve_interior(factors, x, y, fields=fields, materials=materials), points
    )
    _wrote(options, out, f"{len(out.data_vars)} fields on {len(x)} x {len(y)} points")


def _solved(
    options: argparse.Namespace, answer: Callable[[xr.Dataset, Mapping[str, Material]], xr.Dataset], points: int
) -> tuple[Table, xr.Dataset]:
    """A table of cases, and the answer to it."""
    options.output = output(options.output, options.cases, *options.materials)
    table = read_cases(options.cases)
    materials = dict(read_material(path) for path in options.materials)
    return table, solved(table, lambda factors: answer(factors, materials), points)


def _wrote(options: argparse.Namespace, out: xr.Dataset, what: str) -> None:
    (as_csv if options.output.suffix == ".csv" else write_whole)(out, options.output)
    say(f"wrote {options.output}: {out.sizes['case']} case{'s' if out.sizes['case'] != 1 else ''}, {what}")
