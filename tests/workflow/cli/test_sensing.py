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
from workflow.study.reading import InputError

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
    ("history", "case", "device", "words"),
    [
        ("", CASE, DEVICE, "needs a header"),
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
def test_bad_input_is_refused_in_one_line(command: Command, history: str, case: str, device: str, words: str) -> None:
    path = command.file("history.csv", history)
    options: list[str | Path] = ["--on", case, "--device", device, "-o", path.with_name("out.csv")]
    assert words in command.refused("signal", path, *options)
    assert [*path.parent.iterdir()] == [path]


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
    history = read_history(command.file("history.csv", text), length)
    np.testing.assert_allclose(history.times, [0, 0.5, 1.5], rtol=1e-12)
    np.testing.assert_allclose(history.forces, forces, rtol=1e-12)


@pytest.mark.parametrize(("heading", "zero"), [("temperature [K]", 0.0), ("temperature [degC]", 273.15)])
def test_a_history_may_have_temperatures(heading: str, zero: float, command: Command) -> None:
    path = command.file("history.csv", f"time [s],force [N],{heading}\n0,0,22\n1,1,33.5\n")
    temperatures = read_history(path, None).temperatures
    assert temperatures is not None
    np.testing.assert_allclose(temperatures, [22 + zero, 33.5 + zero], rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time [s],force [N]\n0,0\n", "1 row; a history has two or more"),
        ("time [s],force [N]\n0,0\n2,1\n1,0\n", "line 4: time: 1 is not after 2"),
        (
            "time [s],force [N],temperature [K]\n0,0,295\n1,1,295\n1,1,306\n",
            "line 4: time: 1 is not after 1, from 295 to 306 K: no temperature jumps without time",
        ),
        ("time [s],force [N],temperature [degC]\n0,0,22\n1,1,-300\n", "line 3: temperature: -26.85 K is not a finite"),
        (
            "time [s],force [N],temperature [K],temperature [degC]\n0,0,295,22\n1,1,306,33\n",
            "temperature [degC]: stands beside another temperature; must be the only one",
        ),
        ("time [s],force [N],temperature [K]\n0,0,295\n1,1,\n", "line 3: temperature: empty; must be a number"),
        ("time [s],force [N]\n0,1\n1,-1\n", "line 3: force: -1 is not a finite number >= 0; subtract"),
        ("time [s],force [N]\n0,0\n1,\n", "line 3: force: empty"),
        ("time [s],force [N]\n0,0\n1,0\n", "is 0 all the time"),
        ("time [m],force [N]\n0,0\n1,1\n", "unit mismatch: 'm' does not measure"),
        ("time [s],load [N/m]\n0,0\n1,1\n", "load: a point contact has none"),
        ("time [s],force [N],load [N/m]\n0,0,0\n1,1,1\n", "load: is no column of a history"),
        ("time [s],radius [m]\n0,1\n1,1\n", "radius: is no column of a history"),
        ("time [s],CH1 [V]\n0,0\n1,1\n", "column 'CH1 [V]': unknown"),
        ("time [s],temperature [K]\n0,300\n1,300\n", "force: missing"),
        ("force [N]\n0\n1\n", "time: missing"),
        ("time,force\n12:00:00,0\n12:00:01,1\n", "line 2: time: '12:00:00' is not a finite number [s]"),
    ],
)
def test_what_is_no_history_is_refused_by_its_reason(text: str, words: str, command: Command) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        read_history(command.file("history.csv", text), None)
