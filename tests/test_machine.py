"""How commands, jobs and installations share a machine: one thread a process, one installation at a time."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from workflow.run.provenance import ROOT


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


PYTHON = """\
#!/bin/sh
case "$*" in
  *"-m venv"*)
    for folder; do :; done
    mkdir -p "$folder/bin"
    cp "$0" "$folder/bin/python"
    [ ! -e "{folder}/lacks_venv" ] ;;
  *"import pip"*) [ ! -e "{folder}/lacks_pip" ] ;;
  *"-m pip"*)
    mkdir "{folder}/installing" || echo overlap >>"{folder}/log"
    echo "$*" >>"{folder}/log"
    sleep 0.1
    rmdir "{folder}/installing" ;;
esac
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder, with a blank in its path, that holds the Makefile, the pins and the false Python."""
    folder = tmp_path / "a checkout"
    folder.mkdir()
    for name in ("Makefile", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    shutil.copytree(ROOT / "requirements", folder / "requirements")
    python = folder / "python"
    python.write_text(PYTHON.format(folder=folder), encoding="utf-8")
    python.chmod(0o755)
    return folder


def make(folder: Path, *targets: str) -> subprocess.CompletedProcess[str]:
    command = ["make", "-j4", "PYTHON=./python", *targets]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_installations_into_one_environment_do_not_overlap(folder: Path) -> None:
    done = make(folder, ".venv/run.stamp", ".venv/dev.stamp")
    assert done.returncode == 0, done.stderr
    lines = (folder / "log").read_text(encoding="utf-8").splitlines()
    assert "overlap" not in lines
    assert sum("requirements/" in line for line in lines) == 2


@pytest.mark.parametrize("fault", ["lacks_venv", "lacks_pip"])
def test_half_an_environment_is_named_and_mended_by_the_next_make(folder: Path, fault: str) -> None:
    (folder / fault).touch()
    broken = make(folder, ".venv/run.stamp")
    assert broken.returncode == 2
    assert "python3-venv" in broken.stdout
    assert not (folder / "log").exists()
    (folder / fault).unlink()
    assert make(folder, ".venv/run.stamp").returncode == 0
    assert (folder / ".venv/run.stamp").exists()
