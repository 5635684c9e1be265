"""A source that says itself that it was not read is marked."""

import re

import pytest

from solver import materials
from workflow.language.wordings import unverified


@pytest.mark.parametrize("source", ["a table, recalled", "a value, not read at its source", "somebody's code"])
def test_what_was_not_read_is_marked(source: str) -> None:
    assert unverified(source) == " (unverified: not read at its source)"


def test_what_was_read_is_not_marked() -> None:
    assert unverified("a vendor's table, read in 2026; recalledness is no word of it") == ""
    assert unverified("a vendor's table") == " (unverified: no dated source)"


def test_what_the_library_says_that_materials_bear_has_a_year_or_is_marked() -> None:
    for material in materials().values():
        for limit in material.limits.values():
            assert re.search(r"\b(19|20)\d\d\b", limit.source) or "recalled" in limit.source, limit.source
