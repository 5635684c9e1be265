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


@pytest.fixture(scope="module")
def broken(grouped: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One of its files with a unit that is none, and a range of another type than the numbers."""
    folder = tmp_path_factory.mktemp("broken")
    with netCDF4.Dataset(shutil.copy(grouped / "fields/slab_0.nc", folder), "a") as file:
        file["voltage"].setncattr("units", "volts or so")
        file["contact_pressure"].setncattr("actual_range", [0.0, 1.0])
    return folder


@pytest.fixture(scope="module")
def said(ran: Project, grouped: Path, broken: Path) -> list[str]:
    """Return the lines of the referees on the three folders."""
    command = [str(PYTHON), str(ROOT / "tests/referees.py"), str(ran.folder / SMALL), str(grouped), str(broken)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr  # of the last
    return [line for line in done.stdout.splitlines() if "not installed" not in line]


def test_no_referee_finds_a_fault(said: list[str], ran: Project, grouped: Path) -> None:
    names = ("conventions", "foreign")
    expected = [f"{folder}: {name}: no faults" for folder in (ran.folder / SMALL, grouped) for name in names]
    assert said[: said.index(expected[-1]) + 1] == expected


def test_the_referees_do_find_faults(said: list[str], broken: Path) -> None:
    faults = "\n".join(said[said.index(f"{broken}: conventions: 3 faults") :])
    assert 'units for voltage, "volts or so" are not recognized by UDUNITS' in faults
    assert "Attribute 'actual_range' (type: <class 'numpy.float64'>) and parent variable 'contact_pressure'" in faults
