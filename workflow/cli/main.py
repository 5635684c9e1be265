"""The command ``meecontact``: its commands with options and help, and their dispatch."""

import argparse
import os
import re
import sys
import textwrap
import warnings
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from workflow.cli.words import cores, printable_streams, say, surrogate_file, written_as
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, one_line

Option = tuple[tuple[str, ...], dict[str, Any]]


class Command(NamedTuple):
    """One command."""

    function: str  # module of `workflow.cli` and name; takes the options, and returns an exit status or None
    help: str
    example: str  # after ``meecontact``; questions use the results of the quickstart
    options: tuple[Option, ...]
    description: str | None = None


def _command(function: str, words: str, example: str, *options: Option, description: str | None = None) -> Command:
    return Command(function, words, example, options, description)


def _option(*names: str, **details: Any) -> Option:
    """Return the arguments of `argparse.ArgumentParser.add_argument`."""
    return names, details


def _optional(name: str, metavar: str, words: str | None = None, **details: Any) -> Option:
    return _option(name, nargs="?", metavar=metavar, help=words, **details)


def _number(name: str, metavar: str, words: str, **details: Any) -> Option:
    return _option(name, type=float, metavar=metavar, help=words, **details)


def _written(words: str | None = None, *, required: bool = True, **endings: str) -> Option:
    names = "|".join(f"OUT.{ending}" for ending in endings)
    return _option("-o", "--output", type=written_as(**endings), required=required, metavar=names, help=words)


def _repeated(name: str, metavar: str, words: str | None = None, *, required: bool = False) -> Option:
    return _option(name, action="append", metavar=metavar, help=words, required=required)


_CASES = (
    _optional("cases", "CASES.csv", "table of cases: one row a case, one column a factor", type=Path),
    _option("--at", metavar="NAME=VALUE,...", help="one case in place of a table"),
)
_MATERIALS = _option("--materials", type=Path, action="append", default=[], metavar="FILE.yaml",
                     help="file of a material that the library lacks")  # fmt: skip
_SI = _option("--si", action="store_true", help="print SI units without prefixes")
_JSON = _option("--json", action="store_true", help="print JSON instead of words")
_SURROGATE = _option("surrogate", type=surrogate_file, metavar="surrogate.nc", help="or results/STUDY")
_RESULTS = _option("results", type=Path, metavar="results/STUDY")

COMMANDS = {
    "run": _command(
        "launch.run",
        "check a study and run it with Snakemake, up to its report",
        "run quickstart",
        _option("study", help="name of a study in config/, or path of its file (.yaml)"),
        _option("--cores", default="all", type=cores, metavar="N", help="largest number of cores; default: all"),
        _option("--profile", default="default", metavar="NAME", help="slurm, or a folder in profiles/"),
        _option("-n", "--dry-run", action="store_true", help="print the steps, run nothing"),
    ),
    "init": _command(
        "studies.init",
        "write a commented study that runs as it is",
        "init mine --like point_sensor",
        _option("name", metavar="NAME", help="name of the study: writes config/NAME.yaml"),
        _option("--like", metavar="STUDY", help="start from a copy of a study of the program"),
    ),
    "list": _command(
        "studies.show",
        "list names: studies, factors, quantities, materials",
        "list quantities",
        _optional("kind", "KIND", "one of these kinds; default: all"),
    ),
    "material": _command(
        "materials.show",
        "check a material and print its constants; or list the library",
        "material PZT-4",
        _optional("material", "FILE.yaml", "a material's file or the name of a library material; none: the list"),
    ),
    "solve": _command(
        "solve.solve_table",
        "solve one case or a table exactly: quantities and surface fields",
        'solve --at "material=PZT-4,profile=sphere,radius=5 mm,force=1 N"',
        *_CASES,
        _written(required=False, nc="netCDF", csv="CSV"),
        _MATERIALS,
        _SI,
        _option("--positions", metavar="X1,X2,...", help="surface positions X = (x - c)/h, or r/a"),
        _option(
            "--peaks", action="store_true", help="also find the largest stresses of the body (milliseconds a case)"
        ),
    ),
    "query": _command(
        "query.query",
        "predict with a trained surrogate: values and intervals",
        "query results/quickstart --at volume_fraction=0.6,friction=0.2,radius=10cm,load=10kN/m,charge=0",
        _SURROGATE,
        _optional("table", "AT.csv", "table of points: one row a point, one column an input", type=Path),
        _option("--at", metavar="NAME=VALUE,...", help="one point, whose answer is printed"),
        _written(required=False, csv="CSV"),
        _number("--level", "SHARE", "share of cases that intervals contain; default: the study's"),
        _SI,
        _option("--extrapolate", action="store_true", help="answer outside the trained box as well, with a flag"),
        _option("--exact", metavar="STUDY", help="the surrogate's study: also solve the points exactly"),
        description=(
            "Predicts values with intervals. An interval contains the exact value in 95 % of cases, or in the "
            "share that --level states. The table has the inputs, then NAME, NAME_std, NAME_lower and NAME_upper "
            "of every output. NAME +- NAME_std contains 68 %; errors are not Gaussian, so that intervals are no "
            "multiple of it."
        ),
    ),
    "design": _command(
        "questions.design",
        "answer a design question with a trained surrogate, in seconds",
        'design results/quickstart --maximise "abs(voltage_per_load)" --over radius,volume_fraction \\\n'
        '  --at load=5kN/m --worst-case friction=0.1:0.4 --limit "trailing_tension <= tensile_strength"',
        _RESULTS,
        _repeated("--maximise", "EXPRESSION", "given twice: a Pareto front"),
        _repeated("--minimise", "EXPRESSION"),
        _repeated("--over", "NAME[=LOW:HIGH | =A|B|C],...", required=True),
        _repeated("--at", "NAME=VALUE,...", "fixed values; other factors have their defaults"),
        _repeated("--worst-case", "NAME=LOW:HIGH,..."),
        _repeated("--uncertain", "NAME=normal(MEAN,STD),..."),
        _repeated("--tolerance", "NAME=5%|10um,...", "manufacturing tolerance"),
        _option("--robust", nargs=1, metavar="'mean - 2 std'", help="default: 'worst case'"),
        _repeated("--limit", "'trailing_tension <= 50 MPa'"),
        _SI,
        _option("--json", action="store_true", help="print JSON instead of a table"),
        _written("write the answer instead of printing it", required=False, csv="CSV", json="JSON"),
    ),
    "invert": _command(
        "questions.infer",
        "infer factors from measured quantities, with intervals",
        "invert results/quickstart --measured voltage=-519+-5 --infer load \\\n"
        "  --at volume_fraction=0.67,radius=12cm,friction=0.2,charge=0",
        _RESULTS,
        _repeated(
            "--measured",
            "NAME=VALUE+-STD,...",
            "with one standard deviation, as -519+-5 or -0.52kV+-1%%",
            required=True,
        ),
        _repeated("--infer", "NAME,...", "one to three factors", required=True),
        _repeated("--at", "NAME=VALUE,...", "values of the other factors"),
        _SI,
    ),
    "signal": _command(
        "sensing.signal",
        "compute charge, voltage and amplifier output of a history of forces",
        "signal examples/press.csv -o signal.csv \\\n"
        '  --on "profile=sphere,radius=2.5 mm,punch=steel,material=PVDF,thickness=110 um,base=glass" \\\n'
        '  --device "input_capacitance=10 pF,feedback_capacitance=10 pF,feedback_resistance=1 TOhm"',
        _option("history", type=Path, metavar="HISTORY.csv"),
        _option("--on", required=True, metavar="CASE.csv | NAME=VALUE,...", help="the contact, without its force"),
        _option(
            "--device",
            required=True,
            metavar="NAME=VALUE,...",
            help="'input_capacitance=10 pF,input_resistance=1 GOhm'",
        ),
        _number("--temperature", "K", "temperature of the circuit; default: 293.15", default=293.15),
        _option("--parts", type=int, default=1, help="number of parts of every interval between rows; default: 1"),
        _written(csv="CSV"),
        _MATERIALS,
        description=(
            "HISTORY is a table with the columns time and force, in units that its header says; a line contact "
            "may have a load [N/m]; a film may have the temperature [K or degC] of what touches it. Force and "
            "temperature are linear between the rows. The circuit begins without voltage. docs/signal.md has the "
            "circuit and its signs."
        ),
    ),
    "export": _command(
        "export.export",
        "write a trained surrogate as C, for controllers and simulators",
        "export results/quickstart --as c --outputs voltage,depth -o sensor.c",
        _SURROGATE,
        _option("--as", dest="form", required=True, choices=["c", "fmu"]),
        _option("--outputs", metavar="NAME,...", help="default: all"),
        _number("--error", "SHARE", "largest error over an output's range; default: 1e-5", default=1e-5),
        _option("--precision", choices=["single", "double"], default="double", help="default: double"),
        _option("-o", "--output", type=Path, metavar="NAME.c|.fmu", help="default: the study's name, in this folder"),
        description=(
            "Rounds outputs of a surrogate to an error. c: NAME.c and NAME.h, C89 without allocation or library "
            "calls beyond math.h, with value, 95 % interval, gradient and a check of the box. fmu: a unit for "
            "system simulators (FMI 3.0, Co-Simulation), with these sources and, where there is a compiler, a "
            "binary."
        ),
    ),
    "benchmark": _command(
        "benchmark.benchmark",
        "compare numbers of another code with a table of solved problems",
        "benchmark examples/answers.csv",
        _optional("answers", "ANSWERS.csv", type=Path),
        description=(
            "Prints a verdict for every number of the table (docs/benchmark.md). The file has the columns "
            "problem, quantity and value, in SI units. Without a file: prints the table."
        ),
    ),
    "calculator": _command(
        "main.calculator",
        "write a web page that calculates contacts, without a server",
        "calculator -o contact.html",
        _option("-o", "--output", type=written_as(html="HTML"), default=Path("calculator.html"), metavar="OUT.html"),
        description=(
            "One file: every material, punch and profile of the library by closed forms, a few films by tables, "
            "own constants pasted in."
        ),
    ),
    "interior": _command(
        "solve.solve_inside",
        "solve a table of cases exactly: fields inside the body, on a grid",
        "interior examples/cases.csv -o inside.nc --x=-1,0,1 --y=-1,-0.5",
        *_CASES,
        _written(nc="netCDF"),
        _MATERIALS,
        _option("--x", required=True, metavar="X1,X2,...", help="(x - c)/h"),
        _option("--y", required=True, metavar="Y1,Y2,...", help="y/h <= 0"),
        _option("--fields", metavar="NAME,...", help="these fields only; strains and potentials have to be named"),
    ),
    "learn": _command(
        "learn.learn",
        "correct a surrogate by measurements",
        "learn examples/measured.csv --on results/film/surrogate.nc",
        _option("measured", type=Path, metavar="MEASURED.csv"),
        _option("--on", type=surrogate_file, required=True, metavar="results/STUDY/surrogate.nc"),
        _repeated("--uncertain", "NAME[=5%],...", "'BaTiO3 permittivity', 'BaTiO3 e33', 'steel modulus'"),
        _written("default: corrected.nc beside the surrogate", required=False, nc="netCDF"),
        _JSON,
        description=(
            "Estimates uncertain constants and discrepancies from measured rows, with intervals. MEASURED.csv has "
            "a column for every factor and category of the study, and columns of measured quantities. NAME_std is "
            "one standard deviation of the error of NAME. Cells may be empty; errors that are missing are "
            "estimated. A header may say a unit, as 'thickness [um]'; a number without a unit is in SI."
        ),
    ),
}


class _Layout(argparse.HelpFormatter):
    """Help with wide columns of names, and with lines of examples as they are."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=30)
        self._action_max_length = 14  # names of commands, which argparse measures without their indent

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return textwrap.indent(text, indent) if "\n" in text else super()._fill_text(text, width, indent)


class Parser(argparse.ArgumentParser):
    """Parser that refuses in one line, with suggestions for unknown commands."""

    def __init__(self, **options: Any) -> None:
        super().__init__(formatter_class=_Layout, **options)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            raise argparse.ArgumentError(action, f"{value!r} is unknown; {nearest(str(value), list(action.choices))}")

    def error(self, message: str) -> NoReturn:
        """Report bad usage in one line, without the usage text."""
        self.exit(2, f"{self.prog}: {' '.join(message.split())}\n")


_ABOUT = """\
Charge, voltage and stroke of contacts on piezoelectric, piezomagnetic and
magneto-electro-elastic bodies.

  meecontact run quickstart          run a study, in half a minute
  meecontact init mine               write a study to start from, with comments
  meecontact COMMAND --help          show the options and an example
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; modules of a command are imported when it is known, which saves the help half a second."""
    printable_streams()
    parser = _parser()
    try:
        options = parser.parse_args(arguments)
    except OSError as error:  # of a path that no file can have, which an option looks up
        return _refuse_file(error)
    if options.command is None:
        parser.print_help()
        return 0
    from numpy.linalg import LinAlgError

    from solver import PrecisionWarning, SmallStrainWarning
    from solver.threads import one_thread

    try:
        with warnings.catch_warnings(), one_thread():  # sums that threads share differ in their last digits
            warnings.simplefilter("always", PrecisionWarning)
            warnings.simplefilter("ignore", SmallStrainWarning)  # which the verdict on a design reports
            warnings.showwarning = lambda message, *_: say(f"meecontact: warning: {message}")
            module, _, name = options.function.partition(".")
            return int(getattr(import_module(f"workflow.cli.{module}"), name)(options) or 0)
    except InputError as error:
        return _refuse(f"{error}{_aside(options, error)}")
    except BrokenPipeError:  # the reader of a pipe has ended
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nothing is left to flush
        return 0
    except OSError as error:
        return _refuse_file(error)
    except LinAlgError as error:
        return _refuse(f"constants beyond what double precision can solve ({error})")
    except _refusals() as error:
        return _refuse(f"{error}{_aside(options, error)}")


def _refuse(reason: object) -> int:
    print(f"meecontact: {one_line(str(reason))}", file=sys.stderr)
    return 2


def _refuse_file(error: OSError) -> int:
    return _refuse(f"{error.filename}: {error.strerror}" if error.filename else error)


class _Version(argparse.Action):
    """Option that prints the version, whose look-up takes longer than parsing all options."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"{parser.prog} {version('meecontact')}")
        parser.exit()


def _refusals() -> tuple[type[Exception], ...]:
    """Return the rooms' errors for bad input."""
    from solver import FactorError, MaterialError
    from surrogate import FormatError, OutOfBoxError

    return FactorError, MaterialError, OutOfBoxError, FormatError


def _aside(options: argparse.Namespace, error: Exception) -> str:
    """Return a hint behind an error: the option for a material that the library lacks."""
    text = str(error)
    if getattr(options, "materials", None) != [] or not re.search("(material|base|punch): .* is unknown; ", text):
        return ""
    joint = "" if text.endswith("?") else ";"
    return f"{joint} an own one: --materials FILE.yaml; all that are built in: meecontact list materials"


def _parser() -> Parser:
    parser = Parser(prog="meecontact", description=_ABOUT)
    parser.add_argument("--version", action=_Version, nargs=0, help="show program's version number and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    for name, known in COMMANDS.items():
        example = f"example:\n  meecontact {textwrap.indent(known.example, '  ').lstrip()}"
        command = commands.add_parser(name, help=known.help, description=known.description, epilog=example)
        command.set_defaults(function=known.function)
        for names, details in known.options:
            command.add_argument(*names, **details)
    return parser


def calculator(options: argparse.Namespace) -> None:
    """Write the calculator."""
    from storage.files import output, write_text
    from workflow.calculator.page import page

    path = output(options.output)
    write_text(path, page())
    say(f"wrote {path}: open it in a browser")
