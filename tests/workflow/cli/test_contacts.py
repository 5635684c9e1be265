"""Tables of real contacts on the command line: elastic punches and air, solved row by row or refused with the row."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import solver
from storage.netcdf import read_whole
from tests.workflow.cli.test_main import complaint
from workflow.cli import main

PUNCHES = """\
material,radius,load,punch,punch_modulus [GPa],punch_poisson,thickness [mm],base
PZT-4,0.05,1e5,,,,,
PZT-4,0.05,1e5,steel,,,,
PZT-4,0.05,1e5,,210,0.3,,
PZT-4,0.05,1e5,brass,,,0.5,steel
"""


def test_a_table_mixes_punches_and_bodies(tmp_path: Path) -> None:
    table, out = tmp_path / "punches.csv", tmp_path / "out.nc"
    table.write_text(PUNCHES, encoding="utf-8")
    assert main.main(["solve", str(table), "-o", str(out)]) == 0
    data = read_whole(out)
    punch: dict[str, Any] = {"material": "PZT-4", "radius": 0.05, "load": 1e5}
    cases: list[dict[str, Any]] = [
        {}, {"punch": "steel"}, {"punch": "steel"}, {"punch": "brass", "thickness": 5e-4, "base": "steel"},
    ]  # fmt: skip
    for row, own in enumerate(cases):
        for name in ("contact_trailing", "depth", "voltage"):
            exact = float(solver.solve(punch | own)[name])
            assert float(data[name][row]) == pytest.approx(exact, rel=1e-12), (row, name)
    assert data["punch"].values.tolist() == ["", "steel", "", "brass"]
    np.testing.assert_array_equal(data["punch_modulus"], [np.nan, np.nan, 210e9, np.nan])


@pytest.mark.parametrize(
    ("header", "row", "says"),
    [
        ("punch", "stel", "punch: 'stel' is unknown; did you mean 'steel'?"),
        ("punch_modulus,punch_poisson", "0,0.3", "punch_modulus: 0 is not a finite number > 0 [Pa]"),
        ("punch_modulus,punch_poisson", "1e9,0.5", "punch_poisson: 0.5 is not a finite number > -1 and < 0.5 [1]"),
        (
            "surroundings,electric,magnetic",
            "air,insulating,insulating",
            "surroundings: 'air' is not allowed: the punch conducts no field",
        ),
        ("gap_permittivity", "2.2", "gap_permittivity: 2.2 without surroundings: air; only its gap has one"),
        ("punch,punch_modulus,punch_poisson", "steel,1e9,0.3", "punch_modulus: 1e+09 beside a punch; give either"),
    ],
)
def test_a_row_at_fault_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], header: str, row: str, says: str
) -> None:
    table = tmp_path / "bad.csv"
    good = "," * header.count(",")
    table.write_text(f"material,radius,load,{header}\nPZT-4,0.05,1e5,{good}\nPZT-4,0.05,1e5,{row}\n", encoding="utf-8")
    assert f"{table}: line 3: {says}" in complaint(capsys, "solve", table, "-o", tmp_path / "out.nc")
    assert list(tmp_path.iterdir()) == [table]


AIRY = """\
material,radius,load,magnetic,surroundings,gap_permittivity,thickness [mm],base
PZT-4,0.05,1e4,insulating,,,,
PZT-4,0.05,1e4,insulating,air,,,
PZT-4,0.05,1e4,insulating,air,2.2,0.2,steel
"""


def test_a_table_mixes_surroundings_and_says_what_is_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, out = tmp_path / "air.csv", tmp_path / "out.nc"
    table.write_text(AIRY, encoding="utf-8")
    assert main.main(["solve", str(table), "-o", str(out)]) == 0
    left = capsys.readouterr().err
    for gone in ("left out", "gap_field", "electric_edge_intensity_trailing"):
        assert gone in left
    data = read_whole(out)
    case: dict[str, Any] = {"material": "PZT-4", "radius": 0.05, "load": 1e4, "magnetic": "insulating"}
    film: dict[str, Any] = {"surroundings": "air", "gap_permittivity": 2.2, "thickness": 2e-4, "base": "steel"}
    for row, own in enumerate([{}, {"surroundings": "air"}, film]):
        for name in ("contact_trailing", "voltage", "charge_sensitivity"):
            exact = float(solver.solve(case | own)[name])
            assert float(data[name][row]) == pytest.approx(exact, rel=1e-9), (row, name)
