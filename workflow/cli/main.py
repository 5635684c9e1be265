"""The command ``meecontact``: solve cases, query a surrogate, check a material, begin, check and run a study."""

import argparse
import os
import sys
import textwrap
import warnings
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NoReturn, TextIO

import numpy as np

from solver import FactorError, MaterialError, PrecisionWarning
from solver.threads import one_thread
from storage.files import output, write_text
from surrogate import FormatError, OutOfBoxError
from workflow.cli import benchmark, export, learn, materials, sensing, solve, studies
from workflow.cli.launch import launch
from workflow.cli.progress import busy
from workflow.cli.query import query
from workflow.cli.words import cores, printable_streams, say, surrogate_file, written_as
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, one_line

#: One example a command, after ``meecontact``; those of questions ask the results of the quickstart.
EXAMPLES = {
    "run": "run quickstart",
    "init": "init mine --like point_sensor",
    "list": "list quantities",
    "material": "material PZT-4",
    "solve": "solve examples/cases.csv -o cases.csv",
    "interior": "interior examples/cases.csv -o inside.nc --x=-1,0,1 --y=-1,-0.5",
    "query": "query results/quickstart --at volume_fraction=0.6,friction=0.2,radius=10cm,load=10kN/m,charge=0",
    "design": 'design results/quickstart --maximise "abs(voltage_per_load)" --over radius,volume_fraction \\\n'
    '  --at load=5kN/m --worst-case friction=0.1:0.4 --limit "trailing_tension <= tensile_strength"',
    "invert": "invert results/quickstart --measured voltage=-519+-5 --infer load \\\n"
    "  --at volume_fraction=0.67,radius=12cm,friction=0.2,charge=0",
    "learn": "learn examples/measured.csv --on results/film/surrogate.nc",
    "signal": "signal examples/press.csv -o signal.csv \\\n"
    '  --on "profile=sphere,radius=2.5 mm,punch=steel,material=PVDF,thickness=110 um,base=glass" \\\n'
    '  --device "input_capacitance=10 pF,feedback_capacitance=10 pF,feedback_resistance=1 TOhm"',
    "export": "export results/quickstart --as c --outputs voltage,depth -o sensor.c",
    "benchmark": "benchmark examples/answers.csv",
    "calculator": "calculator -o contact.html",
}


class _Layout(argparse.HelpFormatter):
    """Names beside what they mean, and paragraphs that keep lines of their own."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=30)
        self._action_max_length = 14  # names of commands, which argparse measures without their indent

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return textwrap.indent(text, indent) if "\n" in text else super()._fill_text(text, width, indent)


class Parser(argparse.ArgumentParser):
    """Complains in one line, and says what a command may have been meant to be."""

    def __init__(self, **options: Any) -> None:
        super().__init__(formatter_class=_Layout, **options)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            raise argparse.ArgumentError(action, f"{value!r} is none; {nearest(str(value), list(action.choices))}")

    def error(self, message: str) -> NoReturn:
        """Report bad usage in one line, without the usage text."""
        self.exit(2, f"{self.prog}: {' '.join(message.split())}\n")


def exemplify(commands: "argparse._SubParsersAction[Any]") -> None:
    """Put its example below the help of every command."""
    for name, command in commands.choices.items():
        command.epilog = f"example:\n  meecontact {textwrap.indent(EXAMPLES[name], '  ').lstrip()}"


_ABOUT = """\
Charge, voltage and stroke of contacts on piezoelectric, piezomagnetic and
magneto-electro-elastic bodies.

  meecontact run quickstart          run a study, in half a minute
  meecontact init mine               write a study to start from, with comments
  meecontact COMMAND --help          show the options and an example
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line."""
    printable_streams()
    options = _parser().parse_args(arguments)
    try:
        with warnings.catch_warnings(), one_thread():  # sums that threads share differ in their last digits
            warnings.simplefilter("always", PrecisionWarning)
            warnings.showwarning = _warned
            return int(options.run(options) or 0)
    except (InputError, FactorError, MaterialError, OutOfBoxError, FormatError) as error:
        print(f"meecontact: {one_line(f'{error}{_aside(options, error)}')}", file=sys.stderr)
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


def _aside(options: argparse.Namespace, error: Exception) -> str:
    """Return a hint behind an error: the option for a material that the library lacks."""
    unknown = (
        isinstance(error, MaterialError) and "is unknown" in str(error) and getattr(options, "materials", None) == []
    )
    return " an own one: --materials FILE.yaml; all that are built in: meecontact list materials" if unknown else ""


def _warned(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Print a warning of the solver (:class:`solver.PrecisionWarning`) in one line."""
    say(f"meecontact: warning: {message}")


def _parser() -> Parser:
    parser = Parser(prog="meecontact", description=_ABOUT)
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('meecontact')}")
    parser.set_defaults(run=lambda options: parser.print_help())
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")

    command = commands.add_parser("run", help="check a study and run it with Snakemake, up to its report")
    command.add_argument("study", help="name of a study in config/, or path of its file (.yaml)")
    command.add_argument(
        "--cores", default="all", type=cores, metavar="N", help="largest number of cores; default: all"
    )
    command.add_argument("--profile", default="default", metavar="NAME", help="slurm, or a folder in profiles/")
    command.add_argument("-n", "--dry-run", action="store_true", help="print the steps, run nothing")
    command.set_defaults(run=_run)

    command = commands.add_parser("init", help="write a commented study that runs as it is")
    command.add_argument("name", metavar="NAME", help="name of the study: writes config/NAME.yaml")
    command.add_argument("--like", metavar="STUDY", help="start from a copy of a study of the program")
    command.set_defaults(run=_init)

    command = commands.add_parser("list", help="list names: studies, factors, quantities, materials")
    command.add_argument("kind", nargs="?", metavar="KIND", help="one of these kinds; default: all")
    command.set_defaults(run=_list)

    command = commands.add_parser("material", help="check a material and print its constants; or list the library")
    command.add_argument(
        "material",
        nargs="?",
        metavar="FILE.yaml",
        help="a material's file or the name of a library material; none: the list",
    )
    command.set_defaults(run=_material)

    solve.add_solve(commands)

    command = commands.add_parser(
        "query",
        help="predict with a trained surrogate: values and intervals",
        description="Predicts values with intervals. An interval contains the exact value in 95 % of cases, or in the "
        "share that --level states. The table has the inputs, then NAME, NAME_std, NAME_lower and NAME_upper of every "
        "output. NAME +- NAME_std contains 68 %; errors are not Gaussian, so that intervals are no multiple of it.",
    )
    command.add_argument("surrogate", type=surrogate_file, metavar="surrogate.nc", help="or results/STUDY")
    command.add_argument(
        "table", type=Path, nargs="?", metavar="AT.csv", help="table of points: one row a point, one column an input"
    )
    command.add_argument("--at", metavar="NAME=VALUE,...", help="one point, whose answer is printed")
    command.add_argument("-o", "--output", type=written_as(csv="CSV"), metavar="OUT.csv")
    command.add_argument(
        "--level", type=float, metavar="SHARE", help="share of cases that intervals contain; default: the study's"
    )
    _add_si(command)
    command.add_argument(
        "--extrapolate", action="store_true", help="answer outside the trained box as well, with a flag"
    )
    command.add_argument("--exact", metavar="STUDY", help="the surrogate's study: also solve the points exactly")
    command.set_defaults(run=query)

    command = commands.add_parser("design", help="answer a design question with a trained surrogate, in seconds")
    command.add_argument("results", type=Path, metavar="results/STUDY")
    command.add_argument("--maximise", action="append", metavar="EXPRESSION", help="given twice: a Pareto front")
    command.add_argument("--minimise", action="append", metavar="EXPRESSION")
    command.add_argument("--over", action="append", required=True, metavar="NAME[=LOW:HIGH | =A|B|C],...")
    command.add_argument(
        "--at", action="append", metavar="NAME=VALUE,...", help="fixed values; other factors have their defaults"
    )
    command.add_argument("--worst-case", action="append", metavar="NAME=LOW:HIGH,...")
    command.add_argument("--uncertain", action="append", metavar="NAME=normal(MEAN,STD),...")
    command.add_argument("--tolerance", action="append", metavar="NAME=5%|10um,...", help="manufacturing tolerance")
    command.add_argument("--robust", nargs=1, metavar="'mean - 2 std'", help="default: 'worst case'")
    command.add_argument("--limit", action="append", metavar="'trailing_tension <= 50 MPa'")
    _add_si(command)
    command.add_argument("--json", action="store_true", help="print JSON instead of a table")
    command.add_argument(
        "-o",
        "--output",
        type=written_as(csv="CSV", json="JSON"),
        metavar="OUT.csv|.json",
        help="write the answer instead of printing it",
    )
    command.set_defaults(run=_design)

    command = commands.add_parser("invert", help="infer factors from measured quantities, with intervals")
    command.add_argument("results", type=Path, metavar="results/STUDY")
    command.add_argument(
        "--measured",
        action="append",
        required=True,
        metavar="NAME=VALUE+-STD,...",
        help="with one standard deviation, as -519+-5 or -0.52kV+-1%%",
    )
    command.add_argument("--infer", action="append", required=True, metavar="NAME,...", help="one to three factors")
    command.add_argument("--at", action="append", metavar="NAME=VALUE,...", help="values of the other factors")
    _add_si(command)
    command.set_defaults(run=_invert)

    sensing.add(commands)
    export.add(commands)
    benchmark.add(commands)
    add(commands)

    solve.add_interior(commands)
    learn.add(commands)
    exemplify(commands)
    return parser


def _add_si(command: argparse.ArgumentParser) -> None:
    command.add_argument("--si", action="store_true", help="print SI units without prefixes")


def _material(options: argparse.Namespace) -> None:
    print(materials.listed() if options.material is None else _shown(materials.described(options.material)))


def _design(options: argparse.Namespace) -> None:
    from workflow.cli import questions  # scikit-learn and the searches: not for every command
    from workflow.design.wording import table
    from workflow.design.wording.words import verdict

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
    say(f"wrote {studies.begin(options.name, options.like)}: meecontact run {options.name}")


def _list(options: argparse.Namespace) -> None:
    print(_shown(studies.listed(options.kind)))


def _run(options: argparse.Namespace) -> int:
    return launch(options.study, options.cores, options.profile, dry=options.dry_run)


def add(commands: "argparse._SubParsersAction[Any]") -> None:
    """Add the command to those of the program."""
    command = commands.add_parser(
        "calculator",
        help="write a web page that calculates contacts, without a server",
        description="One file: every material, punch and profile of the library by closed forms, a few films by "
        "tables, own constants pasted in.",
    )
    command.add_argument(
        "-o", "--output", type=written_as(html="HTML"), default=Path("calculator.html"), metavar="OUT.html"
    )
    command.set_defaults(run=write)


def write(options: argparse.Namespace) -> None:
    """Write the page."""
    from workflow.calculator.page import page  # tables of films: not for every command

    path = output(options.output)
    write_text(path, page())
    say(f"wrote {path}: open it in a browser")
