"""Probable meaning of a name that is not known."""

from collections.abc import Collection
from difflib import get_close_matches

from workflow.language.wordings import TITLES

_CALLED = {words.replace(" ", "_"): name for name, words in TITLES.items()}
_MANY = 20  # more than a reader looks through


def meant(name: str, known: Collection[str]) -> str | None:
    """The name of ``known`` that the page calls so; None where there is none."""
    called = _CALLED.get(name.strip().replace(" ", "_"))
    return called if called in known else None


def nearest(name: str, known: list[str]) -> str:
    """``did you mean ...? allowed: ...`` for a name that is not known, without the list where it is long."""
    called = meant(name, known)
    near = [called] if called else get_close_matches(name, known, 1, 0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    if hint and len(known) > _MANY:
        return f"{hint}all names: meecontact list"
    return f"{hint}allowed: {', '.join(known)}"
