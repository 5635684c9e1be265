"""``meecontact export``: the quickstart's surrogate in a C program and as a unit for simulators."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import surrogate
from tests import programs
from tests.compiled import STRICT
from tests.surrogate import functions
from tests.workflow.conftest import Project
from workflow.run.provenance import ROOT

pytestmark = pytest.mark.needs("gcc")
OUTPUTS = ["voltage", "trailing_tension"]
ERROR = 1e-5
#: An environment with fmpy, a simulator of such units.
PYTHON = Path(sys.prefix) / "referees/bin/python"
FMPY = PYTHON.with_name("fmpy")


@pytest.fixture(scope="module")
def model(quickstart_run: Project) -> surrogate.GaussianProcess:
    return surrogate.load(quickstart_run.folder / "results/quickstart/surrogate.nc")


SIMULATE = """
import json, sys, fmpy, numpy as np
from fmpy.validation import validate_fmu
path, columns = sys.argv[1], json.loads(sys.argv[2])
faults = [str(fault) for fault in validate_fmu(path)]
times = np.arange(len(columns["load"]), dtype=float)
signals = np.array(list(zip(times, *columns.values())), dtype=[(name, float) for name in ("time", *columns)])
seen = fmpy.simulate_fmu(path, input=signals, output_interval=1.0, stop_time=times[-1], start_values={
    name: column[0] for name, column in columns.items()})
print(json.dumps({"faults": faults, **{name: seen[name].tolist() for name in seen.dtype.names}}))
"""


@pytest.mark.skipif(not FMPY.exists(), reason="no fmpy (`make referees` installs it)")
def test_a_simulator_runs_the_unit(quickstart_run: Project, model: surrogate.GaussianProcess, tmp_path: Path) -> None:
    points = functions.inside(model.inputs_, 1000, 7, 1.1)
    unit = tmp_path / "contact.fmu"
    command = ["export", "results/quickstart", "--as", "fmu", "--outputs", ",".join(OUTPUTS), "-o", str(unit)]
    quickstart_run.run("meecontact", *command)
    few = points[:20].copy()
    few[[7, 11], 0] = 0.99, 0.01  # outside
    columns = json.dumps({name: few[:, k].tolist() for k, name in enumerate(model.box)})
    done = subprocess.run([PYTHON, "-c", SIMULATE, unit, columns], capture_output=True, text=True, check=True)
    seen = {name: np.array(values) for name, values in json.loads(done.stdout.splitlines()[-1]).items()}
    assert not seen.pop("faults").size
    few = few[np.arange(len(few)).clip(1) - 1]  # outputs after a step are those of the inputs at its begin
    inside = model.has_answers(few)
    assert inside.sum() == 18
    np.testing.assert_array_equal(seen["status"], np.where(inside, 0, 1))
    for name in OUTPUTS:
        single = model.only([name])
        room = ERROR * float(np.ptp(single.predict_array(points)))
        assert np.isnan(seen[name][~inside]).all()
        assert np.abs(seen[name][inside] - single.predict_array(few[inside])[:, 0]).max() <= room
        assert (seen[f"{name}_lower"][inside] <= seen[name][inside]).all()


def test_the_example_finds_its_load(quickstart_run: Project, model: surrogate.GaussianProcess, tmp_path: Path) -> None:
    command = ["export", "results/quickstart", "--as", "c", "--outputs", "voltage", "-o", f"{tmp_path}/sensor.c"]
    written = quickstart_run.run("meecontact", *command).stderr
    assert "1 outputs in" in written
    assert "of the range at most" in written
    shutil.copy(ROOT / "examples/force.c", tmp_path)
    binary = tmp_path / "force"
    flags = [*STRICT, "force.c", "sensor.c", "-lm", "-o", str(binary)]
    subprocess.run([programs.path("gcc"), *flags], cwd=tmp_path, check=True)
    voltage = float(model.only(["voltage"]).predict_array(np.array([[0.67, 0.2, 0.12, 2e4, 0.0]]))[0, 0])
    for said, warm in ((voltage, 25), (voltage * (1 - 1.5e-3 * 20), 45)):
        done = subprocess.run([binary, repr(said), str(warm)], capture_output=True, text=True, check=True)
        load, lower, upper = map(float, re.findall(r"\d+\.\d", done.stdout))
        assert load == pytest.approx(2e4, abs=20)
        assert lower < 2e4 < upper
    for wrong in ("1e9", "nan"):
        assert subprocess.run([binary, wrong, "25"], capture_output=True, check=False).returncode == 1
