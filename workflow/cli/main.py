"""The command ``meecontact``: solve cases, query a surrogate, check a material, begin, check and run a study."""

import argparse
import os
import re
import sys
import textwrap
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn, TextIO, TypeAlias

from workflow.cli.words import cores, printable_streams, say, surrogate_file, written_as
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, one_line

Commands: TypeAlias = "argparse._SubParsersAction[Any]"

#: One example a command, after ``meecontact``; those of questions ask the results of the quickstart.
EXAMPLES = {
    "run": "run quickstart",
    "init": "init mine --like point_sensor",
    "list": "list quantities",
    "material": "material PZT-4",
    "solve": 'solve --at "material=PZT-4,profile=sphere,radius=5 mm,force=1 N"',
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
    """Run the command line. What a command needs is imported when it is known: half a second before the help."""
    printable_streams()
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.command is None:
        parser.print_help()
        return 0
    from solver import PrecisionWarning, SmallStrainWarning
    from solver.threads import one_thread

    try:
        with warnings.catch_warnings(), one_thread():  # sums that threads share differ in their last digits
            warnings.simplefilter("always", PrecisionWarning)
            warnings.simplefilter("ignore", SmallStrainWarning)  # of a design the verdict says it
            warnings.showwarning = _warned
            return int(options.run(options) or 0)
    except InputError as error:
        return _refuse(f"{error}{_aside(options, error)}")
    except BrokenPipeError:  # who reads has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nor is there anything left to flush
        return 0
    except OSError as error:
        return _refuse(f"{error.filename}: {error.strerror}" if error.filename else error)
    except _refusals() as error:
        return _refuse(f"{error}{_aside(options, error)}")
    except _unsolvable() as error:
        return _refuse(f"constants beyond what double precision can solve ({error})")


def _refuse(reason: object) -> int:
    print(f"meecontact: {one_line(str(reason))}", file=sys.stderr)
    return 2


class _Version(argparse.Action):
    """Prints the version, which takes longer to look up than to parse all options."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"{parser.prog} {version('meecontact')}")
        parser.exit()


def _refusals() -> tuple[type[Exception], ...]:
    """Return the rooms' own kinds of bad input."""
    from solver import FactorError, MaterialError
    from surrogate import FormatError, OutOfBoxError

    return FactorError, MaterialError, OutOfBoxError, FormatError


def _unsolvable() -> type[Exception]:
    from numpy.linalg import LinAlgError

    return LinAlgError


def _aside(options: argparse.Namespace, error: Exception) -> str:
    """Return a hint behind an error: the option for a material that the library lacks."""
    text = str(error)
    if getattr(options, "materials", None) != [] or not re.search("(material|base|punch): .* is unknown; ", text):
        return ""
    joint = "" if text.endswith("?") else ";"
    return f"{joint} an own one: --materials FILE.yaml; all that are built in: meecontact list materials"


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
    parser.add_argument("--version", action=_Version, nargs=0, help="show program's version number and exit")
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

    _add_solve(commands)

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
    command.set_defaults(run=_query)

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

    _add_signal(commands)
    _add_export(commands)
    _add_benchmark(commands)
    _add_calculator(commands)
    _add_interior(commands)
    _add_learn(commands)
    exemplify(commands)
    return parser


def _add_si(command: argparse.ArgumentParser) -> None:
    command.add_argument("--si", action="store_true", help="print SI units without prefixes")


def _add_solve(commands: Commands) -> None:
    """Add ``solve`` to the commands of the program."""
    command = commands.add_parser("solve", help="solve one case or a table exactly: quantities and surface fields")
    _add_cases(command, printed=True, nc="netCDF", csv="CSV")
    _add_si(command)
    command.add_argument("--positions", metavar="X1,X2,...", help="surface positions X = (x - c)/h, or r/a")
    command.add_argument(
        "--peaks", action="store_true", help="also find the largest stresses of the body (milliseconds a case)"
    )
    command.set_defaults(run=_solve)


def _add_interior(commands: Commands) -> None:
    """Add ``interior`` to the commands of the program."""
    command = commands.add_parser("interior", help="solve a table of cases exactly: fields inside the body, on a grid")
    _add_cases(command, nc="netCDF")
    command.add_argument("--x", required=True, metavar="X1,X2,...", help="(x - c)/h")
    command.add_argument("--y", required=True, metavar="Y1,Y2,...", help="y/h <= 0")
    command.add_argument(
        "--fields", metavar="NAME,...", help="these fields only; strains and potentials have to be named"
    )
    command.set_defaults(run=_interior)


def _add_cases(command: argparse.ArgumentParser, *, printed: bool = False, **endings: str) -> None:
    command.add_argument(
        "cases", type=Path, nargs="?", metavar="CASES.csv", help="table of cases: one row a case, one column a factor"
    )
    command.add_argument("--at", metavar="NAME=VALUE,...", help="one case in place of a table")
    command.add_argument(
        "-o",
        "--output",
        type=written_as(**endings),
        required=not printed,
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


def _add_signal(commands: Commands) -> None:
    """Add ``signal`` to the commands of the program."""
    command = commands.add_parser(
        "signal",
        help="compute charge, voltage and amplifier output of a history of forces",
        description="HISTORY is a text file with columns of time and force, in units that its header says; a line "
        "contact may have a load [N/m]; a film may have the temperature [K or degC] of what touches it. Titles, "
        "remarks and other columns are skipped. Force and temperature are linear between the rows. The circuit begins "
        "without voltage. docs/signal.md has the circuit and its signs.",
    )
    command.add_argument("history", type=Path, metavar="HISTORY.csv")
    command.add_argument(
        "--on", required=True, metavar="CASE.csv | NAME=VALUE,...", help="the contact, without its force"
    )
    command.add_argument(
        "--device", required=True, metavar="NAME=VALUE,...", help="'input_capacitance=10 pF,input_resistance=1 GOhm'"
    )
    command.add_argument("--scale", metavar="'NUMBER N/V'", help="force of a volt, for a force recorded as a voltage")
    command.add_argument(
        "--temperature", default="293.15", metavar="K", help="temperature of the circuit; default: 293.15"
    )
    command.add_argument(
        "--parts", type=int, default=1, help="number of parts of every interval between rows; default: 1"
    )
    command.add_argument("-o", "--output", type=written_as(csv="CSV"), required=True, metavar="OUT.csv")
    command.add_argument(
        "--materials",
        type=Path,
        action="append",
        default=[],
        metavar="FILE.yaml",
        help="file of a material that the library lacks",
    )
    command.set_defaults(run=_signal)


def _add_export(commands: Commands) -> None:
    """Add ``export`` to the commands of the program."""
    command = commands.add_parser(
        "export",
        help="write a trained surrogate as C, for controllers and simulators",
        description="Rounds outputs of a surrogate to an error. c: NAME.c and NAME.h, C89 without allocation or "
        "library calls beyond math.h, with value, 95 % interval, gradient and a check of the box. fmu: a unit for "
        "system simulators (FMI 3.0, Co-Simulation), with these sources and, where there is a compiler, a binary.",
    )
    command.add_argument("surrogate", type=surrogate_file, metavar="surrogate.nc", help="or results/STUDY")
    command.add_argument("--as", dest="form", required=True, choices=["c", "fmu"])
    command.add_argument("--outputs", metavar="NAME,...", help="default: all")
    command.add_argument(
        "--error", default="1e-5", metavar="SHARE", help="largest error over an output's range; default: 1e-5"
    )
    command.add_argument("--precision", choices=["single", "double"], default="double", help="default: double")
    command.add_argument(
        "-o", "--output", type=Path, metavar="NAME.c|.fmu", help="default: the study's name, in this folder"
    )
    command.set_defaults(run=_export)


def _add_benchmark(commands: Commands) -> None:
    """Add ``benchmark`` to the commands of the program."""
    command = commands.add_parser(
        "benchmark",
        help="compare numbers of another code with a table of solved problems",
        description="Prints a verdict for every number of the table (docs/benchmark.md). The file has the columns "
        "problem, quantity and value, in SI units. Without a file: prints the table.",
    )
    command.add_argument("answers", type=Path, nargs="?", metavar="ANSWERS.csv")
    command.set_defaults(run=_benchmark)


def _add_calculator(commands: Commands) -> None:
    """Add ``calculator`` to the commands of the program."""
    command = commands.add_parser(
        "calculator",
        help="write a web page that calculates contacts, without a server",
        description="One file: every material, punch and profile of the library by closed forms, a few films by "
        "tables, own constants pasted in.",
    )
    command.add_argument(
        "-o", "--output", type=written_as(html="HTML"), default=Path("calculator.html"), metavar="OUT.html"
    )
    command.set_defaults(run=_calculator)


def _add_learn(commands: Commands) -> None:
    """Add ``learn`` to the commands of the program."""
    command = commands.add_parser(
        "learn",
        help="correct a surrogate by measurements",
        description="Estimates uncertain constants and discrepancies from measured rows, with intervals. MEASURED.csv "
        "has a column for every factor and category of the study, and columns of measured quantities. NAME_std is one "
        "standard deviation of the error of NAME. Cells may be empty; errors that are missing are estimated. A header "
        "may say a unit, as 'thickness [um]'; a number without a unit is in SI.",
    )
    command.add_argument("measured", type=Path, metavar="MEASURED.csv")
    command.add_argument("--on", type=surrogate_file, required=True, metavar="results/STUDY/surrogate.nc")
    command.add_argument(
        "--uncertain",
        action="append",
        metavar="NAME[=5%],...",
        help="'BaTiO3 permittivity', 'BaTiO3 e33', 'steel modulus'",
    )
    command.add_argument(
        "--instrument",
        action="append",
        metavar="QUANTITY_gain=3%,...",
        help="'voltage_gain=3%%', 'depth_offset=0.1um': what readings may be off by, all alike; one standard deviation",
    )
    command.add_argument(
        "-o",
        "--output",
        type=written_as(nc="netCDF"),
        metavar="OUT.nc",
        help="default: corrected.nc beside the surrogate",
    )
    command.add_argument("--json", action="store_true", help="print JSON instead of words")
    command.set_defaults(run=_learn)


def _material(options: argparse.Namespace) -> None:
    from workflow.cli import materials

    print(materials.listed() if options.material is None else _shown(materials.described(options.material)))


def _design(options: argparse.Namespace) -> None:
    from storage.files import output, write_text
    from workflow.cli import questions
    from workflow.cli.progress import busy
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
    from workflow.cli.progress import busy

    with busy("inferring"):
        answer = questions.invert(options.results, vars(options), si=options.si)
    print(_shown(answer))


def _shown(text: str) -> str:
    """Lines whose names, which may come from a file, cannot command the terminal."""
    return "\n".join(one_line(line) for line in text.split("\n"))


def _init(options: argparse.Namespace) -> None:
    from workflow.cli import studies

    say(f"wrote {studies.begin(options.name, options.like)}: meecontact run {options.name}")


def _list(options: argparse.Namespace) -> None:
    from workflow.cli import studies

    print(_shown(studies.listed(options.kind)))


def _run(options: argparse.Namespace) -> int:
    from workflow.cli.launch import launch

    return launch(options.study, options.cores, options.profile, dry=options.dry_run)


def _solve(options: argparse.Namespace) -> None:
    from workflow.cli import solve

    solve.solve_table(options)


def _interior(options: argparse.Namespace) -> None:
    from workflow.cli import solve

    solve.solve_inside(options)


def _query(options: argparse.Namespace) -> None:
    from workflow.cli.query import query

    query(options)


def _signal(options: argparse.Namespace) -> None:
    from workflow.cli.sensing import signal

    signal(options)


def _benchmark(options: argparse.Namespace) -> None:
    from workflow.cli.benchmark import benchmark

    benchmark(options)


def _export(options: argparse.Namespace) -> None:
    from workflow.cli.export import export

    export(options)


def _learn(options: argparse.Namespace) -> None:
    from workflow.cli.learn import learn

    learn(options)


def _calculator(options: argparse.Namespace) -> None:
    from storage.files import output, write_text
    from workflow.calculator.page import page

    path = output(options.output)
    write_text(path, page())
    say(f"wrote {path}: open it in a browser")
