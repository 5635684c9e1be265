"""One thread a process, and the same digits on every kernel: how commands and jobs share a machine."""

import os
import subprocess
import sys

import pytest

from tests import kernels
from workflow.run.provenance import ROOT

pytestmark = pytest.mark.process


def test_kernels_of_this_processor_are_found_for_rooms_that_exist() -> None:
    assert all((ROOT / room).exists() for room in (*kernels.QUICK, *kernels.ALL))
    assert set() < {*kernels.distinct()} <= {*kernels.KERNELS}


def test_the_command_takes_one_thread_and_so_does_every_job() -> None:
    """A job by Snakemake, which gives a script as many as its rule says: one, but for a check that is timed alone."""
    code = (
        "import workflow.cli, numpy; from threadpoolctl import threadpool_info; "
        "print(max(library['num_threads'] for library in threadpool_info()))"
    )
    plain = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    plain |= {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}  # of the user, who gets the same digits
    done = subprocess.run([sys.executable, "-c", code], env=plain, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1"
    threaded = [file.name for file in (ROOT / "workflow/rules").glob("*.smk") if "threads:" in file.read_text("utf-8")]
    assert threaded == ["verification.smk"]
