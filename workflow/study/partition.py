"""Slabs of a study's data set: their number, and files that belong to none of them."""

import os
from collections.abc import Iterable
from pathlib import Path

from workflow.study.model import Study

#: Most memory of a job that solves a slab of any size [MB].
MEMORY = 1500

#: Slabs of a study whose first axis is open, at most and by default: `levels.choose` gives it as many levels.
MOST, USUAL = 8, 4

#: Entry of ``--config`` with the planner's number of jobs at once, and the nodes' environment variable for it.
AT_ONCE, _PLANNER = "jobs_of_planner", "MEECONTACT_JOBS_OF_PLANNER"


def count(study: Study) -> int:
    """Return the number of slabs, at most one a level of the first axis: as requested, or as cores and memory allow."""
    if study.crossed:
        return study.dataset.slabs or max(1, _at_once())
    first = next(iter(study.axes.values()), None)
    if first is None:
        return 0
    if first.levels is None:  # its levels follow from the slabs, and must not from the machine
        return min(study.dataset.slabs or USUAL, MOST)
    return min(study.dataset.slabs or max(1, _at_once()), first.levels)


def _at_once() -> int:
    """Return the number of jobs that cores and memory of the planning machine allow at once."""
    if planner := os.environ.get(_PLANNER):
        return int(planner)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    return min(len(os.sched_getaffinity(0)), memory // MEMORY)


def settle(entries: Iterable[str] | None, *, planner: bool) -> list[str]:
    """Return the entries of ``--config`` for the nodes of a run, with the planner's number of jobs at once."""
    if planner:
        return [*(entries or ()), f"{AT_ONCE}={_at_once()}"]
    counts = [entry.partition("=")[2] for entry in entries or () if entry.startswith(f"{AT_ONCE}=")]
    if counts:
        os.environ[_PLANNER] = counts[-1].strip("'\"")  # for the scripts of this node, which are processes of their own
    return list(entries or ())


def with_slabs(study: Study) -> Study:
    """Return the study with the number of its slabs, which must not depend on a node."""
    if not study.factors:
        return study
    return study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": count(study)})})


def orphans(study: Study, folder: Path) -> list[Path]:
    """Return files in ``results/<study>`` that the study's data set no longer has: slabs beyond its count, levels."""
    slabs = set() if study.crossed else {f"slab_{number}.nc" for number in range(count(study))}
    files = [file for file in sorted((folder / "fields").glob("slab_*.nc")) if file.name not in slabs]
    files += [] if study.crossed else sorted((folder / "cross").glob("*.nc"))
    return files if study.open else [*files, folder / "levels.nc"]
