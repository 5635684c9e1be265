"""Every script runs alone, on the files that are there: what it makes is what its job has made."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import warm
from tests.workflow.conftest import Project
from workflow.run.provenance import ROOT


@pytest.mark.parametrize(
    ("script", "file"),
    [("training.py", "surrogate.nc"), ("figure.py", "figures/decay.svg"), ("slab.py", "fields/slab_1.nc")],
)
def test_a_script_alone_makes_what_its_job_makes(ran: Project, tmp_path: Path, script: str, file: str) -> None:
    output = tmp_path / "results/small" / file
    for folder in ("config", "results"):
        shutil.copytree(ran.folder / folder, tmp_path / folder)
    output.unlink()
    done = warm.run(["python", str(ROOT / "workflow/scripts" / script), f"results/small/{file}"], tmp_path, ROOT)
    assert done.returncode == 0, done.stderr
    assert output.read_bytes() == (ran.folder / "results/small" / file).read_bytes()
    assert not (tmp_path / ".snakemake").exists()
    assert not (tmp_path / "logs").exists()


@pytest.mark.slow
def test_a_file_that_the_script_does_not_make_is_refused_in_one_line(tmp_path: Path) -> None:
    alone = [sys.executable, str(ROOT / "workflow/scripts/slab.py"), "results/small/surrogate.nc"]
    done = subprocess.run(alone, cwd=tmp_path, check=False, capture_output=True, text=True)
    message = "slab.py: 'results/small/surrogate.nc' is not one of results/{study}/fields/slab_{slab}.nc\n"
    assert (done.returncode, done.stderr) == (1, message)
