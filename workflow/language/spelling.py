"""What may have been meant by a name that is not known."""

from difflib import get_close_matches


def nearest(name: str, known: list[str]) -> str:
    """``did you mean ...? allowed: ...`` for a name that is not known."""
    near = get_close_matches(name, known, 1, 0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"{hint}allowed: {', '.join(known)}"
