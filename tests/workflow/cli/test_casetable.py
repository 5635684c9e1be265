"""Tables of cases of other programs are read; endless and unbounded ones are refused."""

import os
import resource
from pathlib import Path

import numpy as np
import pytest

from tests.programs import Command
from workflow.cli import casetable
from workflow.cli.casetable import read_cases
from workflow.study.reading import InputError


def test_units_behind_names_are_those_of_the_numbers(command: Command) -> None:
    text = "# from a colleague\nradius [mm],load[kN/m],voltage [kV]\n50,10,-0.2\n#50,20,0\n,1,\n"
    table = read_cases(command.file("cases.csv", text), {"voltage": "V"})
    np.testing.assert_allclose(table.columns["radius"], [0.05, np.nan], rtol=1e-15)
    np.testing.assert_allclose(table.columns["load"], [1e4, 1e3], rtol=1e-15)
    np.testing.assert_allclose(table.columns["voltage"], [-200.0, np.nan], rtol=1e-15)
    assert table.lines.tolist() == [3, 5]


def test_a_long_cell_does_not_widen_its_column(command: Command) -> None:
    path = command.file("cases.csv", "material\n" + "x" * 200 + "\n" + "a\n" * 137_000)  # 274 kB took 4.1 GB
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert read_cases(path).columns["material"].nbytes == 137_001 * 8
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 60_000  # kB


def test_devices_and_pipes_are_refused(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (Path("/dev/zero"), pipe):
        with pytest.raises(InputError, match=f"{path}: not a regular file"):
            read_cases(path)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("thickness,radius [mm],force\n20 um,5,10 mN\n0.00002,5 cm,0.01\n", [[2e-5, 2e-5], [5e-3, 5e-2], [0.01, 0.01]]),
        ("load [kN·m⁻¹],charge,base_modulus\n1.5×10¹,−2 µC·m⁻¹,2.1×10¹¹\n", [[1.5e4], [-2e-6], [2.1e11]]),
    ],
)
def test_cells_with_units_and_printed_numbers_are_read(
    text: str, expected: list[list[float]], command: Command
) -> None:
    table = read_cases(command.file("cases.csv", text))
    assert [column.tolist() for column in table.columns.values()] == expected


WAYS = ["thickness [um],force [N]", "thickness (um),force (N)", "thickness / um,force / N", "thickness_um,force_N"]
WAYS += ["Thickness [µm],Force [N]", "thickness,force\num,N", "thickness,force\n[um],[N]", "thickness [um],force,"]


@pytest.mark.parametrize("header", WAYS)
def test_units_are_read_in_every_way_that_tables_write_them(header: str, command: Command) -> None:
    columns = read_cases(command.file("cases.csv", f"{header}\n20,0.01\n20,0.01,\n")).columns
    assert columns["thickness"].tolist() == [2e-5, 2e-5]
    assert columns["force"].tolist() == [0.01, 0.01]


def test_quotes_blanks_and_lines_of_other_programs_are_read(tmp_path: Path) -> None:
    path = tmp_path / "cases.csv"
    path.write_bytes(b'material ,"radius",load\r\n\r\n"PZT-4", 0.05 ,"1e5"\r\nsteel,,\xc2\xa02E4\r\n\n"a\nb",1.,+.5e1')
    table = read_cases(path)
    assert table.columns["material"].tolist() == ["PZT-4", "steel", "a\nb"]
    np.testing.assert_array_equal(table.columns["radius"], [0.05, np.nan, 1.0])
    np.testing.assert_array_equal(table.columns["load"], [1e5, 2e4, 5.0])
    assert table.lines.tolist() == [3, 4, 7]
    assert table.at(1) == f"{path}: line 4"
    assert table.empty("radius").tolist() == [False, True, False]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
@pytest.mark.parametrize(("separator", "mark"), [(";", ","), ("\t", ","), (";", "."), ("\t", "."), (",", ".")])
def test_tables_of_spreadsheets_are_read(encoding: str, separator: str, mark: str, tmp_path: Path) -> None:
    rows = [["material", "thickness [µm]", "radius"], ["PZT-4", f"20{mark}5", f'"{mark}05"'], ["", "", f"5{mark}5 mm"]]
    path = tmp_path / "cases.csv"
    path.write_bytes("\r\n".join(separator.join(row) for row in rows).encode(encoding))
    columns = read_cases(path).columns
    assert columns["material"].tolist() == ["PZT-4", None]
    np.testing.assert_array_equal(columns["thickness"], [20.5e-6, np.nan])
    np.testing.assert_array_equal(columns["radius"], [0.05, 5.5e-3])


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "needs a header of factor names and at least one case"),
        (b"load\n", "needs a header of factor names and at least one case"),
        (b"radius [mm,load\n1,1\n", "column 'radius [mm': unknown factor"),
        (b"radius [ells]\n1\n", "column 'radius': 'ells' is not a unit"),
        (b"radius [Pa]\n1\n", "column 'radius': unit mismatch: 'Pa' does not measure what 'm' measures"),
        (b"radius [m],radius [mm]\n1,1\n", "column 'radius': given twice"),
        (b"load [TN/fm]\n1e300\n", "line 2: load: inf is not a finite number > 0 [N m-1]"),
        (b"material [1]\nsteel\n", "column 'material': holds names, which have no unit"),
        (b"load\n1_00_000\n", "line 2: load: '1_00_000' is not a finite number > 0 [N m-1]"),
        ("load\n\n\u0663\n".encode(), "line 3: load: '\u0663' is not a finite number"),
        (b"load\n1e5\n1e999\n", "line 3: load: inf is not a finite number"),
        (b"electric\nconducting\n\nisolating\n", "line 4: electric: 'isolating' is not one of conducting, insulating"),
        (b"thickness\n20 kg\n", "line 2: thickness: '20 kg': unit mismatch: 'kg' does not measure what 'm'"),
        (b"material\nsteel\n" + b"x" * 201, "line 3: material: 'xxxxxxxxxxxxxxxxxxxx...' has more than 200 characters"),
        (b"load\n1" + b" " * 70_000, "line 2: longer than 65536 characters"),
        (b'load\n"1\n' + b"\n" * 70_000 + b'"\n', "longer than 65536 characters"),
        (b"load\n1" + b"," * 60_000 + b"1\n", "line 2: 60001 cells, the header has 1"),
        (b"load\n" + b"1\n" * 21, "line 22: more than 20 cases; split the table"),
        (b"load\n" + b"\n" * 90, "more than 80 lines"),
        (b"PK\x03\x04\x14\x00", "is no text file"),
        (b"load\n1e5\nNA\n", "line 3: load: 'NA' is not a finite number > 0"),
        (b"radius\n\x00\x01\x02", "is no text file"),
        (b"radius\n\x81\x8d\n", "not a CSV table in UTF-8"),
        (b"radius|load\n1|2\n", "column 'radius|load': unknown factor"),
        (b"0.05,1e5\n", "column '0.05': unknown factor"),
        (b"radius [mm],lod [kN/m]\n1,1\n", "column 'lod [kN/m]': unknown factor; did you mean 'load [kN/m]'?"),
        (b"radius [mm],zzz [kg]\n1,1\n", "column 'zzz [kg]': unknown factor; all names: meecontact list factors"),
        (b"radius,load\n0,05,1e5\n", "3 cells, the header has 2 (columns are separated by commas)"),
        (b'radius,load\n"0,05",1e5\n', "'0,05': the decimal mark of this table is '.'; do not group digits"),
        (b"radius;load\n1.000,5;1e5\n", "do not group digits"),
        (b"radius;load\n1,5;1.000\n", "the decimal mark of this table is ','"),
        (b"thickness\n100\n", "100 is 100 m; did you mean 100 um?"),
        (b"radius\n50\n", "50 is 50 m; did you mean 50 mm?"),
        (b"base_modulus\n200\n", "200 is 200 Pa; did you mean 200 GPa?"),
    ],
)
def test_bad_tables_are_refused(content: bytes, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(casetable, "_MOST_CASES", 20)
    monkeypatch.setattr(casetable, "_MOST_LINES", 80)
    path = tmp_path / "cases.csv"
    path.write_bytes(content)
    with pytest.raises(InputError) as refusal:
        read_cases(path)
    assert reason in str(refusal.value)
    assert len(str(refusal.value)) < 300
