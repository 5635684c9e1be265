"""Tables of cases, solved in blocks with the bits of one pass, and of forces in time."""

import io
import re
import resource
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import solver
from solver.fields import INTERIOR
from solver.names import POINT_SLIDING
from storage.netcdf import read_whole, write_whole
from tests.programs import Command
from workflow.cli import sensing
from workflow.cli import solve as case_solver
from workflow.cli.casetable import read_cases
from workflow.cli.sensing import read_history
from workflow.cli.textfile import write_columns
from workflow.device import contact
from workflow.language.wordings import plain
from workflow.run.provenance import ROOT
from workflow.study.reading import InputError


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
def test_units_are_read_in_every_notation(text: str, expected: list[list[float]], command: Command) -> None:
    columns = read_cases(command.file("cases.csv", text)).columns
    assert [column.tolist() for column in list(columns.values())[: len(expected)]] == expected


def test_quotes_blanks_and_lines_of_other_programs_are_read(tmp_path: Path) -> None:
    path = tmp_path / "cases.csv"
    remarks = b'# from a colleague\nmaterial ,"radius",load\r\n\r\n"PZT-4", 0.05 ,"1e5"\r\n#PZT-4,1,1\n'
    path.write_bytes(remarks + b'steel,,\xc2\xa02E4\r\n\n"a\nb",1.,+.5e1')
    table = read_cases(path)
    assert table.columns["material"].tolist() == ["PZT-4", "steel", "a\nb"]
    np.testing.assert_array_equal(table.columns["radius"], [0.05, np.nan, 1.0])
    np.testing.assert_array_equal(table.columns["load"], [1e5, 2e4, 5.0])
    assert table.lines.tolist() == [4, 6, 9]
    assert table.at(1) == f"{path}: line 6"
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


# sorted, so that blocks of neighbours would take the solver other numbers of steps
SORTED = "".join(f"laminate,{share:.6g},,0.05,{friction},1e5\n" for share, friction in
                 zip(np.linspace(0, 1, 300) ** 4, np.linspace(0, 1, 300), strict=True))  # fmt: skip
OTHERS = "".join(f",,{name},0.02,0.3,{load}\n" for name in ("steel", "PZT-4", "BaTiO3") for load in range(1, 41))


def test_blocks_give_the_bytes_of_one_pass(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "cases.csv"
    path.write_text("composite,volume_fraction,material,radius,friction,load\n" + SORTED + OTHERS, encoding="utf-8")
    sizes: list[int] = []

    def written(most: int) -> bytes:
        monkeypatch.setattr(case_solver, "_CLOSED_FORM_CASES", most)
        sizes.clear()

        def counted(factors: xr.Dataset) -> xr.Dataset:
            sizes.append(factors.sizes["case"])
            return solver.solve(factors, [-2.0, 0.5])

        write_whole(case_solver.solved(read_cases(path), counted, 2), tmp_path / f"{most}.nc")
        return (tmp_path / f"{most}.nc").read_bytes()

    one_pass = written(1000)
    assert sizes == [300, 120]
    assert written(70) == one_pass
    assert sizes == [60] * 7
    data = read_whole(tmp_path / "70.nc")
    assert data["load"].sizes == {"case": 420}
    np.testing.assert_array_equal(data["load"].values[300:], np.tile(np.arange(1.0, 41.0), 3))


def test_long_tables_take_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    """A later block has columns and faults of its own; the file is that of one table, or none."""
    header, *rows = "material,radius,load,profile,width", "PZT-4,0.05,1e4 N/m,,", "steel,,2e4 N/m,flat,1e-3"
    text = "\n".join([header, *[rows[0]] * 7, *[rows[1]] * 5, *[rows[0]] * 2]) + "\n"
    path = command.file("cases.csv", text)
    said = command("solve", path, "-o", tmp_path / "whole.csv")[1].replace("whole", "blocks")
    monkeypatch.setattr(case_solver, "_BLOCK", 4)
    assert command("solve", path, "-o", tmp_path / "blocks.csv")[1] == said
    whole, blocks = (pd.read_csv(tmp_path / f"{name}.csv") for name in ("whole", "blocks"))
    pd.testing.assert_frame_equal(blocks[whole.columns], whole, rtol=1e-12)
    assert whole["width [m]"].isna().tolist() == [True] * 7 + [False] * 5 + [True] * 2
    command.file("cases.csv", text + "PZT-4,-1,1e4 N/m,,\n")
    (tmp_path / "blocks.csv").unlink()
    refusal = command.refused("solve", path, "-o", tmp_path / "blocks.csv")
    assert "line 16: radius: -1 is not a finite number > 0" in refusal
    assert {file.name for file in tmp_path.iterdir()} == {"cases.csv", "whole.csv"}


def test_an_answer_too_large_for_the_memory_is_refused(monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    path = command.file("cases.csv", "material,radius,load\n" + "steel,0.05,1e5\n" * 50)
    monkeypatch.setattr(case_solver, "_MOST_BYTES", 5000)
    with pytest.raises(InputError, match=r"cases\.csv: 50 cases give more than 5000 bytes; split it"):
        case_solver.solved(read_cases(path), solver.solve)


def test_a_name_that_a_spreadsheet_would_calculate_stays_a_name() -> None:
    file = io.BytesIO()
    write_columns(file, {"material": np.array(["=1+1", None]), "load": np.array([-1.0, np.nan])})
    assert file.getvalue() == b"material,load\n'=1+1,-1.0\n,\n"
    assert [plain(text) for text in ("=1+1", "+x", "-x", "@x")] == ["'=1+1", "'+x", "'-x", "'@x"]
    assert [plain(cell) for cell in ("a,b", -1.0)] == ["a,b", -1.0]


LINES_AND_POINTS = """\
material,profile,radius [mm],width [um],load,force,thickness [mm],base,friction,electric,surroundings,\
punch_modulus [GPa],punch_poisson,punch,gap_permittivity,magnetic
BaTiO3,cylinder,50,,1e4,,,,0.1,,,210,0.3,,,
BaTiO3,sphere,5,,,1,,,,,,,,,,
BaTiO3,sphere,5,,,1,0.1,steel,,,insulated,,,brass,,
BaTiO3,disc,,100,,1,,,,insulating,,,,,,
PZT-4,,50,,1e4,,0.2,rigid,,,insulated,,,,,
PZT-4,,50,,1e4,,0.2,steel,,,air,,,,2.2,insulating
"""


def cases(text: str) -> Iterator[dict[str, Any]]:
    """The cases of a table, with the units of its header."""
    for _, row in pd.read_csv(io.StringIO(text)).iterrows():
        named = [(*head.removesuffix("]").partition(" ["), cell) for head, cell in row.dropna().items()]
        yield {name: f"{cell} {unit}" if unit else cell for name, _, unit, cell in named}


def test_a_table_mixes_lines_points_and_surroundings(tmp_path: Path, command: Command) -> None:
    table, out = command.file("mixed.csv", LINES_AND_POINTS), tmp_path / "out.nc"
    assert "empty where a case has no such quantity: " in command("solve", table, "-o", out)[1]
    data = read_whole(out)
    assert np.isnan(data["gap_field"].values).tolist() == [True] * 5 + [False]
    assert data["gap_field"].attrs["comment"] == "no number where a case has none"
    for row, case in enumerate(cases(LINES_AND_POINTS)):
        exact = solver.solve(case)
        for name in set(exact.data_vars) | set(data.data_vars):
            value = float(data[str(name)][row])
            known = name in exact and name not in POINT_SLIDING  # the column of frictions gives points theirs
            assert not known or value == pytest.approx(float(exact[name]), rel=1e-9), (row, name)
            assert known or np.isnan(value) or name in POINT_SLIDING, (row, name)
    np.testing.assert_array_equal(data["radius"], [0.05, 5e-3, 5e-3, np.nan, 0.05, 0.05])


MIXED = """\
profile,radius,width,slope,material,volume_fraction,load,friction,charge,magnetic,speed,corner,moment
flat,,0.01,,,0.4,1e5,0.2,1e-6,insulating,,,
wedge,,,0.02,PZT-4,,2e4,0.1,,,,leading,
half_cylinder,0.1,,,,0.5,1e5,0.3,,,800,trailing,
"""


def test_a_table_of_every_kind_of_punch_has_fields_at_and_below_the_surface(tmp_path: Path, command: Command) -> None:
    table, out, below = command.file("cases.csv", MIXED), tmp_path / "out.nc", tmp_path / "inside.nc"
    command("solve", table, "-o", out, "--positions=-2,0,0.5", "--peaks")
    command("interior", table, "-o", below, "--x=-1.2,0,2", "--y=-0.5,0")
    data, inside = read_whole(out), read_whole(below)
    assert set(inside.data_vars) == set(INTERIOR)
    assert inside["von_mises"].dims == ("case", "y", "x")
    names = ["depth", "voltage", "contact_trailing", "peak_von_mises", "peak_principal_tension", "stress_xx"]
    for row, factors in enumerate(cases(MIXED)):
        expected = solver.solve(factors, [-2.0, 0.0, 0.5], peaks=True)
        for name in names:
            np.testing.assert_allclose(data[name].isel(case=row), expected[name], rtol=1e-9, err_msg=f"{name}, {row}")
    expected = solver.solve_interior(list(cases(MIXED))[1], [-1.2, 0, 2], [-0.5, 0])
    for name in INTERIOR:
        scale = float(np.abs(expected[name]).max())
        np.testing.assert_allclose(inside[name].isel(case=1), expected[name], rtol=1e-9, atol=1e-12 * scale)


def test_fields_inside_films_end_at_a_rigid_base(command: Command) -> None:
    rows = "".join(f"PZT-4,0.05,1e5,0.5,{base},insulated\n" for base in ("rigid", "steel"))
    table = command.file("films.csv", f"material,radius,load,thickness [mm],base,surroundings\n{rows}")
    out = table.with_suffix(".nc")
    command("interior", table, "-o", out, "--x=0,0.5", "--y=-4,-0.5", "--fields=stress_yy,von_mises")
    data = read_whole(out)
    assert np.isnan(data["von_mises"].values).any(axis=2).tolist() == [[True, False], [False, False]]
    assert np.all(data["stress_yy"].values[:, 1] < 0)


PAGE = (ROOT / "docs/signal.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"(?:^    .+\n)+", PAGE, re.MULTILINE)
CASE = "profile=sphere,material=BaTiO3,radius=5 mm"
DEVICE = "input_capacitance=10 pF,input_resistance=1 GOhm"


def test_the_page_s_example(here: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
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
    dense = np.interp(few[:, 0], full[:, 0], full[:, 3])
    np.testing.assert_allclose(dense, few[:, 3], atol=1e-6 * np.abs(few[:, 3]).max())
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
def test_histories_are_tables_with_units(text: str, length: float, forces: list[float], command: Command) -> None:
    history, bare = read_history(command.file("history.csv", text), length)
    np.testing.assert_allclose(history.times, [0, 0.5, 1.5], rtol=1e-12)
    np.testing.assert_allclose(history.forces, forces, rtol=1e-12)
    assert bare == text.startswith("force,")


def test_a_history_may_have_temperatures(command: Command) -> None:
    for heading, zero in (("temperature [K]", 0.0), ("temperature [degC]", 273.15), ("Temperature °C", 273.15)):
        path = command.file("history.csv", f"time [s],force [N],{heading}\n0,0,22\n1,1,33.5\n")
        assert read_history(path, None)[0].temperatures == pytest.approx([22 + zero, 33.5 + zero], rel=1e-15)
