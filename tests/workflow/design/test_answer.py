"""An answer survives its file, and its tables say what it holds."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from storage.netcdf import read_whole, write_whole
from workflow.design.verdict import netcdf
from workflow.design.verdict.answer import Answer, Category, Choice, Constant, Figure, Overload, Range, Tolerated
from workflow.design.verdict.leftout import LeftOut
from workflow.design.verdict.term import Term
from workflow.design.verdict.variable import End, Role, Sensitivity, Variable
from workflow.design.wording import table
from workflow.language import statements

CASE = {"radius": 0.105, "load": 1e4}
GOAL = Term(
    statements.objective("abs(voltage) / load", maximise=False), predicted=1.01, predicted_std=0.01, half=0.02,
    exact=1.0,
    inside=True, limit=np.nan, margin=np.nan, units="V m N-1", bound="", source="", worst=CASE, effect=(0.03, 0.04),
    spread=0.05,
)  # fmt: skip
LIMIT = replace(
    GOAL, statement=statements.limit("trailing_tension <= 0.5 tensile_strength"), limit=2e7, exact=1.9e7, margin=0.05,
    units="Pa", bound="tensile strength of PZT", source="a table", inside=False,
)  # fmt: skip
RADIUS = Variable(
    "radius", 0.1, Role.VARIABLE, Sensitivity((0.5, -1.0), 0.01, 0.02, False, 0.03), "5 %", End.UPPER_ASKED
)
LOAD = Variable("load", 1e4, Role.WORST_CASE, Sensitivity((1.0, 1.0), 0.1, 0.2, True, 0.3))
ANSWER = Answer(
    terms=(GOAL, LIMIT),
    variables=(RADIUS, LOAD),
    ranges=(Range("voltage", -1.0, 2.0),),
    beyond="nominal field exceeds it (a book)",
    exceeded=("nominal field exceeds it",),
    flags="nominal field exceeds it",
    target="mine",
    statistic="worst-case",
    polish="on the exact solver",
    source="a test",
    figures=(Figure("force", 1.0, 2.0),),
    overload=Overload(1.5, "trailing_tension <= 0.5 tensile_strength"),
    constants=(Constant("c11", "5 %"), Constant("e31", "10 %")),
    tolerated=Tolerated({"radius": 0.1}, {"radius": 0.05}, {"radius": 0.11}, 1.1, "PZT"),
    left_out=(LeftOut("heat", "signal", 1.0, 0.5, "K", 2.0, 40.0, "heat is 2 times the signal", "Heat is it."),),
    categories=(Category("material", "PZT", Role.VARIABLE), Category("profile", "flat", Role.GIVEN)),
    choices=(Choice("PZT", 1.0, True), Choice("PVDF", 2.0, False)),
    pictures=xr.Dataset({"map_objective": (("map_x", "map_y"), np.eye(2))}),
)


@pytest.mark.parametrize(
    "bare",
    [
        {},
        {
            "figures": (),
            "overload": None,
            "constants": (),
            "tolerated": None,
            "categories": (),
            "choices": (),
            "left_out": (),
        },
    ],
)
def test_a_file_holds_all_of_an_answer(tmp_path: Path, bare: dict[str, object]) -> None:
    terms = [replace(GOAL, effect=(), spread=0.0), replace(LIMIT, effect=(), spread=0.0)] if bare else [GOAL, LIMIT]
    answer = replace(ANSWER, terms=tuple(terms), **bare)  # type: ignore[arg-type]
    write_whole(netcdf.entire(answer), tmp_path / "mine.nc")
    stored = netcdf.read(tmp_path / "mine.nc")
    assert stored.terms[1] == (replace(LIMIT, effect=(), spread=stored.terms[1].spread) if bare else LIMIT)
    assert stored.terms[0].statement == GOAL.statement
    assert np.isnan(stored.terms[0].limit)
    assert replace(stored, terms=()) == replace(answer, terms=())
    np.testing.assert_array_equal(stored.pictures["map_objective"], np.eye(2))
    data = read_whole(tmp_path / "mine.nc")
    assert data.attrs["goal"] == "minimise abs(voltage) / load"
    assert data["edge"].values.tolist() == ["upper end of the range asked for", ""]
    whole = netcdf.together([data, data.assign_coords(target="other")])
    assert whole["target"].values.tolist() == ["mine", "other"]
    assert whole["feasible"].values.all()


def test_the_status_says_what_binds_and_what_is_missed() -> None:
    assert ANSWER.status == "feasible; binding: none; radius of no effect on the goal"
    missed = replace(ANSWER, terms=(GOAL, replace(LIMIT, margin=-0.1234)))
    assert missed.status == (
        "infeasible: trailing_tension <= 0.5 tensile_strength binds; the least violated design misses it by 12.3 %"
    )
    assert missed.broken == missed.limits
    assert ANSWER.case == {"radius": 0.1, "load": 1e4}


def test_tables_hold_the_numbers() -> None:
    content = json.loads(table.as_json(ANSWER))
    assert content["factors"]["radius"] == {"value": 0.1, "role": "variable", "units": "m", "tolerance": "5 %"}
    assert content["terms"][LIMIT.name]["margin"] == 0.05
    assert content["terms"][GOAL.name]["limit"] is None
    assert content["categories"] == {"material": {"value": "PZT", "role": "variable"},
                                  "profile": {"value": "flat", "role": "given"}}  # fmt: skip
    rows = {row[2]: row for row in csv.reader(io.StringIO(table.as_csv([ANSWER])))}
    assert rows["radius"] == ["mine", "variable", "radius", "m", "", "", "0.1", "", "", ""]
    assert rows[LIMIT.name][-1] == "0"
    lines = table.as_text(ANSWER).splitlines()
    assert lines[0] == "minimise abs(voltage) / load"
    assert any(line.split() == ["radius", "100", "mm", "variable,", "within", "5", "%"] for line in lines)
    assert any(line.split()[:2] == ["PVDF", "2"] and line.endswith("infeasible") for line in lines)
    plain = table.as_text(ANSWER, si=True).splitlines()
    assert any(line.split() == ["radius", "0.1", "m", "variable,", "within", "5", "%"] for line in plain)
