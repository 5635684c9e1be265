"""How the tests share a machine: one thread a process, and what takes long is made once, by one worker.

A worker takes a whole file at a time, so that module fixtures are made once, and all the files that look at the same
run of a pipeline: `--dist loadgroup` would say so in marks, but pytest-xdist 3.8 loses them under pytest 9.2, whose
node ids cannot be written to.
"""

import contextlib
import functools
import os
import re
import sys
from collections import Counter
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any

import pytest

# before anything loads NumPy, and inherited by workers and jobs: threads of BLAS spin for each other's cores, and many
# small products (an inversion's) take four times as long on two threads as on one
os.environ.setdefault("OMP_NUM_THREADS", "1")

from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

from storage import quarantine
from tests import layers, programs
from tests.workflow.conftest import Copy, Project, copy
from workflow.run.provenance import ROOT
from workflow.study import model

__all__ = ["copy"]

# an example takes as long as a busy machine needs
settings.register_profile("patient", deadline=None)
settings.load_profile("patient")
# nor does it say that a study's check takes long, where a test asks for one line
model.SILENCE = 3600.0
# a file is looked at by a fork, as in a job, although pytest-xdist has a thread, which does nothing meanwhile: a new
# interpreter takes four times as long; both ways are tried by tests/faults/test_hostile.py
quarantine._has_one_thread = lambda: True

#: Session fixtures that run a pipeline: all files that look at one of them are one worker's.
RUNS = ("ran", "undisturbed", "quickstart_run")

#: What takes longest begins first, so that the last groups to end are short.
LONGEST = (
    "tests/faults/test_hostile.py",  # first: it bounds the memory of its process, which no other test may have taken
    *RUNS,
    "tests/test_tutorials.py",
    "tests/workflow/design/test_costly.py",
    "tests/surrogate/use/test_inversion.py",
    "tests/workflow/design/test_question.py",
)


@functools.cache
def group(file: str) -> str:
    """Return the run that a file looks at, else the file itself."""
    text = (ROOT / file).read_text(encoding="utf-8")
    return next((run for run in RUNS if re.search(rf"\b{run}: Project\b", text)), file)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """One worker more than there are cores: what waits for the programs that it starts leaves a core idle."""
    return (os.cpu_count() or 1) + 1


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Hand out groups in the place of xdist's files; another `--dist` stays what it is."""
    if config.getvalue("dist") != "loadfile":
        return None
    scheduler = LoadScopeScheduling(config, log)
    scheduler._split_scope = lambda nodeid: group(nodeid.partition("::")[0])
    return scheduler


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """A run of the layer ``unit`` imports no file of another layer."""
    file = collection_path.relative_to(config.rootpath).as_posix()
    units = config.option.markexpr.startswith("unit")
    return True if units and file.endswith(".py") and layers.layer(file, (), ()) != "unit" else None


@pytest.hookimpl(tryfirst=True)  # before marks select
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark each test with its layer, and bring the longest groups to the front."""
    layers.leave_to_soak(items)
    for item in items:
        names = {name for mark in item.iter_markers("needs") for name in mark.args}
        if reason := programs.missing(sorted(names)):
            item.add_marker(pytest.mark.skip(reason=reason))
        fixtures = set(getattr(item, "fixturenames", ()))
        item.add_marker(layers.layer(item.location[0], [mark.name for mark in item.iter_markers()], fixtures))
    order = [*LONGEST, ""]
    items.sort(key=lambda item: order.index(name if (name := group(item.location[0])) in LONGEST else ""))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """End with one line on what was not run, and on how to get it."""
    reports = terminalreporter.stats.get("skipped", [])
    counts = Counter(report.longrepr[2].removeprefix("Skipped: ") for report in reports)
    parts = [f"{count} test{'s' * (count > 1)}: {reason}" for reason, count in counts.items()]
    terminalreporter.write_line(f"not run: {'; '.join(parts)}" if parts else "nothing was left out")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, Any, Any]:
    """A test of the layer ``unit`` starts no program."""
    with layers.without_programs() if item.get_closest_marker("unit") else contextlib.nullcontext():
        return (yield)


@pytest.fixture(autouse=True)
def _figures_are_closed() -> Iterator[None]:
    """What a test draws and does not write stays with no later one."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.fixture(scope="session")
def quickstart_run(copy: Copy) -> Project:
    """A folder in which the quickstart has run to its report without any fault; look, and change nothing."""
    project = copy("quickstart")
    project.run("meecontact", "run", "quickstart", "--cores", "2")
    return project
