"""Quantities of which an exact case is costly, and their exact values in the scenarios that decide.

A closed-form case costs microseconds; one of `solver.names.PEAKS` 6 ms in a batch and 18 ms scattered, and one of a
film with tables of its own 30 to 200 ms. A question solves `most` costly cases in each of its parts (polish, front), in
scenarios that decide a term; in all others it takes the surrogate's values.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from approximation.arrays import Array, Indices
from workflow.design.question.question import Question
from workflow.design.question.risk import Key, Term
from workflow.design.question.scenarios import Scenarios
from workflow.design.question.sources import Exact, Factors, Predicted, Source

Bools = NDArray[np.bool_]

#: Most costly cases of one part of a question, in general and on films.
AFFORDABLE, AFFORDABLE_FILMS = 1000, 150
_MOST_SCENARIOS, _MOST_FILMS = 256, 64  # solved scenarios of one term, in general and on films
_LEAST = 9  # designs of a front
_BATCH = 12  # scenarios solved at a time, at least: a dozen peaks cost as much as three alone
_BATCH_FILMS = 3  # the same on films, where each has tables of its own
_SPREAD = 5  # scenarios spread over all, which show the surrogate's common error
#: Relative safety margin that a polish keeps from the limits: near a kink a shifted limit leaves 0.14 of its shift.
SAFETY = 3e-7


def names(question: Question, term: Term) -> list[str]:
    """Return the quantities of a term of which a case is costly."""
    return [name for name in term.expression.names() if name in question.study.costly]


def most(question: Question) -> int:
    """Return the most costly cases of one part of a question."""
    return AFFORDABLE_FILMS if question.study.kind.tabled else AFFORDABLE


def asked(question: Question) -> bool:
    """Return whether some term of a question has a costly quantity."""
    return any(names(question, term) for term in question.terms)


class _Hybrid(Source):
    """The exact solver, but the surrogate for costly quantities."""

    step = Exact.step

    def __init__(self, exact: Exact, predicted: Predicted, costly: frozenset[str]) -> None:
        self._exact, self._predicted, self._costly = exact, predicted, costly

    @override
    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        searched = [name for name in names if name in self._costly]
        closed = [name for name in names if name not in self._costly]
        out = self._exact.values(factors, closed) if closed else {}
        return out | (self._predicted.values(factors, searched) if searched else {})


def affordable(question: Question) -> Source:
    """Return the source in place of the exact solver for many cases, as in difference quotients."""
    if not asked(question):
        return question.exact
    return _Hybrid(question.exact, question.predicted, question.study.costly)


def words(question: Question, cases: int, moved: bool) -> str:
    """Return a description of the polish: on the exact solver alone, led by the surrogate, or none."""
    searched = ", ".join(dict.fromkeys(name for term in question.terms for name in names(question, term)))
    kind = "exact" if question.study.kind.tabled else "searched"
    if not searched:
        return "on the exact solver"
    if not moved:
        return f"none; as far from the limits as the interval of the surrogate asks for ({cases} {kind} cases)"
    shifted = f", limits shifted to exact values ({cases} {kind} cases)" if cases else ""
    return f"{'' if question.study.kind.tabled else 'on the exact solver; '}{searched} led by the surrogate{shifted}"


def count_exactly(design: Question, term: Term) -> tuple[float, int]:
    """Return a term's value at one design in the verdict, with deciding scenarios solved exactly, and their number.

    Where very many scenarios decide, the few of the search are solved, and the surrogate gives the difference.
    """
    many, few = design.judged[term.measure.key], design.searched[term.measure.key]
    whole = design.value(design.predicted, many, term)
    if term.deciding(whole[0]).sum() <= _MOST_SCENARIOS:
        return _count_exactly(design, many, term, whole)
    part = design.value(design.predicted, few, term)
    value, cases = _count_exactly(design, few, term, part)
    return value + float(term.counted(whole)[0]) - float(term.counted(part)[0]), cases


def _count_exactly(design: Question, chosen: Scenarios, term: Term, predicted: Array) -> tuple[float, int]:
    """Solve scenarios of predicted values (1, groups, draws) in batches until all that may decide are solved.

    Scenarios that weigh a thousandth of a mean together are not solved. On films the mean error of the solved
    scenarios, of which the first are spread over all, corrects the predictions of the others.
    """
    values, films = predicted.copy(), design.study.kind.tabled
    flat, solved, error = values.ravel(), np.zeros(chosen.count, dtype=bool), 0.0
    while True:
        value = float(term.counted(values)[0])
        distances = np.abs(flat - value)
        decides = term.deciding(values[0]) & ~solved
        room = (_MOST_FILMS if films else _MOST_SCENARIOS) - int(solved.sum())
        # scenarios that may decide by twice the surrogate's largest error so far
        missing = decides | ((distances <= 2 * error) & ~solved & (room > 0))
        if not missing.any():
            return value, int(solved.sum())
        most = max(room, int(decides.sum())) if films else chosen.count
        order = np.where(decides, -1.0, distances)
        # the nearest first, and as many others as fill a batch
        nearest = np.argsort(np.where(solved, np.inf, order), kind="stable")[: int((~solved).sum())]
        batch = nearest[: max(_BATCH_FILMS if films else _BATCH, int(missing.sum()))][:most]
        if films and not solved.any() and values.shape[2] == 1:
            batch = np.union1d(batch, np.linspace(0, chosen.count - 1, _SPREAD).astype(int))
        exact = _solve(design, chosen, batch, [term])[0][0]
        error = max(error, float(np.abs(exact - flat[batch]).max()))
        flat[batch], solved[batch] = exact, True
        if films:
            mean, spread = _errors(values[0], predicted[0], solved.reshape(values.shape[1:]))
            error = error if values.shape[2] > 1 else spread
            values[0] = np.where(solved.reshape(mean.shape), values[0], predicted[0] + mean)


def _errors(values: Array, predicted: Array, solved: Bools) -> tuple[Array, float]:
    """Return the mean error of solved groups for every draw, (group, draw), and the largest deviation from it."""
    off = np.where(solved, values - predicted, 0.0)
    mean = np.broadcast_to(off.sum(0) / np.maximum(solved.sum(0), 1), off.shape)
    return mean, float(np.abs(np.where(solved, off - mean, 0.0)).max())


def thinned(designs: Question, share: float) -> tuple[Question, dict[Key, Indices]]:
    """Return evenly chosen designs, as many as a share of all costly cases allows, and their deciding scenarios."""
    columns: dict[Key, Indices] = {}
    for drawn, chosen in designs.searched.items():
        terms = [term for term in chosen.terms.values() if names(designs, term)]
        guessed = designs.values(designs.predicted, chosen, terms) if terms else []
        marks = [term.deciding(values) for term, rows in zip(terms, guessed, strict=True) for values in rows]
        if marks:
            columns[drawn] = np.flatnonzero(np.any(marks, 0))
    if not columns:
        return designs, columns
    count = max(_LEAST, int(share * most(designs) / sum(len(indices) for indices in columns.values())))
    n = len(designs.x)
    return designs.at(designs.x[np.unique(np.linspace(0, n - 1, min(count, n)).astype(int))]), columns


def corrected(designs: Question, counts: Array, columns: Mapping[Key, Indices]) -> Array:
    """Return the values of all terms at designs, (n, terms): `counts`, with costly scenarios solved exactly."""
    out = counts.copy()
    for drawn, indices in columns.items():
        chosen = designs.searched[drawn]
        terms = {place: term for place, term in chosen.terms.items() if names(designs, term)}
        guessed = designs.values(designs.predicted, chosen, list(terms.values()))
        solved = _solve(designs, chosen, indices, list(terms.values()))
        for (place, term), values, exact in zip(terms.items(), guessed, solved, strict=True):
            flat = values.reshape(len(values), -1).copy()
            flat[:, indices] = exact
            out[:, place] = term.counted(flat.reshape(values.shape))
    return out


def _solve(designs: Question, chosen: Scenarios, columns: Indices, terms: list[Term]) -> list[Array]:
    """Return exact values of terms in some scenarios, (n, columns) each."""
    solved = designs.values(designs.exact, chosen.only(columns), terms)
    return [values.reshape(len(values), -1) for values in solved]
