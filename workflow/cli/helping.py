"""Help of every command: how it is laid out, and an example of each that can be pasted."""

import argparse
import textwrap
from typing import Any, NoReturn

from workflow.language.spelling import nearest

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
