"""Quantities that the exact solver searches for, milliseconds a case, and how a design question spends such cases.

A case of the closed-form quantities costs microseconds, so that a design question may ask for many thousands. One of
`solver.names.PEAKS` costs 6 ms in a batch and 18 ms scattered: a question solves `AFFORDABLE` of them in each of its
parts (the polish, the front), some seconds to 18. They go to the scenarios that decide what a term counts as; in all
others the surrogate is believed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from solver.names import PEAKS
from workflow.design.question import Question
from workflow.design.scenarios import Scenarios
from workflow.design.sources import Exact, Factors, Predicted, Source
from workflow.design.terms import Term

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

#: Searched cases of one part of a question.
AFFORDABLE = 1000
_MOST = 256  # of one value of one term
_LEAST = 9  # designs of a front
_BATCH = 12  # scenarios solved at a time, at least: a dozen cost as much as three alone
_AWAY = 3e-7  # relative distance kept from a limit: near a kink a shift leaves 0.14 of what it corrects
_REST = 1e-3  # share of all weight that scenarios may have which are not among those that decide


def names(term: Term) -> list[str]:
    """Quantities of a term that are searched for."""
    return [name for name in term.expression.names() if name in PEAKS]


def asked(question: Question) -> bool:
    """Whether some term of a question asks for them."""
    return any(names(term) for term in question.terms)


class Spared:
    """The exact solver but for what it searches for, which comes from the surrogate."""

    step: float | None = Exact.step

    def __init__(self, exact: Exact, predicted: Predicted) -> None:
        self._exact, self._predicted = exact, predicted

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Quantities by name."""
        searched = [name for name in names if name in PEAKS]
        closed = [name for name in names if name not in PEAKS]
        out = self._exact.values(factors, closed) if closed else {}
        return out | (self._predicted.values(factors, searched) if searched else {})

    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        """Not given, as those of the exact solver."""
        return self._exact.slopes(factors, names, over)


def spared(question: Question, predicted: Predicted, exact: Exact) -> Source:
    """What stands for the exact solver where a question asks for many cases, as in difference quotients."""
    return Spared(exact, predicted) if asked(question) else exact


def away(question: Question, usual: float) -> float:
    """Relative distance that a polish keeps from the limits; more where the surrogate leads it."""
    return _AWAY if asked(question) else usual


def words(question: Question, cases: int, moved: bool) -> str:
    """How a design was polished: on the exact solver alone, led by the surrogate, or not at all."""
    searched = ", ".join(dict.fromkeys(name for term in question.terms for name in names(term)))
    if not searched:
        return "on the exact solver"
    if not moved:
        return f"none; as far from the limits as the interval of the surrogate asks for ({cases} searched cases)"
    shifted = f", limits shifted to exact values ({cases} searched cases)" if cases else ""
    return f"on the exact solver; {searched} led by the surrogate{shifted}"


@dataclass(frozen=True)
class Settled:
    """What a term counts as at a design, exactly where it matters, and how many searched cases that took."""

    value: float
    cases: int


def settle(question: Question, x: Array, term: Term, predicted: Predicted, exact: Exact) -> Settled:
    """The exact value of a term over the many scenarios of the verdict, from those that decide it.

    The surrogate says which these are; they are solved, and so are those that decide then or may do so by the errors
    that the surrogate has shown, until none is left. Where a great many decide, as in a mean, all of the few scenarios
    of the search are solved instead, and the surrogate says what the many change.
    """
    many, few = question.judged[term.drawn], question.searched[term.drawn]
    if _deciding(term, _guess(question, x, many, term, predicted)).sum() <= _MOST:
        return _solved(question, x, many, term, predicted, exact)
    found = _solved(question, x, few, term, predicted, exact)
    whole, part = (_row(term, _guess(question, x, one, term, predicted))[0] for one in (many, few))
    return Settled(found.value + whole - part, found.cases)


def _solved(question: Question, x: Array, chosen: Scenarios, term: Term, predicted: Predicted, exact: Exact) -> Settled:
    factors = question.factors(x[None], chosen)
    values = _guess(question, x, chosen, term, predicted)
    flat = values.ravel()
    known, error = np.zeros(chosen.count, dtype=bool), 0.0
    while True:
        value, deciding = _row(term, values)[0], _deciding(term, values)
        away = np.abs(flat - value)
        # what the surrogate may have put on the wrong side of those that decide, by twice its largest error so far
        rivals = (away <= 2 * error) & ~known if known.sum() < _MOST else np.zeros_like(known)
        missing = (deciding | rivals) & ~known
        if not missing.any():
            return Settled(value, int(known.sum()))
        order = np.argsort(np.where(known, np.inf, np.where(missing, -1.0, away)), kind="stable")
        some = order[: min(max(_BATCH, int(missing.sum())), int((~known).sum()))]
        found = _at(question, factors, chosen, some, [term], exact)[0][0]
        error = max(error, float(np.abs(found - flat[some]).max()))
        flat[some], known[some] = found, True


def thinned(question: Question, x: Array, predicted: Predicted, share: float) -> tuple[Array, dict[bool, Indices]]:
    """Of designs (n, d) in a row, evenly, as many as a share of all cases suffices for.

    With the scenarios of the search in which they are solved: those that decide some term at some design by the
    surrogate.
    """
    some: dict[bool, Indices] = {}
    for drawn, chosen in question.searched.items():
        terms = _members(question, drawn).values()
        values = question.values(predicted, question.factors(x, chosen), chosen, list(terms)) if terms else []
        marks = [_deciding(term, one[None]) for term, each in zip(terms, values, strict=True) for one in each]
        if marks:
            some[drawn] = np.flatnonzero(np.any(marks, 0))
    if not some:
        return x, some
    count = max(_LEAST, int(share * AFFORDABLE / sum(len(one) for one in some.values())))
    return np.asarray(x[np.unique(np.linspace(0, len(x) - 1, min(count, len(x))).astype(int))]), some


def corrected(
    question: Question, x: Array, counted: Array, some: Mapping[bool, Indices], predicted: Predicted, exact: Exact
) -> Array:
    """What all terms count as at designs, (n, terms), with the scenarios that `thinned` gave solved exactly."""
    out = counted.copy()
    for drawn, columns in some.items():
        chosen, members = question.searched[drawn], _members(question, drawn)
        factors, terms = question.factors(x, chosen), list(members.values())
        guessed = question.values(predicted, factors, chosen, terms)
        solved = _at(question, factors, chosen, columns, terms, exact)
        for k, term, values, found in zip(members, terms, guessed, solved, strict=True):
            flat = np.array(values).reshape(len(x), -1)
            flat[:, columns] = found
            out[:, k] = term.worst(term.statistic.rows(flat.reshape(values.shape)))
    return out


def _members(question: Question, drawn: bool) -> dict[int, Term]:
    """Terms over draws, or over corners, that ask for what is searched for, by their place."""
    return {k: term for k, term in enumerate(question.terms) if names(term) and term.drawn == drawn}


def _at(
    question: Question, factors: Factors, chosen: Scenarios, columns: Indices, terms: list[Term], exact: Exact
) -> list[Array]:
    """Exact values of some terms in some scenarios, (n, columns) each."""
    part = {name: one[:, columns] if one.shape[1] > 1 else one for name, one in factors.items()}
    single = replace(chosen, groups=len(columns), draws=1)
    return [one.reshape(len(one), -1) for one in question.values(exact, part, single, terms)]


def _guess(question: Question, x: Array, chosen: Scenarios, term: Term, predicted: Predicted) -> Array:
    """A term on the surrogate, (1, groups, draws)."""
    return np.array(question.values(predicted, question.factors(x[None], chosen), chosen, [term])[0])


def _row(term: Term, values: Array) -> tuple[float, int]:
    """The value that decides, and its row."""
    rows = term.statistic.rows(values)[0]
    value = float(term.worst(rows))
    return value, int(np.flatnonzero(rows == value)[0])


def _deciding(term: Term, values: Array) -> NDArray[np.bool_]:
    """Which scenarios make the row that decides, the fewest that do; (scenarios,)."""
    weights = np.abs(term.statistic.jacobian(values[0])[_row(term, values)[1]])
    order = np.argsort(weights)
    kept = np.ones(weights.size, dtype=bool)
    kept[order[np.cumsum(weights[order]) <= _REST * weights.sum()]] = False
    return kept
