"""``meecontact signal``: the page's example, and what it refuses in one line."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from tests.programs import Command
from workflow.cli import sensing
from workflow.cli.sensing import read_history
from workflow.device import contact
from workflow.run.provenance import ROOT

PAGE = (ROOT / "docs/signal.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"(?:^    .+\n)+", PAGE, re.MULTILINE)
CASE = "profile=sphere,material=BaTiO3,radius=5 mm"
DEVICE = "input_capacitance=10 pF,input_resistance=1 GOhm"


def test_the_page_s_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(contact, "_COUNT", 5)  # contacts in air take long
    command.file("history.csv", BLOCKS[0].replace("    ", ""))
    program, *words = shlex.split(BLOCKS[1])
    assert program == "meecontact"
    lines = command(*words)[0].splitlines()
    table = np.genfromtxt("signal.csv", delimiter=",", skip_header=1)
    assert table.shape == (41, 5)
    peak = table[np.abs(table[:, 3]).argmax(), 3]
    assert table[10, 3] == peak < 0  # at the end of pressing; positive charge at zero volts
    assert table[-1, 4] == table[-1, 3]  # a voltage amplifier's output is the voltage
    assert lines[0].startswith("peak voltage of the punch: ")
    assert any("a constant force decays with the time constant" in line and "after 10 s" in line for line in lines)
    assert any(line.startswith("noise floor: ") for line in lines)


def test_long_signals_are_thinned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    count = 10_001
    force = np.minimum(np.arange(count) / 1_000, 1) * 2  # N
    rows, out = "".join(f"{k * 1e-4:.4f},{value:.6f}\n" for k, value in enumerate(force)), tmp_path / "out.csv"
    path = command.file("long.csv", f"time [s],force [N]\n{rows}")
    options: list[str | Path] = ["--on", CASE, "--device", DEVICE, "-o", out]
    command("signal", path, *options)
    full = np.genfromtxt(out, delimiter=",", skip_header=1)
    command("signal", command.file("coarse.csv", "time [s],force [N]\n0,0\n0.1,2\n1,2\n"), *options, "--parts", "10")
    few = np.genfromtxt(out, delimiter=",", skip_header=1)
    np.testing.assert_allclose(
        np.interp(few[:, 0], full[:, 0], full[:, 3]), few[:, 3], atol=1e-6 * np.abs(few[:, 3]).max()
    )
    monkeypatch.setattr(sensing, "_MOST_WRITTEN", 500)
    assert "of 10001: in groups" in command("signal", path, *options)[1]
    thinned = np.genfromtxt(out, delimiter=",", skip_header=1)
    assert len(thinned) < 600
    assert np.abs(thinned[:, 3]).max() == np.abs(full[:, 3]).max()


@pytest.mark.parametrize(
    ("text", "length", "forces"),
    [
        ("time [s],force [N]\n0,0\n0.5,2\n1.5,2\n", None, [0, 2, 2]),
        ("# a remark\nTime (ms);Force (mN)\n0;0\n500;2000,0\n1500;2000\n", None, [0, 2, 2]),
        ("force,time\n-0.01,0\n2 N,500 ms\n2,1.5\n", None, [0, 2, 2]),
        ("time [s],load [N/mm]\n0,0\n0.5,0.2\n1.5,0.2\n", 0.01, [0, 2, 2]),
        ("time [s],force [N]\n0,0\n0.5,2\n1.5,2\n", 0.01, [0, 2, 2]),
    ],
)
def test_histories_are_tables_with_units(
    text: str, length: float | None, forces: list[float], command: Command
) -> None:
    history, bare = read_history(command.file("history.csv", text), length)
    np.testing.assert_allclose(history.times, [0, 0.5, 1.5], rtol=1e-12)
    np.testing.assert_allclose(history.forces, forces, rtol=1e-12)
    assert bare == text.startswith("force,")


def test_a_history_may_have_temperatures(command: Command) -> None:
    for heading, zero in (("temperature [K]", 0.0), ("temperature [degC]", 273.15), ("Temperature °C", 273.15)):
        path = command.file("history.csv", f"time [s],force [N],{heading}\n0,0,22\n1,1,33.5\n")
        assert read_history(path, None)[0].temperatures == pytest.approx([22 + zero, 33.5 + zero], rel=1e-15)
