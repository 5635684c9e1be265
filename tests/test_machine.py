"""Tests on a machine that others share, or that lacks a tool: no clock decides, and what is left out is told."""

import os
import subprocess
import sys
from types import SimpleNamespace
from typing import Any, cast

import pytest
from hypothesis import settings

from tests import conftest, kernels
from tests.closing import closing
from workflow.run.provenance import ROOT


def test_no_example_of_a_property_has_a_deadline() -> None:
    assert settings.default is not None
    assert settings.default.deadline is None


def test_the_last_line_says_what_was_not_run_and_how_to_get_it() -> None:
    assert closing([]) == "nothing was left out"
    said: list[str] = []
    skipped = [SimpleNamespace(longrepr=("a.py", 1, f"Skipped: no {tool}")) for tool in ("x (Debian: x)", "y", "y")]
    conftest.pytest_terminal_summary(cast(Any, SimpleNamespace(stats={"skipped": skipped}, write_line=said.append)))
    assert said == ["not run: 1 test: no x (Debian: x); 2 tests: no y"]


@pytest.mark.process
def test_kernels_that_differ_are_run_and_the_others_told() -> None:
    assert all((ROOT / room).exists() for room in (*kernels.QUICK, *kernels.ALL))
    run, left = kernels.distinct()
    assert run
    assert len(run) + len(left) == len(kernels.KERNELS)


@pytest.mark.process
def test_the_command_takes_one_thread_and_so_does_every_job() -> None:
    """A job by Snakemake, which gives a script as many as its rule says: one, but for a check that is timed alone."""
    code = (
        "import workflow.cli, numpy; from threadpoolctl import threadpool_info; "
        "print(max(one['num_threads'] for one in threadpool_info()))"
    )
    plain = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    plain |= {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}  # of the user, who gets the same digits
    done = subprocess.run([sys.executable, "-c", code], env=plain, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1"
    saying = [file.name for file in (ROOT / "workflow/rules").glob("*.smk") if "threads:" in file.read_text("utf-8")]
    assert saying == ["verification.smk"]
