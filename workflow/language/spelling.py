"""Suggestions for a name that is not known."""

from collections.abc import Collection, Sequence
from difflib import get_close_matches

from workflow.language.wordings import RENAMED, TITLES

_MANY = 20  # names, more than a reader looks through
_NEAR = 0.65  # share of common letters: below it lie other words, as mass and base
_BEGUN = 5  # letters of a name that is not written to its end


def suggested(name: str, known: Collection[str]) -> str | None:
    """Return the known name nearest to a name, compared with known names, titles and old names; None if none is."""
    known_by_word = {words.replace(" ", "_"): title for title, words in TITLES.items() if title in known}
    # a line has a voltage per load, a point one per force
    renamed = {old: (new, new.replace("_per_load", "_per_force")) for old, new in RENAMED.items()}
    known_by_word |= {old: new for old, both in renamed.items() for new in reversed(both) if new in known}
    from solver.arrays import SYNONYMS  # with numpy, which the help does without

    known_by_word |= {word: meant for word, meant in SYNONYMS.items() if meant in known}
    known_by_word |= {word: word for word in known}
    word = name.strip().replace(" ", "_")
    begun = [candidate for candidate in known_by_word if len(word) >= _BEGUN and candidate.startswith(word)]
    near = sorted(begun, key=len) or get_close_matches(word, known_by_word, 1, _NEAR)
    return known_by_word[near[0]] if near else None


def nearest(name: str, known: Sequence[str]) -> str:
    """Return ``did you mean ...? allowed: ...`` for an unknown name, without the list where that is long."""
    near = suggested(name, known)
    hint = f"did you mean {near!r}? " if near else ""
    if hint and len(known) > _MANY:
        return f"{hint}all names: meecontact list"
    return f"{hint}allowed: {', '.join(known)}"
