"""``meecontact init`` and ``meecontact list``: a study to begin with, and every name that it may use."""

import argparse
from collections.abc import Mapping
from pathlib import Path

from solver.names import ALL_QUANTITIES, CHOICES
from solver.units import written
from storage.files import write_text
from workflow.cli import materials
from workflow.cli.words import printable, say
from workflow.language.factors import FACTORS
from workflow.language.spelling import nearest
from workflow.study import location
from workflow.study.reading import InputError, one_line

_BEGINNING = Path(__file__).with_name("study.yaml")


def init(options: argparse.Namespace) -> None:
    """Write a commented study that runs as it is, as the options say."""
    name, like = options.name, options.like
    location.check_name(name, f"init: {name!r}")
    path = location.FOLDER / f"{name}.yaml"
    if path.exists():
        raise InputError(f"init: {path} is there already; remove it, or choose another name")
    known = location.files(location.BUNDLED)
    if like is not None and like not in known:
        raise InputError(f"--like: {like!r} is unknown; {nearest(like, list(known))}")
    text = (_BEGINNING if like is None else known[like]).read_text(encoding="utf-8").replace("NAME", name, 1)
    path.parent.mkdir(exist_ok=True)
    write_text(path, text)
    say(f"wrote {path}: meecontact run {name}")


def show(options: argparse.Namespace) -> None:
    """Print the names of a kind, as the options say."""
    print(printable(listed(options.kind)))


def listed(kind: str | None) -> str:
    """Return materials, quantities, factors or studies, a line each; for None all kinds, with headings."""
    known = {"studies": _studies, "factors": _factors, "quantities": _quantities, "materials": materials.listed}
    if kind is None:
        return "\n\n".join(f"{name}:\n{lines()}" for name, lines in known.items())
    if kind not in known:
        raise InputError(f"list: {kind!r} is unknown; {nearest(kind, list(known))}")
    return known[kind]()


def _studies() -> str:
    """Return name and title of every study in the current folder, and then of the program's."""
    rows = {}
    local = location.files(location.FOLDER)
    for file in (local | location.files(location.BUNDLED) | local).values():
        lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
        title = next((line.partition(":")[2] for line in lines if line.startswith("title:")), "")
        rows[file.stem] = (one_line(title.strip().strip("\"'")),)
    return _table(rows)


def _factors() -> str:
    """Return name, unit and meaning of every factor, and the names that categories take."""
    rows = {name: (written(factor.units), factor.long_name) for name, factor in FACTORS.items()}
    rows |= {name: ("", f"one of {', '.join(names)}") for name, names in CHOICES.items()}
    return _table(rows)


def _quantities() -> str:
    return _table({name: (written(quantity.units), quantity.long_name) for name, quantity in ALL_QUANTITIES.items()})


def _table(rows: Mapping[str, tuple[str, ...]]) -> str:
    """Return names and their cells in columns."""
    table = [(name, *cells) for name, cells in rows.items()]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return "\n".join("  ".join(map(str.ljust, row, widths)).rstrip() for row in table)
