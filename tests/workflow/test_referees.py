"""Public referees find no fault in the files of a run and of groups in single precision; and they do find faults."""

import shutil
import subprocess
import sys
from pathlib import Path

import netCDF4
import pytest

import surrogate
from storage.netcdf import read_whole
from tests.studies import data_set, made
from tests.workflow.conftest import Project
from workflow.learning import training
from workflow.run.provenance import ROOT

PYTHON = Path(sys.prefix) / "referees/bin/python"
SMALL = "results/small"
pytestmark = pytest.mark.skipif(not PYTHON.exists(), reason="no referees (`make referees` installs them)")

GROUPED = """\
title: Half-planes in groups
fixed: {composite: fibrous, volume_fraction: 0.4, friction: 0.2, datum: 0.5}
factors:
  radius: {low: 0.03, high: 0.1, scale: log}
  load: {low: 2e4, high: 5e4, scale: log}
  charge: {low: -1e-6, high: 2e-6}
groups:
  load * radius / datum^2: {levels: 4}
  charge / load: {levels: 3}
dataset: {precision: float32, slabs: 1, positions: {inside: 4, outside: 2}}
"""


@pytest.fixture(scope="module")
def grouped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the files of a study in groups, without its page."""
    folder = tmp_path_factory.mktemp("grouped")
    study = made(GROUPED)
    data_set(study, folder)
    surrogate.save(training.fit(study, read_whole(folder / "quantities.nc")), folder / "surrogate.nc")
    return folder


def test_referees_find_no_fault_and_the_faults_of_a_broken_file(ran: Project, grouped: Path, tmp_path: Path) -> None:
    with netCDF4.Dataset(shutil.copy(grouped / "fields/slab_0.nc", tmp_path), "a") as file:
        file["voltage"].setncattr("units", "volts or so")
        file["contact_pressure"].setncattr("actual_range", [0.0, 1.0])  # of another type than the numbers
    folders = [ran.folder / SMALL, grouped, tmp_path]
    command = [PYTHON, ROOT / "tests/referees.py", *folders]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    lines = [line for line in done.stdout.splitlines() if "not installed" not in line]
    sound = [f"{folder}: {name}: no faults" for folder in folders[:2] for name in ("conventions", "foreign")]
    assert lines[: len(sound)] == sound
    assert f"{tmp_path}: conventions: 3 faults" in lines
    faults = "\n".join(lines[len(sound) :])
    assert 'units for voltage, "volts or so" are not recognized by UDUNITS' in faults
    assert "Attribute 'actual_range' (type: <class 'numpy.float64'>) and parent variable 'contact_pressure'" in faults
