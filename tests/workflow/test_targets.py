"""The language of design targets is a fixed grammar."""

import pytest

from workflow import targets


def test_reads_terms_and_limits() -> None:
    assert targets.objective(" abs( voltage_sensitivity ) ") == targets.Term("voltage_sensitivity", absolute=True)
    assert targets.objective("depth") == targets.Term("depth")
    assert targets.limit("trailing_tension<5e7") == targets.Limit(targets.Term("trailing_tension"), 5e7)
    assert str(targets.limit("abs(voltage) <= -.5")) == "abs(voltage) <= -0.5"


@pytest.mark.parametrize(
    "text",
    ["", "depth()", "depth + 1", "__import__('os').system('true')", "abs(depth", "depth.real", "abs(abs(depth))", "1"],
)
def test_refuses_everything_else(text: str) -> None:
    with pytest.raises(ValueError, match="is not"):
        targets.objective(text)


@pytest.mark.parametrize("text", ["depth", "depth < x", "depth <= 1e", "depth <= nan", "depth = 1", "1 < depth < 2"])
def test_refuses_other_limits(text: str) -> None:
    with pytest.raises(ValueError, match="is not"):
        targets.limit(text)


def test_names_the_nearest_quantity() -> None:
    with pytest.raises(ValueError, match="did you mean 'voltage_sensitivity'"):
        targets.objective("abs(voltage_sensitivty)")
