"""Share a machine among the tests: one thread a process, and each long run is made once, by one worker.

A worker takes a whole file at a time, and all the files that look at the same run of a pipeline. `--dist loadgroup`
would do this by marks, but pytest-xdist 3.8 loses them under pytest 9.2.
"""

import functools
import os
import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

# before NumPy is loaded, and inherited by workers and jobs: threads of BLAS spin for each other's cores
os.environ.setdefault("OMP_NUM_THREADS", "1")

from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

from storage import quarantine
from tests import layers, programs
from tests.workflow.conftest import Copy, Project, copy
from workflow.run.provenance import ROOT
from workflow.study import model

__all__ = ["copy"]

settings.register_profile("patient", deadline=None)  # an example takes as long as a busy machine needs
settings.load_profile("patient")
model.SILENCE = 3600.0  # a study's check on a busy machine prints no line that it takes long
# as in a job a fork inspects a file, although pytest-xdist has a second thread: a new interpreter takes four times as
# long; tests/faults/test_hostile.py tries both ways
quarantine._has_one_thread = lambda: True

#: The longest groups begin first.
LONGEST = (
    "tests/faults/test_hostile.py",  # it bounds the memory of its process, which no other test may have used
    *layers.RUNS,
    "tests/test_tutorials.py",
    "tests/verification/test_verification.py",
    "tests/workflow/design/test_costly.py",
    "tests/surrogate/use/test_inversion.py",
    "tests/workflow/design/test_question.py",
)


@functools.cache
def group(file: str) -> str:
    """Return the run that a file uses, else the file itself."""
    text = (ROOT / file).read_text(encoding="utf-8")
    return next((run for run in layers.RUNS if re.search(rf"\b{run}: Project\b", text)), file)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Return one worker more than there are cores: one that waits for a program leaves a core idle."""
    return (os.cpu_count() or 1) + 1


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Hand out groups in place of files, unless another `--dist` is chosen."""
    if config.getvalue("dist") != "loadfile":
        return None
    scheduler = LoadScopeScheduling(config, log)
    scheduler._split_scope = lambda nodeid: group(nodeid.partition("::")[0])
    return scheduler


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Import no slow file for `make check`."""
    file = collection_path.relative_to(config.rootpath).as_posix()
    return True if config.option.markexpr.startswith("not slow") and layers.slow(file) else None


@pytest.hookimpl(tryfirst=True)  # before marks select
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark slow tests and those that lack a program, and bring the longest groups to the front."""
    layers.leave_to_soak(items)
    for item in items:
        names = {name for mark in item.iter_markers("needs") for name in mark.args}
        if reason := programs.missing(sorted(names)):
            item.add_marker(pytest.mark.skip(reason=reason))
        if layers.slow(item.location[0], getattr(item, "fixturenames", ())):
            item.add_marker("slow")
    order = [*LONGEST, ""]
    items.sort(key=lambda item: order.index(name if (name := group(item.location[0])) in LONGEST else ""))


@pytest.fixture(autouse=True)
def _figures_are_closed() -> Iterator[None]:
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.fixture
def command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> programs.Command:
    """The command line, with files in the test's folder."""
    return programs.Command(tmp_path, capsys)


@pytest.fixture(scope="session")
def quickstart_run(copy: Copy) -> Project:
    """Folder in which the quickstart has run to its report, or what `make run` left of it; no test may change it."""
    project = copy("quickstart")
    for part in ("results/quickstart", "results/ball", ".snakemake/metadata"):
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, project.folder / part, symlinks=True)
    project.run("meecontact", "run", "quickstart", "--cores", "2")
    return project
