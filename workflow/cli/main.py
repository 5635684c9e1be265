"""The command ``meecontact``: solve cases, query a surrogate, check a material, begin, check and run a study."""

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from itertools import product
from pathlib import Path
from typing import Any, NoReturn, TextIO

import numpy as np
import xarray as xr

from solver import FactorError, Material, MaterialError, PrecisionWarning, solve, solve_interior
from solver.body import kind_of
from solver.names import ALL_QUANTITIES, CHOICES, ELECTRODE_QUANTITIES, STRIP_QUANTITIES
from storage.files import output, write_text
from storage.netcdf import write_whole
from surrogate import FormatError, OutOfBoxError
from workflow.cli import calculating, learn, materials, sensing, serving, studies
from workflow.cli.casetable import read_cases
from workflow.cli.launch import launch
from workflow.cli.progress import busy
from workflow.cli.query import query
from workflow.cli.solving import as_csv, solved
from workflow.cli.words import cores, numbers, say, surrogate_file, written_as
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, one_line, read_material

_NAMED = 8  # quantities that a message names
_OF_ELECTRODES = (*ELECTRODE_QUANTITIES, *STRIP_QUANTITIES)  # told of only where one is read


class _Parser(argparse.ArgumentParser):
    """Complains in one line, and says what a command may have been meant to be."""

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            raise argparse.ArgumentError(action, f"{value!r} is none; {nearest(str(value), list(action.choices))}")

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {one_line(message)}\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments
        Words after the program's name; by default the process's own.

    Returns
    -------
    int
        0; 2 on bad input, with one line on standard error and nothing written.
    """
    options = _parser().parse_args(arguments)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", PrecisionWarning)
            warnings.showwarning = _warned
            return int(options.run(options) or 0)
    except (InputError, FactorError, MaterialError, OutOfBoxError, FormatError) as error:
        print(f"meecontact: {one_line(str(error))}", file=sys.stderr)
        return 2
    except np.linalg.LinAlgError as error:
        print(f"meecontact: constants beyond what double precision can solve ({error})", file=sys.stderr)
        return 2
    except BrokenPipeError:  # who reads has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nor is there anything left to flush
        return 0
    except OSError as error:
        reason = f"{error.filename}: {error.strerror}" if error.filename else str(error)
        print(f"meecontact: {one_line(reason)}", file=sys.stderr)
        return 2


def _warned(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """What is doubtful in an answer (:class:`solver.PrecisionWarning`), in one line."""
    say(f"meecontact: warning: {message}")


def _parser() -> _Parser:
    parser = _Parser(prog="meecontact", description=__doc__)
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('meecontact')}")
    parser.set_defaults(run=lambda options: parser.print_help())
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")

    command = commands.add_parser("solve", help="exact quantities (and surface fields) of a table of cases")
    _add_cases(command)
    command.add_argument("--positions", metavar="X1,X2,...", help="surface positions X = (x - c)/h, any but -1 and 1")
    command.add_argument(
        "--peaks", action="store_true", help="also the largest stresses of the body (milliseconds each)"
    )
    command.set_defaults(run=_solve)

    command = commands.add_parser("interior", help="exact fields inside the body of a table of cases, on a grid")
    _add_cases(command)
    command.add_argument("--x", required=True, metavar="X1,X2,...", help="(x - c)/h")
    command.add_argument("--y", required=True, metavar="Y1,Y2,...", help="y/h <= 0")
    command.add_argument("--fields", metavar="NAME,...", help="these fields only; strains and potentials by name too")
    command.set_defaults(run=_interior)

    command = commands.add_parser(
        "query",
        help="values and intervals from a trained surrogate",
        description="Values and the intervals that hold the exact ones in a stated share of cases, 95 % unless "
        "--level says another. Columns written: the inputs, then NAME, NAME_std, NAME_lower and NAME_upper of every "
        "output. NAME +- NAME_std holds 68 %; intervals are no fixed multiple of it: errors are not Gaussian.",
    )
    command.add_argument("surrogate", type=surrogate_file, metavar="surrogate.nc", help="or results/STUDY")
    command.add_argument(
        "table", type=Path, nargs="?", metavar="AT.csv", help="one row a point, columns are the inputs"
    )
    command.add_argument("--at", metavar="NAME=VALUE,...", help="one point, printed")
    command.add_argument("-o", "--output", type=written_as(csv="CSV"), metavar="OUT.csv")
    command.add_argument(
        "--level", type=float, metavar="SHARE", help="of cases that intervals hold; default: the study's"
    )
    _add_si(command)
    command.add_argument("--extrapolate", action="store_true", help="answer outside the trained box too, flagged")
    command.add_argument(
        "--exact", metavar="STUDY", help="also the exact answers, by the formula: the study that it came from"
    )
    command.set_defaults(run=query)

    calculating.add(commands)
    serving.add(commands)
    sensing.add(commands)

    command = commands.add_parser(
        "material", help="check a material, print roots and compliance; or list what is built in"
    )
    command.add_argument(
        "material",
        nargs="?",
        metavar="FILE.yaml",
        help="a material's file, or the name of a built-in one; none: a list",
    )
    command.set_defaults(run=_material)

    command = commands.add_parser("design", help="answer a design question from a trained surrogate, in seconds")
    command.add_argument("results", type=Path, metavar="results/STUDY")
    command.add_argument("--maximise", action="append", metavar="EXPRESSION", help="twice: a Pareto front")
    command.add_argument("--minimise", action="append", metavar="EXPRESSION")
    command.add_argument("--over", action="append", required=True, metavar="NAME[=LOW:HIGH | =A|B|C],...")
    command.add_argument("--at", action="append", metavar="NAME=VALUE,...", help="what is not named takes its default")
    command.add_argument("--worst-case", action="append", metavar="NAME=LOW:HIGH,...")
    command.add_argument("--uncertain", action="append", metavar="NAME=normal(MEAN,STD),...")
    command.add_argument("--tolerance", action="append", metavar="NAME=5%|10um,...", help="how far off as built")
    command.add_argument("--robust", nargs=1, metavar="'mean - 2 std'", help="default: 'worst case'")
    command.add_argument("--limit", action="append", metavar="'trailing_tension <= 50 MPa'")
    _add_si(command)
    command.add_argument("--json", action="store_true", help="print JSON instead of a table")
    command.add_argument(
        "-o", "--output", type=written_as(csv="CSV", json="JSON"), metavar="OUT.csv|.json", help="write it instead"
    )
    command.set_defaults(run=_design)

    command = commands.add_parser("invert", help="from measured quantities back to factors, with intervals")
    command.add_argument("results", type=Path, metavar="results/STUDY")
    command.add_argument(
        "--measured", action="append", required=True, metavar="NAME=VALUE+-STD,...", help="as -519+-5, -0.52kV+-1%%"
    )
    command.add_argument("--infer", action="append", required=True, metavar="NAME,...", help="one to three factors")
    command.add_argument("--at", action="append", metavar="NAME=VALUE,...", help="all the others")
    _add_si(command)
    command.set_defaults(run=_invert)

    learn.add(commands)

    command = commands.add_parser("init", help="write a commented study of one's own, which runs as it is")
    command.add_argument("name", metavar="NAME", help="of the study: config/NAME.yaml")
    command.set_defaults(run=_init)

    command = commands.add_parser("list", help="what studies may name: studies, factors, quantities, materials")
    command.add_argument("kind", nargs="?", metavar="KIND", help="one of these; default: all of them")
    command.set_defaults(run=_list)

    command = commands.add_parser("run", help="check a study and run it to its report with Snakemake")
    command.add_argument("study", help="name of a study in config/, or path of a study's file (.yaml)")
    command.add_argument("--cores", default="all", type=cores, metavar="N", help="cores to use at most; default: all")
    command.add_argument(
        "--profile", default="default", metavar="NAME", help="slurm, or a folder of your own profiles/"
    )
    command.add_argument("-n", "--dry-run", action="store_true", help="only say what would be done")
    command.set_defaults(run=_run)
    return parser


def _add_si(command: argparse.ArgumentParser) -> None:
    command.add_argument("--si", action="store_true", help="print in units of the SI without prefixes")


def _add_cases(command: argparse.ArgumentParser) -> None:
    command.add_argument("cases", type=Path, metavar="CASES.csv", help="one row a case, columns are factors")
    command.add_argument(
        "-o", "--output", type=written_as(nc="netCDF", csv="CSV"), required=True, metavar="OUT.nc|.csv"
    )
    command.add_argument(
        "--materials", type=Path, action="append", default=[], metavar="FILE.yaml", help="own material"
    )


def _solve(options: argparse.Namespace) -> None:
    positions = None if options.positions is None else numbers("--positions", options.positions)
    points = len(positions or [0.0])
    out = _solved(options, lambda factors, own: solve(factors, positions, materials=own, peaks=options.peaks), points)
    names = [str(name) for name in out.coords]
    around = out["surroundings"].values.flat if "surroundings" in names else [CHOICES["surroundings"][0]]
    pressed = out["profile"].values.flat if "profile" in names else [CHOICES["profile"][0]]
    kinds = [kind_of(names, *pair) for pair in product(dict.fromkeys(pressed), dict.fromkeys(around))]
    asked = list(dict.fromkeys(name for kind in kinds for name in kind.quantities))
    missing = [name for name in asked if name not in out and (name not in _OF_ELECTRODES or "collector" in names)]
    if missing:
        print(f"left out, as no case has such a quantity: {', '.join(missing)}", file=sys.stderr)
    partial = [name for name in asked if name in out and bool(out[name].isnull().any())]
    if partial:
        more = f" and {len(partial) - _NAMED} more" if len(partial) > _NAMED else ""
        print(f"empty where a case has no such quantity: {', '.join(partial[:_NAMED])}{more}", file=sys.stderr)
    _wrote(options, out, f"{sum(name in ALL_QUANTITIES for name in out.data_vars)} quantities")


def _interior(options: argparse.Namespace) -> None:
    x, y = numbers("--x", options.x), numbers("--y", options.y)
    fields = [name.strip() for name in options.fields.split(",")] if options.fields else None
    points = len(x) * len(y)
    out = _solved(options, lambda factors, own: solve_interior(factors, x, y, fields=fields, materials=own), points)
    _wrote(options, out, f"{len(out.data_vars)} fields on {len(x)} x {len(y)} points")


def _solved(
    options: argparse.Namespace, answer: Callable[[xr.Dataset, Mapping[str, Material]], xr.Dataset], points: int
) -> xr.Dataset:
    """The answer to a table of cases."""
    options.output = output(options.output, options.cases, *options.materials)
    table = read_cases(options.cases)
    own = dict(read_material(path) for path in options.materials)
    return solved(table, lambda factors: answer(factors, own), points)


def _wrote(options: argparse.Namespace, out: xr.Dataset, what: str) -> None:
    (as_csv if options.output.suffix == ".csv" else write_whole)(out, options.output)
    say(f"wrote {options.output}: {out.sizes['case']} cases, {what}")


def _material(options: argparse.Namespace) -> None:
    print(materials.listed() if options.material is None else _shown(materials.described(options.material)))


def _design(options: argparse.Namespace) -> None:
    from workflow.cli import questions  # scikit-learn and the searches: not for every command
    from workflow.design.told import table
    from workflow.design.told.words import verdict

    path = None if options.output is None else output(options.output)
    with busy("searching") as tell:
        answer = questions.ask(options.results, vars(options), tell)
    if path is not None:
        write_text(path, f"{table.as_json(answer)}\n" if path.suffix == ".json" else table.as_csv([answer]))
        say(f"wrote {options.output}: {verdict(answer)}")
    else:
        print(table.as_json(answer) if options.json else _shown(table.as_text(answer, si=options.si)))


def _invert(options: argparse.Namespace) -> None:
    from workflow.cli import questions

    with busy("inferring"):
        answer = questions.invert(options.results, vars(options), si=options.si)
    print(_shown(answer))


def _shown(text: str) -> str:
    """Lines whose names, which may come from a file, cannot command the terminal."""
    return "\n".join(one_line(line) for line in text.split("\n"))


def _init(options: argparse.Namespace) -> None:
    say(f"wrote {studies.begin(options.name)}: meecontact run {options.name}")


def _list(options: argparse.Namespace) -> None:
    print(_shown(studies.listed(options.kind)))


def _run(options: argparse.Namespace) -> int:
    return launch(options.study, options.cores, options.profile, dry=options.dry_run)
