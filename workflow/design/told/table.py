"""What a run's targets came to, as a table for the terminal: every design with its verdict."""

from pathlib import Path

import xarray as xr

from storage.netcdf import read_whole
from workflow.design.told.words import verdict
from workflow.design.verdict import answers
from workflow.language import titles
from workflow.language.numbers import shown

_HEAD = ("target", "verdict", "goal", "design")


def table(folder: Path, targets: list[str]) -> list[str]:
    """Lines of the table; none without targets.

    Parameters
    ----------
    folder
        ``results/<study>``, holding ``design/<target>.nc``.
    targets
        Names, in the study's order.
    """
    if not targets:
        return []
    found = {name: read_whole(folder / "design" / f"{name}.nc") for name in targets}
    rows = [_HEAD, *(_row(name, one) for name, one in found.items())]
    wide = [max(len(row[column]) for row in rows) for column in range(len(_HEAD))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, wide, strict=True)).rstrip() for row in rows]
    for place, one in reversed(list(enumerate(found.values(), 1))):
        lines.insert(place + 1, f"{'':{wide[0]}}  {_why(one)}")
    return lines


def _row(name: str, answer: xr.Dataset) -> tuple[str, str, str, str]:
    first = answer.isel(term=0)
    value = shown(float(first["exact"]), str(first["units"].values), 4)
    parts = [kind for _, kind, role in answers.kinds(answer) if role == "variable"]
    for factor in map(str, answer["factor"].values):
        one = answer.sel(factor=factor)
        if str(one["role"].values) == "variable":
            parts.append(f"{titles.title(factor)} {titles.value(factor, float(one['value']))}")
    return name, verdict(answer).kind, f"{titles.objective(str(first['term'].values))} {value}", ", ".join(parts)


def _why(answer: xr.Dataset) -> str:
    """What stops the design, and what would help."""
    told = verdict(answer)
    return " ".join([titles.capital(told.stops), *filter(None, (told.advice, told.idle))])
