"""Targets that no design reaches: told on the terminal when a run ends, which did its work all the same."""

from collections.abc import Iterable
from pathlib import Path

from storage.netcdf import read_whole
from workflow.design.verdict import netcdf

RESULTS = Path("results")

_told: set[str] = set()  # by Snakemake's hook or by `meecontact run`, whichever comes first in this process


def lines(designs: Path) -> list[str]:
    """One line for each target of a ``design.nc`` that is not reachable; none where there is no such file.

    The answers themselves are beside it, in ``design/<target>.nc``.
    """
    if not designs.is_file():
        return []
    data = read_whole(designs)
    missed = data["target"].values[~data["feasible"].values.astype(bool)]
    answers = (netcdf.read(designs.parent / "design" / f"{name}.nc") for name in missed)
    return [f"target {answer.target}: not reachable: {answer.miss}" for answer in answers]


def leave(studies: Iterable[str]) -> None:
    """Leave it to another to tell of some studies."""
    _told.update(studies)


def tell(studies: Iterable[str], results: str | Path = RESULTS) -> None:
    """Print those of some studies' results, once in a process; none of those left to another."""
    for study in sorted(set(studies) - _told):
        _told.add(study)
        for line in lines(Path(results) / study / "design.nc"):
            print(line)
