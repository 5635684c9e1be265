"""Slabs of a study's data set: how many there are, and which files belong to none of them."""

import os
from collections.abc import Iterable
from pathlib import Path

from workflow.study.model import Study

#: What a job that solves a slab takes at most, whatever its size [MB].
MEMORY = 1500

#: Slabs of a study whose first axis is open, at most and if it does not say: `levels.choose` gives it as many levels.
MOST, USUAL = 8, 4

#: Entry of ``--config`` by which the planner tells its nodes the number of jobs at once, and their variable for it.
AT_ONCE, _PLANNER = "jobs_of_planner", "MEECONTACT_JOBS_OF_PLANNER"


def count(study: Study) -> int:
    """Number of slabs, at most one a level of the first axis: as requested, or what cores and memory allow."""
    if study.crossed:
        return study.dataset.slabs or max(1, _at_once())
    first = next(iter(study.axes.values()), None)
    if first is None:
        return 0
    if first.levels is None:  # its levels follow from the slabs, and must not from the machine
        return min(study.dataset.slabs or USUAL, MOST)
    return min(study.dataset.slabs or max(1, _at_once()), first.levels)


def _at_once() -> int:
    """Jobs that cores and memory of the machine that plans the run let run at once."""
    if planner := os.environ.get(_PLANNER):
        return int(planner)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    return min(len(os.sched_getaffinity(0)), memory // MEMORY)


def settle(entries: Iterable[str] | None, *, planner: bool) -> list[str]:
    """Entries of ``--config`` for the nodes of a run, with the jobs at once of its planner; nodes take them over."""
    if planner:
        return [*(entries or ()), f"{AT_ONCE}={_at_once()}"]
    counts = [entry.partition("=")[2] for entry in entries or () if entry.startswith(f"{AT_ONCE}=")]
    if counts:
        os.environ[_PLANNER] = counts[-1].strip("'\"")  # for the scripts of this node, which are processes of their own
    return list(entries or ())


def with_slabs(study: Study) -> Study:
    """The study with the number of its slabs: a slab of one machine's count is no slab of another's."""
    if not study.factors:
        return study
    return study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": count(study)})})


def orphans(study: Study, folder: Path) -> list[Path]:
    """Files in ``results/<study>`` that the study's data set no longer has: slabs beyond its count, chosen levels."""
    slabs = set() if study.crossed else {f"slab_{number}.nc" for number in range(count(study))}
    left = [file for file in sorted((folder / "fields").glob("slab_*.nc")) if file.name not in slabs]
    left += [] if study.crossed else sorted((folder / "cross").glob("*.nc"))
    return left if study.open else [*left, folder / "levels.nc"]
