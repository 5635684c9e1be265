"""A source that says itself that it was not read is marked."""

import re

import pytest

from solver import materials
from workflow.language.wordings import unverified


@pytest.mark.parametrize(
    ("source", "mark"),
    [
        ("a table, recalled", " (unverified: not read at its source)"),
        ("a value, not read at its source", " (unverified: not read at its source)"),
        ("somebody's code", " (unverified: not read at its source)"),
        ("a vendor's table, read in 2026; recalledness is no word of it", ""),
        ("a vendor's table", " (unverified: no dated source)"),
    ],
)
def test_a_source_that_was_not_read_is_marked(source: str, mark: str) -> None:
    assert unverified(source) == mark


def test_what_the_library_says_that_materials_bear_has_a_year_or_is_marked() -> None:
    for material in materials().values():
        for limit in material.limits.values():
            assert re.search(r"\b(19|20)\d\d\b", limit.source) or "recalled" in limit.source, limit.source
