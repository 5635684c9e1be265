"""The command ``meecontact``: solve cases, query a surrogate, check a material, check and run a study."""

import argparse
import csv
import io
import os
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn, TextIO

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import surrogate
from solver import FactorError, Material, MaterialError, PrecisionWarning, find, limiting_speed, solve, solve_interior
from solver.halfplane.surface import HalfPlane
from solver.material.constants import UNITS
from solver.names import EVERY_QUANTITY, QUANTITIES
from storage.files import output, regular, writing
from storage.netcdf import write_whole
from surrogate import FormatError, OutOfBoxError
from workflow.cli import materials, predictions
from workflow.cli.casetable import Table, read_cases
from workflow.cli.launch import launch
from workflow.cli.pointtable import predicted
from workflow.cli.solving import solved
from workflow.dataset import factorial
from workflow.study import location
from workflow.study import model as studies
from workflow.study.reading import InputError, number, one_line, read_material

_ROWS = 4096  # of an answer that are written at a time


class _Parser(argparse.ArgumentParser):
    """Complains in one line."""

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
    _say(f"meecontact: warning: {message}")


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
        help="values and 95 %% intervals from a trained surrogate",
        description="Values and the intervals that hold the exact ones in 95 %% of cases. Columns written: the inputs, "
        "then NAME, NAME_std, NAME_lower and NAME_upper of every output. NAME_std is half the interval's width over "
        "1.96; errors are not Gaussian, and NAME +- NAME_std holds few of them.",
    )
    command.add_argument("surrogate", type=Path, metavar="surrogate.nc")
    command.add_argument(
        "table", type=Path, nargs="?", metavar="AT.csv", help="one row a point, columns are the inputs"
    )
    command.add_argument("--at", metavar="NAME=VALUE,...", help="one point, printed")
    command.add_argument("-o", "--output", type=Path, metavar="OUT.csv")
    command.add_argument("--extrapolate", action="store_true", help="answer outside the trained box too, flagged")
    command.add_argument(
        "--exact", metavar="STUDY", help="also the exact answers, by the formula: the study that it came from"
    )
    command.set_defaults(run=_query)

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
    command.add_argument("--robust", nargs=1, metavar="'mean - 2 std'", help="default: 'worst case'")
    command.add_argument("--limit", action="append", metavar="'trailing_tension <= 50 MPa'")
    command.add_argument("--json", action="store_true", help="print JSON instead of a table")
    command.set_defaults(run=_design)

    command = commands.add_parser("invert", help="from measured quantities back to factors, with intervals")
    command.add_argument("results", type=Path, metavar="results/STUDY")
    command.add_argument("--measured", action="append", required=True, metavar="NAME=VALUE+-STD,...", help="SI units")
    command.add_argument("--infer", action="append", required=True, metavar="NAME,...", help="one to three factors")
    command.add_argument("--at", action="append", metavar="NAME=VALUE,...", help="all the others")
    command.set_defaults(run=_invert)

    command = commands.add_parser("run", help="check a study and run it to its report with Snakemake")
    command.add_argument("study", help="name of a study in config/, or path of a study's file (.yaml)")
    command.add_argument("--cores", default="all", help="cores of this machine to use at most")
    command.add_argument(
        "--profile", default="default", metavar="NAME", help="slurm, or a folder of your own profiles/"
    )
    command.add_argument("-n", "--dry-run", action="store_true", help="only say what would be done")
    command.set_defaults(run=_run)
    return parser


def _add_cases(command: argparse.ArgumentParser) -> None:
    command.add_argument("cases", type=Path, metavar="CASES.csv", help="one row a case, columns are factors")
    command.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.nc")
    command.add_argument(
        "--materials", type=Path, action="append", default=[], metavar="FILE.yaml", help="own material"
    )


def _solve(options: argparse.Namespace) -> None:
    positions = None if options.positions is None else _numbers("--positions", options.positions)
    points = len(positions or [0.0])
    out = _solved(options, lambda factors, own: solve(factors, positions, materials=own, peaks=options.peaks), points)
    missing = [name for name in QUANTITIES if name not in out]
    if missing:
        print(f"left out, as some case has no such quantity: {', '.join(missing)}", file=sys.stderr)
    _wrote(options, out, f"{sum(name in EVERY_QUANTITY for name in out.data_vars)} quantities")


def _interior(options: argparse.Namespace) -> None:
    x, y = _numbers("--x", options.x), _numbers("--y", options.y)
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
    write_whole(out, options.output)
    _say(f"wrote {options.output}: {out.sizes['case']} cases, {what}")


def _say(message: str) -> None:
    """Tell what was done: beside the answers, which go to standard output."""
    print(one_line(message), file=sys.stderr)


def _query(options: argparse.Namespace) -> None:
    regular(options.surrogate)
    model = surrogate.load(options.surrogate)
    if (options.table is None) == (options.at is None):
        raise InputError("query: give either a table AT.csv or --at NAME=VALUE,...")
    if options.table is not None and options.output is None:
        raise InputError("query: a table needs -o OUT.csv")
    if options.output is not None:
        inputs = [path for path in (options.surrogate, options.table) if path is not None]
        options.output = output(options.output, *inputs)
    if options.at is not None:
        values = {name: np.array([value]) for name, value in _pairs(options.at).items()}
        table = Table("--at", values, np.empty(0, dtype=np.int64))
    else:
        table = read_cases(options.table)
    answer = predicted(model, table, extrapolate=options.extrapolate)
    if model.calibration_ is None:
        _say("not calibrated: this surrogate's intervals may hold far less than 95 %")
    if options.exact is not None:
        named = {name: xr.DataArray(values, dims="point") for name, values in table.columns.items()}
        answer = _with_exact(answer, named, studies.named(location.given(options.exact)), list(model.outputs_))
    if options.output is None:
        _print_answer(answer, list(model.outputs_))
    else:
        _write_answer(options.output, table.columns, answer)
        _say(f"wrote {options.output}: {answer.sizes['point']} points, {len(model.outputs_)} outputs")


def _with_exact(
    answer: xr.Dataset, points: dict[str, xr.DataArray], study: studies.Study, outputs: list[str]
) -> xr.Dataset:
    """The answer with ``<output>_exact`` beside every output."""
    if set(points) != set(study.factors):
        raise InputError(
            f"--exact: the study's factors are {', '.join(study.factors)}; the surrogate's {', '.join(points)}"
        )
    exact = factorial.learned(study, factorial.exact(study, dict(points)))
    return answer.assign({f"{name}_exact": exact[name] for name in outputs})


def _print_answer(answer: xr.Dataset, outputs: list[str]) -> None:
    if "extrapolated" in answer and bool(answer["extrapolated"].values[0]):
        print("extrapolated: the point lies outside the trained box; its intervals are not to be trusted")
    said = predictions.table(answer, outputs)
    for name in outputs:
        exact = f"  exact {float(answer[f'{name}_exact'].values[0]): .10g}" if f"{name}_exact" in answer else ""
        print(one_line(f"{said[name]}{exact}  {answer[name].attrs.get('units', '')}"))


def _write_answer(path: Path, points: Mapping[str, NDArray[Any]], answer: xr.Dataset) -> None:
    columns = {**points, **{str(name): answer[name].values for name in answer.data_vars}}
    with writing(path) as file:
        header = io.StringIO()
        csv.writer(header, lineterminator="\n").writerow(columns)
        file.write(header.getvalue().encode())
        for begin in range(0, answer.sizes["point"], _ROWS):
            some = [values[begin : begin + _ROWS] for values in columns.values()]
            plain = [one.astype(int if one.dtype == bool else float).tolist() for one in some]
            lines = (",".join(map(repr, row)) + "\n" for row in zip(*plain, strict=True))  # every digit of a float
            file.write("".join(lines).encode())


def _material(options: argparse.Namespace) -> None:
    if options.material is None:
        print(materials.listed())
        return
    path = Path(options.material)
    material = read_material(path)[1] if path.suffix in (".yaml", ".yml") or path.exists() else find(options.material)
    with np.errstate(all="ignore"):  # what is not finite is named below
        half = HalfPlane(material)
        if not (np.isfinite(half.compliance).all() and np.isfinite(half.friction_coupling).all()):
            raise MaterialError(f"{material.name}: constants beyond what double precision can solve")
        print(_shown(_described(material, half)))


def _described(material: Material, half: HalfPlane) -> str:
    texts = (("source", material.source), ("note", material.note))
    lines = [f"{' '.join(material.name.split())}: admissible"]
    lines += [f"{label}: {' '.join(text.split())}" for label, text in texts if text]
    lines.append("constants")
    lines += [f"  {name:6s} {float(getattr(material, name)):< 14.6g} {unit}" for name, unit in UNITS.items()]
    lines.append("Stroh roots")
    lines += [f"  {p.real:+.6f} {p.imag:+.6f}i" for p in half.roots]
    if not np.isnan(material.rho):
        speed = float(limiting_speed(material))
        lines.append(f"limiting speed of a conducting punch: {speed:.6g} m/s")
    lines.append("compliance N of (u_y, phi, psi) to (sigma_yy, D_y, B_y), SI")
    lines += ["  " + "  ".join(f"{value: .6e}" for value in row) for row in half.compliance]
    lines.append("friction coupling k of (u_y, phi, psi), SI")
    lines.append("  " + "  ".join(f"{value: .6e}" for value in half.friction_coupling))
    return "\n".join(lines)


def _design(options: argparse.Namespace) -> None:
    from workflow.cli import questions  # scikit-learn and the searches: not for every command

    answer = questions.ask(options.results, vars(options))
    print(questions.as_json(answer) if options.json else _shown(questions.as_text(answer)))


def _invert(options: argparse.Namespace) -> None:
    from workflow.cli import questions

    print(_shown(questions.invert(options.results, vars(options))))


def _shown(text: str) -> str:
    """Lines whose names, which may come from a file, cannot command the terminal."""
    return "\n".join(one_line(line) for line in text.split("\n"))


def _run(options: argparse.Namespace) -> int:
    return launch(options.study, options.cores, options.profile, dry=options.dry_run)


def _numbers(where: str, text: str) -> list[float]:
    values = []
    for part in text.split(","):
        try:
            values.append(number(part))
        except ValueError:
            raise InputError(f"{where}: {part.strip()!r} is not a number") from None
    return values


def _pairs(text: str) -> dict[str, float]:
    pairs: dict[str, float] = {}
    for part in text.split(","):
        name, equals, value = part.partition("=")
        if not equals:
            raise InputError(f"--at: {part.strip()!r} is not of the form NAME=VALUE")
        if name.strip() in pairs:
            raise InputError(f"--at: {name.strip()}: given twice")
        pairs[name.strip()] = _numbers(f"--at: {name.strip()}", value)[0]
    return pairs
