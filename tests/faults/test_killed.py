"""SIGKILL at random moments, of a job and of Snakemake: the next run finishes what is left, and nothing is lost."""

import os
import random
import shutil
from collections.abc import Callable

import pytest

from tests.faults.conftest import NOT_COMPARED, contents
from tests.faults.processes import kill_within, start, wait_for_orphans
from tests.workflow.conftest import Project

STUDY = "quickstart"


def survives(project: Project, expected: dict[str, bytes], kills: int, dice: random.Random) -> dict[str, bytes]:
    """Kill runs of one study in one folder, jobs and Snakemake in turn; look at the files each time, give the last."""
    done = 0
    while done < kills:
        run = start(project, STUDY)
        if kill_within(project, run, "job" if done % 2 else "snakemake", dice):
            done += 1
        elif run.returncode == 0:  # it was quicker: begin again
            shutil.rmtree(project.folder / "results")
        for name, content in contents(project, STUDY).items():
            hidden = name.rpartition("/")[2].startswith(".")
            assert hidden or content == expected[name], f"{name} after {done} kills"
    finished = start(project, STUDY)
    assert finished.wait() == 0, (project.folder / "run.log").read_text(encoding="utf-8")[-4000:]
    wait_for_orphans(project)
    return contents(project, STUDY)


@pytest.mark.soakable
def test_kills_lose_nothing(copy: Callable[[str], Project], quickstart_run: Project) -> None:
    kills = 100 if os.environ.get("MEECONTACT_SOAK") else 5
    project, expected = copy("killed"), contents(quickstart_run, STUDY)
    assert survives(project, expected, kills, random.Random(kills)) == expected
    assert all((project.folder / "results" / STUDY / name).is_file() for name in NOT_COMPARED)
