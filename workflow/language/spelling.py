"""What may have been meant by a name that is not known."""

from difflib import get_close_matches

from workflow.language.wordings import TITLES

_CALLED = {words.replace(" ", "_"): name for name, words in TITLES.items()}
_MANY = 20  # more than a reader looks through


def nearest(name: str, known: list[str]) -> str:
    """``did you mean ...? allowed: ...`` for a name that is not known: by what the page calls it, else by its letters.

    Of many names the one that was meant is enough.
    """
    called = _CALLED.get(name.strip().replace(" ", "_"))
    near = [called] if called in known else get_close_matches(name, known, 1, 0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    if hint and len(known) > _MANY:
        return f"{hint}all names: meecontact list"
    return f"{hint}allowed: {', '.join(known)}"
