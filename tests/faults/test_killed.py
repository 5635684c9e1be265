"""SIGKILL at random moments, of a job and of Snakemake: the next run finishes what is left, and nothing is lost."""

import random
import shutil
from collections.abc import Callable

import pytest

from tests.faults.conftest import NOT_COMPARED, RESULTS, contents
from tests.faults.processes import kill_within, start, wait_for_orphans
from tests.workflow.conftest import Project

Maker = Callable[[str], Project]


def survives(
    project: Project, expected: dict[str, bytes], kills: int, dice: random.Random, *files: str
) -> dict[str, bytes]:
    """Kill runs of one study in one folder, jobs and Snakemake in turn; look at the files each time, give the last."""
    done = 0
    while done < kills:
        run = start(project, "tiny", *files)
        if kill_within(project, run, "job" if done % 2 else "snakemake", dice):
            done += 1
        elif run.returncode == 0:  # it was quicker: begin again
            shutil.rmtree(project.folder / RESULTS)
        for name, content in contents(project).items():
            hidden = name.rpartition("/")[2].startswith(".")
            assert hidden or content == expected[name], f"{name} after {done} kills"
    finished = start(project, "tiny", *files)
    assert finished.wait() == 0, (project.folder / "run.log").read_text(encoding="utf-8")[-4000:]
    wait_for_orphans(project)
    return contents(project)


def test_five_kills_lose_nothing(tiny: Maker, undisturbed: Project) -> None:
    expected = contents(undisturbed)
    found = survives(tiny("killed"), expected, 5, random.Random(5), "surrogate.nc", "datacard.json")
    assert found.keys() >= {"surrogate.nc", "quantities.nc", "fields/slab_0.nc", "fields/slab_1.nc", "fields/slab_2.nc"}
    assert found.items() <= expected.items()


@pytest.mark.soak
def test_a_hundred_kills_lose_nothing(tiny: Maker, undisturbed: Project) -> None:
    project, expected = tiny("soaked"), contents(undisturbed)
    assert survives(project, expected, 100, random.Random(100)) == expected
    assert all((project.folder / RESULTS / name).is_file() for name in NOT_COMPARED)
