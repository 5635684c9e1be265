"""``meecontact signal``: the page's example, and what it refuses in one line."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from tests.workflow.cli.test_main import complaint
from workflow.cli import main
from workflow.run.provenance import ROOT

PAGE = (ROOT / "docs/signal.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"(?:^    .+\n)+", PAGE, re.MULTILINE)
CASE = "profile=sphere,material=BaTiO3,radius=5 mm"
DEVICE = "input_capacitance=10 pF,input_resistance=1 GOhm"


def test_the_example_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "history.csv").write_text(BLOCKS[0].replace("    ", ""), encoding="utf-8")
    program, *words = shlex.split(BLOCKS[1])
    assert program == "meecontact"
    assert main.main(words) == 0
    lines = capsys.readouterr().out.splitlines()
    table = np.genfromtxt("signal.csv", delimiter=",", skip_header=1)
    assert table.shape == (41, 5)
    peak = table[np.abs(table[:, 3]).argmax(), 3]
    assert table[10, 3] == peak < 0  # at the end of pressing; positive charge at zero volts
    assert table[-1, 4] == table[-1, 3]  # a voltage amplifier's output is the voltage
    assert lines[0].startswith("peak voltage of the punch: ")
    assert any("a constant force decays with the time constant" in line and "after 10 s" in line for line in lines)
    assert any(line.startswith("noise floor: ") for line in lines)


@pytest.mark.parametrize(
    ("history", "case", "device", "words"),
    [
        ("", CASE, DEVICE, "needs a header"),
        ("time [s],force [N]\n", CASE, DEVICE, "needs a header"),
        ("time [s],force [N]\n0,0\n", CASE, DEVICE, "1 rows; a history has 2 to 2000"),
        ("time [s],force [N]\n0,0\n2,1\n1,0\n", CASE, DEVICE, "line 4: time: 1 is not after 2"),
        ("time [s],force [N]\n0,0\n1,-1\n", CASE, DEVICE, "line 3: force: -1 is not"),
        ("time [s],force [N]\n0,0\n1,nan\n", CASE, DEVICE, "line 3: force: nan is not"),
        ("time [s],force [N]\n0,0\n1,\n", CASE, DEVICE, "line 3: force: empty"),
        ("time [s],force [N]\n0,0\n1,0\n", CASE, DEVICE, "is 0 all the time"),
        ("time [m],force [N]\n0,0\n1,1\n", CASE, DEVICE, "unit mismatch"),
        ("time [s],load\n0,0\n1,1\n", CASE, DEVICE, "force: missing"),
        ("time [s],force,load\n0,0,0\n1,1,1\n", CASE, DEVICE, "load: a history has time [s] and force alone"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},resistivity=0", "resistivity: 0 is not a finite number > 0"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},resistivity=1,loss_tangent=1", "give one of them"),
        ("time,force\n0,0\n1,1\n", CASE, "input_resistance=1", "amplifier.input_capacitance: missing"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},electrode_length=1", "a point contact has none"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},cable=1", "cable: unknown key"),
        ("time,force\n0,0\n1,1\n", f"{CASE},radius=1", DEVICE, "given twice"),
        ("time,force\n0,0\n1,1\n", "profile=sphere,material=stel,radius=1", DEVICE, "did you mean 'steel'"),
        ("time,force\n0,0\n1,1\n", "material=BaTiO3,radius=1", DEVICE, "electrode_length: missing"),
    ],
)
def test_bad_input_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], history: str, case: str, device: str, words: str
) -> None:
    path, out = tmp_path / "history.csv", tmp_path / "out.csv"
    path.write_text(history, encoding="utf-8")
    assert words in complaint(capsys, "signal", path, "--on", case, "--device", device, "-o", out)
    assert not out.exists()
