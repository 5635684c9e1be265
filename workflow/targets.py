"""The small language of design targets: ``abs(quantity)``, ``quantity <= value``. Nothing in it is evaluated."""

import re
from dataclasses import dataclass
from difflib import get_close_matches

from solver.names import EVERY_QUANTITY

_TERM = r"(?:abs\(\s*(?P<absolute>\w+)\s*\)|(?P<plain>\w+))"
_OBJECTIVE = re.compile(rf"\s*{_TERM}\s*")
_LIMIT = re.compile(rf"\s*{_TERM}\s*<=?\s*(?P<value>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*")


def nearest(name: str, known: list[str]) -> str:
    """``did you mean ...? allowed: ...`` for a name that is not known."""
    near = get_close_matches(name, known, 1, 0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"{hint}allowed: {', '.join(known)}"


@dataclass(frozen=True)
class Term:
    """A quantity, or its absolute value."""

    quantity: str
    absolute: bool = False

    def __str__(self) -> str:
        return f"abs({self.quantity})" if self.absolute else self.quantity


@dataclass(frozen=True)
class Limit:
    """An upper bound of a term, in the quantity's SI unit."""

    term: Term
    value: float

    def __str__(self) -> str:
        return f"{self.term} <= {self.value:g}"


def objective(text: str) -> Term:
    """Parse ``quantity`` or ``abs(quantity)``; ValueError otherwise."""
    return _term(_OBJECTIVE.fullmatch(text), text, "quantity or abs(quantity)")


def limit(text: str) -> Limit:
    """Parse ``quantity <= value`` or ``abs(quantity) <= value``; ValueError otherwise."""
    match = _LIMIT.fullmatch(text)
    term = _term(match, text, "quantity <= value")
    return Limit(term, float(match["value"]) if match else 0.0)


def _term(match: re.Match[str] | None, text: str, form: str) -> Term:
    if match is None:
        raise ValueError(f"{text!r} is not of the form {form}")
    name = match["absolute"] or match["plain"]
    if name not in EVERY_QUANTITY:
        raise ValueError(f"{name!r} is not a quantity; {nearest(name, list(EVERY_QUANTITY))}")
    return Term(name, match["absolute"] is not None)
