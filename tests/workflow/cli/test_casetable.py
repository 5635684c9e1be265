"""Tables of cases of other programs are read, with units in every way that they are written."""

import resource
from pathlib import Path

import numpy as np
import pytest

from tests.programs import Command
from workflow.cli.casetable import read_cases


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


HEADERS = [
    "thickness [um],force [N]",
    "thickness (um),force (N)",
    '"thickness, um","force, N"',
    "thickness / um,force / N",
    "thickness_um,force_N",
    "thickness in um,force in N",
    "thickness um,force N",
    "sep=,\nthickness [μm],force",
    "Thickness [µm],Force [N]",
    "thickness,force\num,N",
    "thickness,force\n[um],[N]",
    "thickness [um],force,",
]


@pytest.mark.parametrize(
    ("text", "expected"),
    [(f"{header}\n20,0.01\n20,0.01,\n", [[2e-5, 2e-5], [0.01, 0.01]]) for header in HEADERS]
    + [
        ("thickness,radius [mm]\n20 um,5\n0.00002,5 cm\n", [[2e-5, 2e-5], [5e-3, 5e-2]]),
        ("load [kN·m⁻¹],charge,base_modulus\n1.5×10¹,−2 µC·m⁻¹,2.1×10¹¹\n", [[1.5e4], [-2e-6], [2.1e11]]),
    ],
)
def test_units_are_read_in_every_way_that_tables_write_them(
    text: str, expected: list[list[float]], command: Command
) -> None:
    columns = read_cases(command.file("cases.csv", text)).columns
    assert [column.tolist() for column in list(columns.values())[: len(expected)]] == expected


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


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
@pytest.mark.parametrize(("separator", "mark"), [(";", ","), ("\t", ","), (";", "."), ("\t", "."), (",", ".")])
def test_tables_of_spreadsheets_are_read(encoding: str, separator: str, mark: str, tmp_path: Path) -> None:
    rows = [["material", "thickness [µm]", "radius"], ["PZT-4", f"20{mark}5", f'"{mark}05"'], ["", "", f"5{mark}5 mm"]]
    path = tmp_path / "cases.csv"
    path.write_bytes("\r\n".join(separator.join(row) for row in rows).encode(encoding))
    columns = read_cases(path).columns
    assert columns["material"].tolist() == ["PZT-4", None]
    np.testing.assert_array_equal(columns["thickness"], [20.5e-6, np.nan])
    np.testing.assert_array_equal(columns["radius"], [0.05, 5.5e-3])
