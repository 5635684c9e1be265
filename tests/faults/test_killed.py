"""SIGKILL at random moments, of a job and of Snakemake: the next run finishes what is left, and nothing is lost."""

import random
import shutil
from collections.abc import Callable

import pytest

from tests.faults.conftest import NOT_COMPARED, RESULTS, contents
from tests.faults.processes import kill_within, start, wait_for_orphans
from tests.workflow.conftest import Project

Maker = Callable[[str], Project]


def survives(project: Project, expected: dict[str, bytes], kills: int, dice: random.Random) -> None:
    """Kill runs of one study in one folder, jobs and Snakemake in turn, and look at the files each time."""
    done = 0
    while done < kills:
        run = start(project, "tiny")
        if kill_within(project, run, "job" if done % 2 else "snakemake", dice):
            done += 1
        elif run.returncode == 0:  # it was quicker: begin again
            shutil.rmtree(project.folder / RESULTS)
        for name, content in contents(project).items():
            hidden = name.rpartition("/")[2].startswith(".")
            assert hidden or content == expected[name], f"{name} after {done} kills"
    finished = start(project, "tiny")
    assert finished.wait() == 0, (project.folder / "run.log").read_text(encoding="utf-8")[-4000:]
    wait_for_orphans(project)
    assert contents(project) == expected
    assert all((project.folder / RESULTS / name).is_file() for name in NOT_COMPARED)


def test_five_kills_lose_nothing(tiny: Maker, undisturbed: Project) -> None:
    survives(tiny("killed"), contents(undisturbed), 5, random.Random(5))


@pytest.mark.soak
def test_a_hundred_kills_lose_nothing(tiny: Maker, undisturbed: Project) -> None:
    survives(tiny("soaked"), contents(undisturbed), 100, random.Random(100))
