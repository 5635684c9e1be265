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
from workflow.design.verdict import multipliers, netcdf
from workflow.design.verdict.answer import (
    Answer,
    Category,
    Choice,
    Constant,
    End,
    Figure,
    Overload,
    Range,
    Role,
    Sensitivity,
    Term,
    Tolerated,
    Variable,
)
from workflow.design.verdict.leftout import LeftOut
from workflow.design.wording import table, words
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


def test_a_file_holds_all_of_an_answer(tmp_path: Path) -> None:
    write_whole(netcdf.entire(ANSWER), tmp_path / "mine.nc")
    stored = netcdf.read(tmp_path / "mine.nc")
    assert stored.terms[1] == LIMIT
    assert stored.terms[0].statement == GOAL.statement
    assert np.isnan(stored.terms[0].limit)
    assert replace(stored, terms=()) == replace(ANSWER, terms=())
    np.testing.assert_array_equal(stored.pictures["map_objective"], np.eye(2))
    data = read_whole(tmp_path / "mine.nc")
    assert data.attrs["goal"] == "minimise abs(voltage) / load"
    assert data["edge"].values.tolist() == ["upper end of the range asked for", ""]
    whole = netcdf.together([data, data.assign_coords(target="other")])
    assert whole["target"].values.tolist() == ["mine", "other"]
    assert whole["feasible"].values.all()


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


def design(
    exact: list[float],
    limits: list[float],
    elasticity: list[list[float]],
    ends: tuple[End | None, End | None] = (None, None),
    *,
    maximise: bool = True,
    matters: tuple[bool, bool] = (True, True),
) -> Answer:
    """A design of radius and load with stroke_per_volt for its goal, trailing_tension and peak_pressure limited."""
    goal = statements.objective("stroke_per_volt", maximise=maximise)
    terms = [replace(GOAL, statement=goal, exact=exact[0], units="m V-1", effect=(), spread=np.nan)]
    stated = ["trailing_tension <= 50 MPa", "peak_pressure <= 500 MPa"]
    for text, value, limit in zip(stated, exact[1:], limits, strict=False):
        room = (limit - value) / limit
        bounded = replace(LIMIT, statement=statements.limit(text), exact=value, limit=limit, margin=room, bound="")
        terms.append(replace(bounded, source="", effect=(), spread=np.nan))
    variables = [
        Variable(name, value, Role.VARIABLE, Sensitivity(tuple(slopes), matters=matter), edge=end)
        for name, value, slopes, matter, end in zip(
            ("radius", "load"), (0.2, 1e4), elasticity, matters, ends, strict=True
        )
    ]
    return Answer(tuple(terms), tuple(variables))


def test_a_limit_or_nothing_stops_a_recommended_design() -> None:
    held = words.verdict(design([1e-9, 50e6, 1e6], [50e6, 500e6], [[1.0, 1, 0], [2, 2, 0]]))
    assert str(held) == "Recommended: limited by tension behind the contact of 50 MPa."
    free = words.verdict(design([1e-9, 5e6, 1e6], [50e6, 500e6], [[0.0, 1, 0], [0, 2, 0]], matters=(False, True)))
    assert str(free).startswith("Recommended: ")
    assert "radius" in free.without_effect
    assert words.spread(design([1e-9, 5e6, 1e6], [50e6, 500e6], [[0.0, 1, 0], [0, 2, 0]])) == ""  # no constants


@pytest.mark.parametrize(("farther", "goal"), [(2.0, 1e-9), (3.0, 1e-9), (2.0, -1e-9)])
def test_an_end_is_worth_its_multiplier(farther: float, goal: float) -> None:
    """R^n P under R P <= constant, R at its upper end: P follows R, so that the goal grows as R^(n-1)."""
    answer = design([goal, 50e6], [50e6], [[farther, 1.0], [1.0, 1.0]], (End.UPPER, None),
                    maximise=goal > 0)  # fmt: skip
    judged = words.verdict(answer)
    assert judged.kind == words.AT_EDGE
    weights = multipliers.multipliers(answer, answer.limits, answer.at_ends)
    assert weights == pytest.approx({"radius": farther - 1})
    assert "200 mm" in judged.stops
    assert "tension behind the contact of 50 MPa" in judged.stops
    assert judged.advice == f"To first order, radius 220 mm would gain {10 * (farther - 1):g} %."


def test_an_end_beyond_which_nothing_is_gained_does_not_stop_a_design() -> None:
    upper = End.UPPER
    judged = words.verdict(design([1e-9, 5e6], [50e6], [[1e-5, 1.0], [1.0, 1.0]], (upper, upper)))
    assert judged.kind == words.AT_EDGE
    assert "10 kN/m" in judged.stops
    assert judged.advice == "To first order, load 11 kN/m would gain 10 %."
    assert "radius (200 mm" in judged.without_effect
    alone = words.verdict(design([1e-9, 50e6], [50e6], [[1e-5, 0.0], [1.0, 1.0]], (upper, None)))
    assert alone.kind == words.RECOMMENDED
    unexplained = design([1e-9, 5e6], [50e6], [[1.0, 1.0], [1.0, 1.0]], (End.UPPER, None))
    assert multipliers.multipliers(unexplained, [], unexplained.at_ends) == {}
    assert words.verdict(unexplained).advice == "A wider range may allow a better design."  # promises no number


@pytest.mark.parametrize("matters", [True, False])  # to the goal, which is not what is missed
def test_a_miss_says_by_how_much_and_what_would_help(matters: bool) -> None:
    answer = design([1e-9, 91.751e6], [50e6], [[1.0, -0.5], [1.0, 1.0]], (End.UPPER, None),
                    matters=(matters, True))  # fmt: skip
    judged = words.verdict(answer)
    assert judged.kind == words.UNREACHABLE
    for number in ("91.8 MPa", "50 MPa", "83.5 %"):
        assert number in judged.stops
    for number in ("91.8 MPa", "radius 220 mm", "5 %"):
        assert number in judged.advice


def test_a_limit_of_the_material_is_named_with_its_source_and_linear_theory_comes_first() -> None:
    answer = design([1e-9, 25e6, 1e6], [25e6, 500e6], [[1.0, 1, 0], [2, 2, 0]])
    statement = statements.limit("trailing_tension <= 0.5 tensile_strength")
    limit = replace(answer.terms[1], statement=statement, bound="tensile strength of PZT", source="a table")
    answer = replace(answer, terms=(answer.terms[0], limit), beyond="nominal field of 2 kV/mm exceeds it (a book)")
    judged = words.verdict(answer)
    assert judged.kind == "beyond linear theory; otherwise recommended"
    assert judged.stops == "limited by tension behind the contact of 25 MPa (50 % of the tensile strength of PZT)."
    assert judged.beyond == "Nominal field of 2 kV/mm exceeds it (a book)."
    assert judged.sources == "Tensile strength of PZT: a table (unverified: no dated source)."
    assert str(judged).startswith("Beyond linear theory; otherwise recommended: limited by")
