"""Terms counted over scenarios, by hand: kinks, margins, bounds without a unit."""

import numpy as np
import pytest

from workflow.design.question import terms
from workflow.design.question.pilot import smooth_pieces
from workflow.language import statements, statistics
from workflow.language.grammar import parse


def term(text: str, bound: float) -> terms.Term:
    """A limit over the worst case."""
    return terms.limited(statements.limit(text), 1.0, bound, drawn=False)


def test_a_limit_counts_its_largest_use_and_an_objective_its_least() -> None:
    values = np.array([[[1.0, 4.0], [3.0, 2.0]]])
    upper = term("voltage <= 2 V", 2.0)
    assert upper.counted(values) == [4.0]
    assert upper.oriented(4.0) == pytest.approx(1.0)  # excess over the bound, relative
    assert upper.weights(values[0]).tolist() == [0, 1, 0, 0]
    assert upper.deciding(values[0]).tolist() == [False, True, False, False]
    goal = terms.wanted(statements.objective("voltage"), statistics.Worst())
    assert goal.counted(values) == [1.0]
    mean = terms.wanted(statements.objective("voltage"), statistics.Mean(1.0))
    assert mean.counted(values) == pytest.approx([1.0])  # the lesser of 2.5 - 1.5 and 2.5 - 0.5, groups of two draws


def test_two_limits_meet_in_an_equality() -> None:
    upper, lower = term("voltage <= 2 V", 2.0), term("voltage >= 2 V", 2.0)
    assert upper.meets(lower)
    assert not upper.meets(term("voltage >= 1 V", 1.0))
    assert not upper.meets(upper)


@pytest.mark.parametrize("text", ["min(load, 2 - load)", "-abs(load - 1)", "-max(abs(load), 0.5)"])
def test_the_least_of_smooth_pieces_is_the_expression(text: str) -> None:
    known = {"load": np.linspace(-3, 3, 61)}
    expression = parse(text)
    pieces = smooth_pieces(expression, 1.0, known)
    assert len(pieces) > 1
    least = np.min([np.broadcast_to(piece.evaluate(known), 61) for piece in pieces], 0)
    np.testing.assert_allclose(least, expression.evaluate(known), atol=1e-12)
    assert smooth_pieces(expression, -1.0, known) == [expression]  # the most of them is no least
