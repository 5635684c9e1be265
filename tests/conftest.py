"""How the tests share a machine: one thread a process, and what takes long is made once, by one worker.

Under `--dist loadgroup` a worker takes a whole group at a time, in the order of collection: the tests of a costly
session fixture, else those of a file, so that module fixtures are made once too. The longest groups begin first.
"""

import os
from collections.abc import Callable

import pytest

# before anything loads NumPy, and inherited by workers and jobs: threads of BLAS spin for each other's cores, and many
# small products (an inversion's) take four times as long on two threads as on one
os.environ.setdefault("OMP_NUM_THREADS", "1")

from tests.workflow.conftest import Project, copy

__all__ = ["copy"]

#: Fixtures that run a whole pipeline, and the group of the tests that use them.
RUNS = {"ran": "ran", "again": "ran", "undisturbed": "undisturbed", "quickstart": "quickstart"}

#: The groups that take longest, those of the runs among them, the longest first.
LONGEST = (
    "ran",
    "undisturbed",
    "quickstart",
    "tests/workflow/design/test_budget.py",
    "tests/surrogate/use/test_inversion.py",
    "tests/workflow/report/test_page.py",
    "tests/workflow/test_pipeline.py",
    "tests/faults/test_hostile.py",
)


@pytest.hookimpl(tryfirst=True)  # before xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Name the group of every test, and bring the longest groups to the front."""
    for item in items:
        fixtures = getattr(item, "fixturenames", ())
        group = next((group for name, group in RUNS.items() if name in fixtures), item.location[0])
        item.add_marker(pytest.mark.xdist_group(group))
    items.sort(key=_rank)


def _rank(item: pytest.Item) -> int:
    marker = item.get_closest_marker("xdist_group")
    group = marker.args[0] if marker else ""
    return LONGEST.index(group) if group in LONGEST else len(LONGEST)


@pytest.fixture(scope="session")
def quickstart(copy: Callable[[str], Project]) -> Project:
    """A copy in which the quickstart has run to its report without any fault; look, and change nothing."""
    project = copy("quickstart")
    project.run("meecontact", "run", "quickstart", "--cores", "2")
    return project
