"""Force histories in the files of instruments: ten kinds are read, what cannot be a history is refused in one line."""

from pathlib import Path

import numpy as np
import pytest

from workflow.cli.forcehistory import read_history
from workflow.study.reading import InputError

# inline copies of the layouts that makers' manuals and public threads show; the same press in each
FILES: dict[str, tuple[str, str]] = {
    "spreadsheet": ("Time (s),Force (N)\n0,0\n0.5,2\n1.5,2\n", "utf-8"),
    "Instron": (
        'Specimen label,"A 1"\nTest date,3/1/2024\n\n"Time","Extension","Load"\n"(s)","(mm)","(kN)"\n'
        '"0.000","0.00000","0.00000"\n"0.500","0.00123","0.00200"\n"1.500","0.00123","0.00200"\n',
        "utf-8",
    ),
    "Zwick": (
        "Prüfprotokoll\nPrüfzeit;Standardkraft;Verformung\ns;N;mm\n0,000;0,000;0\n0,500;2,000;0,01\n1,500;2,000;0,01\n",
        "cp1252",
    ),
    "MTS": (
        "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\nData Acquisition: Timed\n\n"
        "Time\tAxial Displacement\tAxial Force\nSec\tmm\tkN\n"
        "0\t0\t0\n0.5\t-0.01\t-2e-3\n1.5\t-0.01\t-2e-3\n",
        "utf-8",
    ),
    "LabVIEW": (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n"
        "X_Columns\tOne\nDate\t2016/08/11\nTime\t14:37:48,2010002\n***End_of_Header***\t\n\nChannels\t1\t\n"
        "Samples\t3\t\nDate\t2016/08/11\t\nTime\t15:37:48,375\t\nY_Unit_Label\tN\t\nX_Dimension\tTime\t\n"
        "X0\t0,0000000000000000E+0\t\nDelta_X\t0,500000\t\n***End_of_Header***\t\t\nX_Value\tForce\tComment\n"
        "0,000000\t0,000000\t\n0,500000\t2,000000\n1,500000\t2,000000\n",
        "utf-8",
    ),
    "Excel in UTF-16": ("Zeit [s]\tKraft [mN]\r\n0\t0\r\n0,5\t2000\r\n1,5\t2000\r\n", "utf-16"),
    "Arduino": (
        "12:00:00.001 -> millis,force_N\n"
        "12:00:00.010 -> 100,0.00\n12:00:00.510 -> 600,2.00\n12:00:01.510 -> 1600,2.00\n",
        "utf-8",
    ),
    "NumPy": ("# t [s] force [N]\n0.0e+00 0.0e+00\n5.0e-01 2.0e+00\n1.5e+00 2.0e+00\n", "utf-8"),
    "logger": (
        "Date,Time,Force (N)\n2024-03-01,23:59:58.0,0.0\n2024-03-01,23:59:58.5,2.0\n2024-03-01,23:59:59.5,2.0\n",
        "utf-8",
    ),
    "balance": ("# HX711\ntime_ms;weight (gf)\n0;0\n500;203.9432426\n1500;203.9432426\n", "utf-8"),
    "Unix time": (
        "timestamp,load_cell [N]\n1709251200.000000,0\n1709251200.500000,2\n1709251201.500000,2\n",
        "utf-8-sig",
    ),
    "ISO dates": (
        "time,force [N]\n2024-03-01T12:00:00.000Z,0\n2024-03-01T12:00:00.500Z,2\n2024-03-01T12:00:01.500Z,2\n",
        "utf-8",
    ),
    "Bluehill": (
        "Results Table 1\n,Maximum Force\n,(N)\n1,2.00\n2,2.01\n\nTime,Extension,Force\n(s),(mm),(N)\n"
        '"0.0","0","0"\n"0.5","1","2"\n"1.5","1","2"\n',
        "utf-8",
    ),
    "US dates": (
        "Time,Force (KN)\n3/14/2024 1:59:59.5 PM,0\n3/14/2024 2:00:00 PM,2e-3\n3/14/2024 2:00:01 PM,2e-3\n",
        "utf-8",
    ),
    "names that are not known": ("測定時間(msec.),荷重(N)\n0,0\n500,2\n1500,2\n", "utf-8"),
    "footer": ("time [s],force [N]\n0,0\n0.5,2\n1.5,2\n\nEOF\n", "utf-8"),
}
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
    text, encoding = FILES.get(name) or (SCOPES[name], "utf-8")
    path.write_bytes(text.encode(encoding))
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
