"""Verdicts in words: what an optimum's own conditions say, on goals whose best is known by hand."""

from typing import Any

import numpy as np
import pytest

from workflow.design.verdict import multipliers
from workflow.design.verdict.answer import Answer
from workflow.design.verdict.term import Term
from workflow.design.verdict.variable import End, Role, Sensitivity, Variable
from workflow.design.wording import words
from workflow.language import statements


def design(
    exact: list[float],
    limits: list[float],
    elasticity: list[list[float]],
    edge: tuple[End | None, End | None] = (None, None),
    *,
    maximise: bool = True,
    **changes: Any,
) -> Answer:
    """A design of radius and load with stroke_per_volt for its goal, trailing_tension and peak_pressure limited."""
    tension = changes.get("tension", "trailing_tension <= 50 MPa")
    stated = [
        statements.objective("stroke_per_volt", maximise=maximise),
        *map(statements.limit, (tension, "peak_pressure <= 500 MPa")),
    ]
    bounds = changes.get("bound", ["", "", ""])
    terms = [
        Term(
            statement, predicted=value, predicted_std=0.0, half=0.0, exact=value, inside=True, limit=limit,
            margin=(limit - value) / limit, units=units, bound=bound, source=source, worst={},
        )
        for statement, value, limit, units, bound, source in zip(
            stated, exact, [np.nan, *limits], ["m V-1", "Pa", "Pa"], bounds, ["", "a table", "another"], strict=False
        )
    ]  # fmt: skip
    matters = changes.get("matters", [True, True])
    variables = [
        Variable(name, value, Role.VARIABLE, Sensitivity(tuple(slopes), matters=matter), edge=end)
        for name, value, slopes, matter, end in zip(
            ("radius", "load"), (0.2, 1e4), elasticity, matters, edge, strict=True
        )
    ]
    return Answer(tuple(terms), tuple(variables), beyond=changes.get("beyond", ""))


def test_a_limit_or_nothing_stops_a_recommended_design() -> None:
    held = words.verdict(design([1e-9, 50e6, 1e6], [50e6, 500e6], [[1.0, 1, 0], [2, 2, 0]]))
    assert str(held) == "Recommended: limited by tension behind the contact of 50 MPa."
    free = words.verdict(design([1e-9, 5e6, 1e6], [50e6, 500e6], [[0.0, 1, 0], [0, 2, 0]], matters=[False, True]))
    assert str(free).startswith("Recommended: ")
    assert "radius" in free.idle


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
    assert "radius (200 mm" in judged.idle
    alone = words.verdict(design([1e-9, 50e6], [50e6], [[1e-5, 0.0], [1.0, 1.0]], (upper, None)))
    assert alone.kind == words.RECOMMENDED
    unexplained = design([1e-9, 5e6], [50e6], [[1.0, 1.0], [1.0, 1.0]], (End.UPPER, None))
    assert multipliers.multipliers(unexplained, [], unexplained.at_ends) == {}
    assert words.verdict(unexplained).advice == "A wider range may allow a better design."  # promises no number


@pytest.mark.parametrize("matters", [True, False])  # to the goal, which is not what is missed
def test_a_miss_says_by_how_much_and_what_would_help(matters: bool) -> None:
    answer = design([1e-9, 91.751e6], [50e6], [[1.0, -0.5], [1.0, 1.0]], (End.UPPER, None),
                    matters=[matters, True])  # fmt: skip
    judged = words.verdict(answer)
    assert judged.kind == words.UNREACHABLE
    for number in ("91.8 MPa", "50 MPa", "83.5 %"):
        assert number in judged.stops
    for number in ("91.8 MPa", "radius 220 mm", "5 %"):
        assert number in judged.advice


def test_a_limit_of_the_material_is_named_with_its_source_and_linear_theory_comes_first() -> None:
    answer = design([1e-9, 25e6, 1e6], [25e6, 500e6], [[1.0, 1, 0], [2, 2, 0]],
                    tension="trailing_tension <= 0.5 tensile_strength",
                    bound=["", "tensile strength of PZT", ""],
                    beyond="nominal field of 2 kV/mm exceeds it (a book)")  # fmt: skip
    judged = words.verdict(answer)
    assert judged.kind == "beyond linear theory; otherwise recommended"
    assert judged.stops == "limited by tension behind the contact of 25 MPa (50 % of the tensile strength of PZT)."
    assert judged.beyond == "Nominal field of 2 kV/mm exceeds it (a book)."
    assert judged.sources == "Tensile strength of PZT: a table (unverified: no dated source)."
    assert str(judged).startswith("Beyond linear theory; otherwise recommended: limited by")
