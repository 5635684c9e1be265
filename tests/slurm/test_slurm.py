"""The quickstart through a real Slurm: every data file has the bytes of a local run. `make slurm`."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.faults.conftest import contents
from tests.slurm.one_node import cluster, missing
from tests.workflow.conftest import Copy, Project, copy
from workflow.run.provenance import ROOT

__all__ = ["copy"]

pytestmark = pytest.mark.slurm


@pytest.mark.skipif(bool(missing()), reason=missing() or "Slurm can be started")
def test_slurm_and_a_local_run_give_the_same_bytes(copy: Copy, tmp_path: Path) -> None:
    local, remote = Project(ROOT), copy("remote")
    local.run("meecontact", "run", "quickstart")  # nothing where `make run` has done it
    expected = contents(local, "quickstart")
    for part in ("results/ball", ".snakemake/metadata"):  # the study that opens the page: jobs of the same kinds
        shutil.copytree(ROOT / part, remote.folder / part)
    with cluster(tmp_path / "slurm"):
        remote.run("meecontact", "run", "quickstart", "--profile", "slurm", cold=True)
        jobs = subprocess.run(["scontrol", "-o", "show", "jobs"], capture_output=True, text=True, check=True).stdout
    assert jobs.count("JobState=COMPLETED") > 8  # it did go there
    assert len(expected) > 12
    assert contents(remote, "quickstart") == expected
