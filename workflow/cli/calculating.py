"""``meecontact calculator``: the page that calculates contacts in a browser, as a file of one's own."""

import argparse
from pathlib import Path
from typing import Any

from storage.files import output, write_text
from workflow.cli.words import say, written_as


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
