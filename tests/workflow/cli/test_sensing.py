"""``meecontact signal``: the page's example, and what it refuses in one line."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from tests.workflow.cli.test_main import complaint
from workflow.cli import main, sensing
from workflow.cli.forcehistory import read_history
from workflow.device import contact
from workflow.run.provenance import ROOT
from workflow.study.reading import InputError

PAGE = (ROOT / "docs/signal.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"(?:^    .+\n)+", PAGE, re.MULTILINE)
CASE = "profile=sphere,material=BaTiO3,radius=5 mm"
DEVICE = "input_capacitance=10 pF,input_resistance=1 GOhm"


def test_the_page_s_example(
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


# inline copies of the layouts that makers' manuals and public threads show; the same press in each
FILES = {
    "spreadsheet": "Time (s),Force (N)\n0,0\n0.5,2\n1.5,2\n",
    "Instron": 'Specimen label,"A 1"\nTest date,3/1/2024\n\n"Time","Extension","Load"\n"(s)","(mm)","(kN)"\n'
    '"0.000","0.00000","0.00000"\n"0.500","0.00123","0.00200"\n"1.500","0.00123","0.00200"\n',
    "Zwick": "Prüfprotokoll\nPrüfzeit;Standardkraft;Verformung\ns;N;mm\n"
    "0,000;0,000;0\n0,500;2,000;0,01\n1,500;2,000;0,01\n",
    "MTS": "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\nData Acquisition: Timed\n\n"
    "Time\tAxial Displacement\tAxial Force\nSec\tmm\tkN\n"
    "0\t0\t0\n0.5\t-0.01\t-2e-3\n1.5\t-0.01\t-2e-3\n",
    "LabVIEW": "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n"
    "X_Columns\tOne\nDate\t2016/08/11\nTime\t14:37:48,2010002\n***End_of_Header***\t\n\nChannels\t1\t\n"
    "Samples\t3\t\nDate\t2016/08/11\t\nTime\t15:37:48,375\t\nY_Unit_Label\tN\t\nX_Dimension\tTime\t\n"
    "X0\t0,0000000000000000E+0\t\nDelta_X\t0,500000\t\n***End_of_Header***\t\t\nX_Value\tForce\tComment\n"
    "0,000000\t0,000000\t\n0,500000\t2,000000\n1,500000\t2,000000\n",
    "Excel in UTF-16": "Zeit [s]\tKraft [mN]\r\n0\t0\r\n0,5\t2000\r\n1,5\t2000\r\n",
    "Arduino": "12:00:00.001 -> millis,force_N\n"
    "12:00:00.010 -> 100,0.00\n12:00:00.510 -> 600,2.00\n12:00:01.510 -> 1600,2.00\n",
    "NumPy": "# t [s] force [N]\n0.0e+00 0.0e+00\n5.0e-01 2.0e+00\n1.5e+00 2.0e+00\n",
    "logger": "Date,Time,Force (N)\n2024-03-01,23:59:58.0,0.0\n2024-03-01,23:59:58.5,2.0\n2024-03-01,23:59:59.5,2.0\n",
    "balance": "# HX711\ntime_ms;weight (gf)\n0;0\n500;203.9432426\n1500;203.9432426\n",
    "Unix time": "timestamp,load_cell [N]\n1709251200.000000,0\n1709251200.500000,2\n1709251201.500000,2\n",
    "ISO dates": "time,force [N]\n2024-03-01T12:00:00.000Z,0\n2024-03-01T12:00:00.500Z,2\n2024-03-01T12:00:01.500Z,2\n",
    "Bluehill": "Results Table 1\n,Maximum Force\n,(N)\n1,2.00\n2,2.01\n\nTime,Extension,Force\n(s),(mm),(N)\n"
    '"0.0","0","0"\n"0.5","1","2"\n"1.5","1","2"\n',
    "US dates": "Time,Force (KN)\n3/14/2024 1:59:59.5 PM,0\n3/14/2024 2:00:00 PM,2e-3\n3/14/2024 2:00:01 PM,2e-3\n",
    "names that are not known": "測定時間(msec.),荷重(N)\n0,0\n500,2\n1500,2\n",
    "footer": "time [s],force [N]\n0,0\n0.5,2\n1.5,2\n\nEOF\n",
}  # fmt: skip
ENCODINGS = {"Zwick": "cp1252", "Excel in UTF-16": "utf-16", "Unix time": "utf-8-sig"}
SCOPES = {  # the force of a volt is 20 N
    "Tektronix": "Record Length,3,,0.0,0.0,\nSample Interval,5e-1,,0.5,0.1,\nTrigger Point,0,,1.5,0.1,\n"
    "Source,CH1,,,,\n"
    "Vertical Units,V,,,,\nHorizontal Units,s,,,,\n",
    "Tektronix with a header": "Model,MSO24\nVertical Units,V\n\nTIME,CH1\n0,0\n0.5,0.1\n1.5,0.1\n",
    "Keysight": "x-axis,1\nsecond,Volt\n0,0\n+500.0E-03,+100.0E-03\n1.5,0.1\n",
    "PicoScope": "Time,Channel A\n(ms),(mV)\n\n0,0\n500,100\n1500,100\n",
    "Rohde & Schwarz": "in s,C1 in V\n0,0\n0.5,0.1\n1.5,0.1\n",
    "OWON": "Unit:,(ms)\nFrequency,CH1:0Hz\nTime,CH1\n0,0\n500,0.1\n1500,0.1\n",
    "Rigol": "X,CH1,Start,Increment\nSequence,Volt,0.0,5.0e-01\n0,0,\n1,0.1,\n3,0.1,\n",
}


@pytest.mark.parametrize("name", [*FILES, *SCOPES])
def test_files_of_instruments_are_read(name: str, tmp_path: Path) -> None:
    path = tmp_path / "history.txt"
    path.write_text((FILES | SCOPES)[name], encoding=ENCODINGS.get(name, "utf-8"), newline="")
    file = read_history(path, line=False, scale="20 N/V" if name in SCOPES else None)
    times = file.history.times
    np.testing.assert_allclose(times - times[0], [0, 0.5, 1.5], rtol=1e-9, err_msg=name)
    np.testing.assert_allclose(file.history.forces, [0, 2, 2], rtol=1e-9, err_msg=name)
    assert file.remarks == [] or name in ("MTS", "logger", "ISO dates", "US dates", "Tektronix with a header")


def test_an_oscilloscope_s_steps_of_unix_time_are_not_lost(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    rows = [f"{1732600000 + k // 50000}.{k % 50000 * 20:06d},{k % 7}" for k in range(100_000)]
    path.write_text("time [s],force [N]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    file = read_history(path, line=False)
    np.testing.assert_allclose(np.diff(file.history.times), 2e-5, rtol=1e-9)
    assert file.remarks == [f"times are counted from the first row, at {rows[0].split(',')[0]}"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty: needs a header"),
        ("\n\n", "is empty: needs a header"),
        ("0,0\n1,1\n", "has no header"),
        ("time,force\n", "0 rows; a history has 2 to"),
        ("time [s],force [N]\n0,0\n", "1 rows; a history has 2 to"),
        ("time [s],force [N]\n0,0\n2,1\n1,0\n", "line 4: time: 1 is not after 2"),
        ("time [s],force [N]\n0,0\n1,1\n1,2\n", "line 4: time: 1 is there twice"),
        (
            "time [s],force [N],temperature [K]\n0,0,295\n1,1,295\n1,1,306\n",
            "line 4: time: 1 is there twice, at 295 and 306 K: no temperature jumps without time",
        ),
        ("time [s],force [N],temp [degC]\n0,0,22\n1,1,-300\n", "line 3: temperature: -26.85 K is not a finite"),
        ("time [s],force [N],temperature\n0,0,22\n1,1,33\n", "temperature: has no unit; must be 'temperature [K]'"),
        ("time [s],force [N],temperature [K]\n0,0,295\n1,1,\n", "line 3: temperature: empty; must be a number"),
        ("time [s],force [N]\n0,1\n1,-1\n", "line 3: force [N]: -1 N is not a finite number >= 0; subtract"),
        ("time [s],force [N]\n0,0\n1,nan\n", "line 3: force [N]: 'nan' stands for a missing value; remove the row"),
        ("time [s],force [N]\n0,0\n1,\n", "line 3: force [N]: empty"),
        ("time [s],force [N]\n0,0\n1,inf\n", "inf is not a finite number"),
        ("time [s],force [N]\n0,0\n1,0\n", "is 0 all the time"),
        ("time [m],force [N]\n0,0\n1,1\n", "unit mismatch: 'm' does not measure a time"),
        ("time [s],force [Pa]\n0,0\n1,1\n", "unit mismatch: 'Pa' does not measure a force"),
        ("time [s],load\n0,0\n1,1\n", "load: has no unit; write it behind the name"),
        ("time [s],force [N],load [N]\n0,0,0\n1,1,1\n", "may both be the force"),
        ("time [s],CH1 [V]\n0,0\n1,1\n", "CH1 [V]: is in V; --scale 'NUMBER N/V' says the force of a volt"),
        ("time [s],depth [m]\n0,0\n1,1\n", "force: missing"),
        ("force [N]\n0\n1\n", "time: missing"),
        ("time [s],force [N]\n0,0\n\nOverload\n1,1\n", "line 4: 'Overload' is no row of numbers"),
        ("time [s],force [N]\n0,0\n0,5,1,5\n", "line 3: 4 cells, the header has 2; a decimal comma?"),
        ("time [s];force [N]\n0;0\n1;1.000,5\n", "groups its digits"),
        ("time,force\n12:00:00,0\n12:00:61x,1\n", "is no time"),
        ("time,force\n1710414000000,0\n1710414000100,1\n", "time: has no unit, and 1.71e+12 s are no time"),
        ("time [s];force [N]\n0,5;0\n1,5;1.000\n2,5;1.000\n", "'1.000' may group its digits"),
        ('time [s],force [N]\n0,0\n1,"1,000"\n', "groups its digits, or has a decimal comma"),
        ("time [s],force [N]\n0,0\n1,1 000\n", "groups its digits"),
        ("time,force\n0 s,0 N\n1 s,1 N\n", "line 2: '0 s 0 N' is no row of numbers"),
        ("time,force [N]\n12:00,0\n12:01,1\n", "line 2: time: '12:00' is no time"),
        ("time,force [N]\n31.12.2024 23:59:59,0\n01.01.2025 00:00:00,1\n", "the date changes from 31.12.2024"),
        ("\x00\x01time", "is no text file"),
        ("<html><table>", "is a page of HTML"),
    ],
)
def test_what_is_no_history_is_refused_by_its_reason(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as refusal:
        read_history(path, line=False)
    assert words in str(refusal.value)


def test_noise_below_zero_is_no_pull_and_compression_may_be_negative(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text("time [s],force [N]\n-1,-0.001\n0,-0.5\n1,0.002\n", encoding="utf-8")
    file = read_history(path, line=False)
    np.testing.assert_array_equal(file.history.forces, [0.001, 0.5, 0.0])
    assert [remark.partition(": ")[2][:10] for remark in file.remarks] == ["counts com", "1 forces d"]


def test_a_time_without_a_unit_is_told_how_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text("time,force\n0,0\n100,1\n5000,0\n", encoding="utf-8")
    file = read_history(path, line=False)
    assert file.remarks == ["time has no unit and is read in s: 5000 s from first to last row"]
