"""What a source says of itself: whether it was read, or is told from memory."""

import re

_NOT_READ = re.compile(r"\b(recalled|not read|somebody's code)\b")  # words of sources


def unverified(source: str) -> str:
    """A mark for a source that says itself that it was not read.

    Examples
    --------
    >>> unverified("a vendor's table, recalled"), unverified("a vendor's table, read")
    (' (unverified: not read at its source)', '')
    """
    return " (unverified: not read at its source)" if _NOT_READ.search(source) else ""
