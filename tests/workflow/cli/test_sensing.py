"""``meecontact signal``: the page's example, and what it refuses in one line."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from tests.workflow.cli.test_main import complaint
from workflow.cli import main, sensing
from workflow.device import contact
from workflow.run.provenance import ROOT

PAGE = (ROOT / "docs/signal.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"(?:^    .+\n)+", PAGE, re.MULTILINE)
CASE = "profile=sphere,material=BaTiO3,radius=5 mm"
DEVICE = "input_capacitance=10 pF,input_resistance=1 GOhm"


def test_the_example_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(contact, "_COUNT", 5)  # contacts in air take long
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


def test_the_rows_of_an_oscilloscope_are_read_and_long_signals_thinned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    count = 10_001
    force = np.minimum(np.arange(count) / 1_000, 1) * 0.04  # V
    path, out = tmp_path / "scope.csv", tmp_path / "out.csv"
    path.write_text(
        "x-axis,1\nsecond,Volt\n" + "".join(f"{k * 1e-4:.4f},{value:.6f}\n" for k, value in enumerate(force))
    )
    arguments = ["signal", str(path), "--on", CASE, "--device", DEVICE, "--scale", "50 N/V", "-o", str(out)]
    assert main.main(arguments) == 0
    full = np.genfromtxt(out, delimiter=",", skip_header=1)
    coarse = tmp_path / "coarse.csv"
    coarse.write_text("time [s],force [N]\n0,0\n0.1,2\n1,2\n", encoding="utf-8")
    assert main.main([*arguments[:1], str(coarse), *arguments[2:6], "--parts", "10", "-o", str(out)]) == 0
    few = np.genfromtxt(out, delimiter=",", skip_header=1)
    np.testing.assert_allclose(
        np.interp(few[:, 0], full[:, 0], full[:, 3]), few[:, 3], atol=1e-6 * np.abs(few[:, 3]).max()
    )
    monkeypatch.setattr(sensing, "_MOST_WRITTEN", 500)
    assert main.main(arguments) == 0
    thinned = np.genfromtxt(out, delimiter=",", skip_header=1)
    assert len(thinned) < 600
    assert np.abs(thinned[:, 3]).max() == np.abs(full[:, 3]).max()
    assert "of 10001: in groups" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("history", "case", "device", "words"),
    [
        ("", CASE, DEVICE, "needs a header"),
        ("time [s],force\n0,0\n1,500\n", CASE, DEVICE, "500 has no unit, and 500 N press with"),
        ("time [s],CH1 [V]\n0,0\n1,1\n", CASE, DEVICE, "--scale 'NUMBER N/V'"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},resistivity=0", "resistivity: 0 is not a finite number > 0"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},resistivity=1,loss_tangent=1", "give one of them"),
        ("time,force\n0,0\n1,1\n", CASE, "input_resistance=1", "amplifier.input_capacitance: missing"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},electrode_length=1", "a point contact has none"),
        ("time,force\n0,0\n1,1\n", CASE, f"{DEVICE},cable=1", "cable: unknown key; did you mean 'cable_capacitance'?"),
        ("time,force\n0,0\n1,1\n", f"{CASE},radius=1", DEVICE, "given twice"),
        ("time,force\n0,0\n1,1\n", "profile=sphere,material=stel,radius=1", DEVICE, "did you mean 'steel'"),
        ("time,force\n0,0\n1,1\n", "profile=sphere,material=BaTiO3,radius=20", DEVICE, "did you mean 20 mm?"),
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
