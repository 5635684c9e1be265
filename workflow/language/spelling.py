"""Suggestions for a name that is not known."""

from collections.abc import Sequence
from difflib import get_close_matches

from workflow.language.wordings import RENAMED, TITLES

_MANY = 20  # names, more than a reader looks through


def nearest(name: str, known: Sequence[str]) -> str:
    """Return ``did you mean ...? allowed: ...`` for an unknown name, compared with known names, titles and old names.

    A long list of allowed names is left out where a name is suggested.
    """
    called = {words.replace(" ", "_"): title for title, words in TITLES.items() if title in known}
    called |= {old: new for old, new in RENAMED.items() if new in known}
    called |= {word: word for word in known}
    near = get_close_matches(name.strip().replace(" ", "_"), called, 1, 0.5)
    hint = f"did you mean {called[near[0]]!r}? " if near else ""
    if hint and len(known) > _MANY:
        return f"{hint}all names: meecontact list"
    return f"{hint}allowed: {', '.join(known)}"
