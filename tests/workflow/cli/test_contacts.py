"""Tables of real contacts on the command line: elastic punches and air, solved row by row or refused with the row."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import solver
from solver.names import POINT_SLIDING
from storage.netcdf import read_whole
from workflow.cli import main
from workflow.language import grammar

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


def test_a_table_mixes_lines_points_and_surroundings_and_is_written_as_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, out, sheet = tmp_path / "mixed.csv", tmp_path / "out.nc", tmp_path / "out.csv"
    table.write_text(LINES_AND_POINTS, encoding="utf-8")
    assert main.main(["solve", str(table), "-o", str(out)]) == 0
    assert "empty where a case has no such quantity: " in capsys.readouterr().err
    data = read_whole(out)
    assert np.isnan(data["gap_field"].values).tolist() == [True] * 5 + [False]
    assert data["gap_field"].attrs["comment"] == "no number where a case has none"
    ball: dict[str, Any] = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 1.0}
    disc: dict[str, Any] = {"material": "BaTiO3", "profile": "disc", "width": 1e-4, "force": 1.0}
    cases: list[dict[str, Any]] = [
        {"material": "BaTiO3", "radius": 0.05, "load": 1e4, "friction": 0.1, "punch": "steel"},
        ball, ball | {"thickness": 1e-4, "base": "steel", "surroundings": "insulated", "punch": "brass"},
        disc | {"electric": "insulating"},
        {"material": "PZT-4", "radius": 0.05, "load": 1e4, "thickness": 2e-4, "base": "rigid",
         "surroundings": "insulated"},
        {"material": "PZT-4", "radius": 0.05, "load": 1e4, "thickness": 2e-4, "base": "steel", "surroundings": "air",
         "gap_permittivity": 2.2, "magnetic": "insulating"},
    ]  # fmt: skip
    for row, case in enumerate(cases):
        exact = solver.solve(case)
        for name in set(exact.data_vars) | set(data.data_vars):
            value = float(data[str(name)][row])
            known = name in exact and name not in POINT_SLIDING  # the column of frictions gives points theirs
            assert not known or value == pytest.approx(float(exact[name]), rel=1e-9), (row, name)
            assert known or np.isnan(value) or name in POINT_SLIDING, (row, name)
    np.testing.assert_array_equal(data["radius"], [0.05, 5e-3, 5e-3, np.nan, 0.05, 0.05])
    assert main.main(["solve", str(table), "-o", str(sheet)]) == 0
    rows = list(csv.DictReader(sheet.read_text(encoding="utf-8").splitlines()))
    assert float(rows[1]["contact_radius [m]"]) == float(data["contact_radius"][1])
    assert (rows[0]["contact_radius [m]"], rows[4]["base"], rows[1]["base"]) == ("", "rigid", "")
    assert main.main(["solve", str(table), "-o", str(sheet), "--positions", "0"]) == 2


def test_fields_inside_films_end_at_a_rigid_base(tmp_path: Path) -> None:
    table, out = tmp_path / "films.csv", tmp_path / "inside.nc"
    rows = "".join(f"PZT-4,0.05,1e5,0.5,{base},insulated\n" for base in ("rigid", "steel"))
    table.write_text(f"material,radius,load,thickness [mm],base,surroundings\n{rows}", encoding="utf-8")
    grid = ["--x=0,0.5", "--y=-4,-0.5", "--fields=stress_yy,von_mises"]
    assert main.main(["interior", str(table), "-o", str(out), *grid]) == 0
    data = read_whole(out)
    assert np.isnan(data["von_mises"].values).any(axis=2).tolist() == [[True, False], [False, False]]
    assert np.all(data["stress_yy"].values[:, 1] < 0)


def test_the_place_between_two_patches_is_told_as_far_as_the_noise_lets_it() -> None:
    """On a device: sqrt(2) of the charge noise over what the difference of both charges changes by a metre."""
    cover = solver.Stack([solver.Layer(solver.find("PDMS"), 1e-3, "grounded"), solver.Layer(solver.find("PVDF"), 1e-4)])
    case: dict[str, Any] = {"profile": "sphere", "radius": 0.01, "force": 0.5, "punch": "skin", "body": cover}
    read = {"electric": "insulating", "magnetic": "insulating", "collector": 2, "patch_size": 2e-3}
    gradient = float(solver.solve(case | read | {"patch_pitch": 4e-3})["patch_charge_gradient"])
    step = 1e-6
    places = np.array([2e-3 - step, 2e-3 + step, -2e-3 - step, -2e-3 + step])
    charges = solver.solve(case | read | {"patch_position": places})["patch_charge_per_force"].values
    moved = (
        0.5 * ((charges[3] - charges[2]) - (charges[1] - charges[0])) / (2 * step)
    )  # of the difference, by the contact's place
    figure = grammar.parse("position_resolution", "point")
    known = {"charge_noise": 1e-15, "patch_charge_gradient": gradient, "force": 0.5}
    resolution = float(figure.evaluate({name: np.array(known[name]) for name in figure.names()}))
    assert resolution == pytest.approx(np.sqrt(2) * 1e-15 / abs(moved), rel=1e-4)
