"""Figures of a device at a design: signal, noise and drive over its scenarios, and the load at its first limit."""

from collections.abc import Mapping, Sequence

import numpy as np

from approximation.arrays import Array
from solver.face.refusal import FactorError
from workflow.design.question.question import Question
from workflow.design.verdict.answer import Figure, Overload, Scenario
from workflow.language import grammar
from workflow.language.constants import CONSTANTS, FIGURES_BY
from workflow.language.expressions import Expression
from workflow.language.factors import FACTORS

_LOADS = 9  # of one search, which is refined: few, since one costs 50 ms in air
_REFINED = 5
#: How far a load is raised in search of the first limit.
MOST_LOAD = 10.0


def over(design: Question, corner: Mapping[str, Array]) -> tuple[Figure, ...]:
    """Return least and largest value of every figure that the study's device has."""
    if design.study.device is None:
        return ()
    meeting = design.target.objectives[0].meeting  # which all choices share
    figures = {name: _figure(design, corner, grammar.parse(name, meeting)) for name in FIGURES_BY[meeting]}
    return tuple(
        Figure(name, float(values.min()), float(values.max())) for name, values in figures.items() if values is not None
    )


def _figure(design: Question, corner: Mapping[str, Array], expression: Expression) -> Array | None:
    """Return a figure's values over the scenarios; None where a number in it is unknown."""
    known: dict[str, Array] = {}
    for name in expression.names():
        if name in corner:
            known[name] = corner[name]
        elif name in CONSTANTS and name not in design.study.factors:
            try:
                known[name] = np.full((1, 1), design.study.constant(name))
            except ValueError:
                return None
        elif name in FACTORS:
            factor = design.factor(name, corner[design.study.kind.ends[0]])
            if factor is None:
                return None
            known[name] = factor
        else:
            return None
    return expression.evaluate(known)


def first_limit(design: Question, worst: Sequence[Scenario]) -> Overload | None:
    """Return the factor by which the load may rise until a limit is reached, all else as in the deciding case."""
    limits = [
        (term, case)
        for term, case in zip(design.terms, worst, strict=True)
        if term.limited and term.sign > 0 and not term.measure.key  # which one case decides
    ]
    pressing = design.study.kind.loads.force
    if pressing not in design.study.factors or not limits:
        return None
    least, reached = MOST_LOAD, ""
    for term, case in limits:
        low, high = 1.0, least
        for _ in range(_REFINED):
            shares = np.geomspace(low, high, _LOADS)
            factors = {name: np.full((1, 1), value) for name, value in case.items()}
            factors[pressing] = case[pressing] * shares[:, None]
            try:
                known = design.known(design.exact, factors, [term.expression])
            except FactorError:  # too large a load for the solver
                break
            values = np.broadcast_to(term.expression.evaluate(known), (_LOADS, 1))[:, 0]
            beyond = np.flatnonzero(values[1:] > term.bound)
            if not beyond.size:
                break
            low, high = shares[beyond[0]], shares[beyond[0] + 1]
            least, reached = float(high), term.label
    if not reached and len(limits) < len(design.limits):
        return None  # a limit that several cases decide may be reached before
    return Overload(least, reached)
