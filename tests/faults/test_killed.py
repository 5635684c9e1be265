"""SIGKILL at random moments, of a job and of Snakemake: the next run finishes what is left, and nothing is lost."""

import random
import shutil
from collections.abc import Callable

import pytest

from tests.faults.conftest import NOT_COMPARED, contents
from tests.faults.processes import kill_within, start, wait_for_orphans
from tests.workflow.conftest import Copy, Project


def survives(
    project: Project,
    study: str,
    expected: dict[str, bytes],
    kills: int,
    dice: random.Random,
    *files: str,
    cold: bool = False,
) -> dict[str, bytes]:
    """Kill runs of one study in one folder, jobs and Snakemake in turn; look at the files each time, give the last.

    Runs are whole, or for some files; forks of a warm process, or cold.
    """
    done = 0
    while done < kills:
        run = start(project, study, *files, cold=cold)
        if kill_within(run, "job" if done % 2 else "snakemake", dice):
            done += 1
        elif run.returncode == 0:  # it was quicker: begin again
            shutil.rmtree(project.folder / "results")
        for name, content in contents(project, study).items():
            hidden = name.rpartition("/")[2].startswith(".")
            assert hidden or content == expected[name], f"{name} after {done} kills"
    finished = start(project, study, *files, cold=cold)
    assert finished.wait() == 0, (project.folder / "run.log").read_text(encoding="utf-8")[-4000:]
    wait_for_orphans(project)
    return contents(project, study)


def test_kills_lose_nothing(tiny: Callable[[str], Project], undisturbed: Project) -> None:
    project, expected = tiny("killed"), contents(undisturbed)
    left = survives(project, "tiny", expected, 2, random.Random(3), "validation.nc")  # Snakemake, then a job
    assert {"quantities.nc", "surrogate.nc", "validation.nc"} <= left.keys()
    assert left.items() <= expected.items()


@pytest.mark.soak
def test_a_hundred_kills_lose_nothing_of_the_quickstart(copy: Copy) -> None:
    undisturbed = copy("quickstart")
    undisturbed.run("meecontact", "run", "quickstart", "--cores", "2")
    expected = contents(undisturbed, "quickstart")
    killed = copy("killed")
    assert survives(killed, "quickstart", expected, 100, random.Random(100), cold=True) == expected
    assert all((killed.folder / "results/quickstart" / name).is_file() for name in NOT_COMPARED)
