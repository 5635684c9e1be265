"""A source that says itself that it was not read is marked."""

import pytest

from workflow.language.evidence import unverified


@pytest.mark.parametrize("source", ["a table, recalled", "a value, not read at its source", "somebody's code"])
def test_what_was_not_read_is_marked(source: str) -> None:
    assert unverified(source) == " (unverified: not read at its source)"


def test_what_was_read_is_not_marked() -> None:
    assert unverified("a vendor's table, read; recalledness is no word of it") == ""
