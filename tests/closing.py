"""The last line of a test run: what was not run on this machine, and how to get it."""

from collections import Counter
from collections.abc import Sequence

_SKIPPED = "Skipped: "


def closing(reasons: Sequence[str]) -> str:
    """One line for the reasons for which tests were skipped, each of which says how to get what is missing."""
    counted = Counter(reason.removeprefix(_SKIPPED) for reason in reasons)
    parts = [f"{count} test{'s' * (count > 1)}: {reason}" for reason, count in counted.items()]
    return f"not run: {'; '.join(parts)}" if parts else "nothing was left out"
