"""Evidence of a source: whether it was read, or is recalled from memory."""

import re

_NOT_READ = re.compile(r"\b(recalled|not read|somebody's code)\b")  # words of sources
_YEAR = re.compile(r"\b(19|20)\d\d\b")


def unverified(source: str) -> str:
    """A mark for a source that says itself that it was not read, or that has no year."""
    if _NOT_READ.search(source):
        return " (unverified: not read at its source)"
    return "" if _YEAR.search(source) else " (unverified: no dated source)"
