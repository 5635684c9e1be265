"""Multipliers of an optimum at the ends of ranges, from its elasticities."""

from collections.abc import Sequence

import numpy as np
import scipy  # scipy.optimize, slow to import, when a target is answered

from approximation.arrays import Array
from workflow.design.verdict.answer import Answer, Term, Variable
from workflow.language.factors import FACTORS

_FARTHER = 0.1  # share by which an end of a range is moved in words
_UNEXPLAINED = 0.1  # share of a gradient that limits and ends may leave, and yet explain the optimum


def multipliers(answer: Answer, binding: Sequence[Term], ends: Sequence[Variable]) -> dict[str, float]:
    """Return the relative gain of the objective for a relative move outwards of every end at which a variable lies.

    By Karush, Kuhn and Tucker the objective's gradient is a sum of those of binding limits and ends with weights >= 0:
    non-negative least squares on the elasticities; empty where they do not explain the gradient, as at a kink.
    """
    known = [variable for variable in answer.variables if np.isfinite(variable.sensitivity.elasticity[0])]
    ends = [variable for variable in ends if variable in known]
    columns = [_slopes(answer, term, known) for term in binding]
    columns += [_outward(end) * np.array([variable == end for variable in known]) for end in ends]
    wanted = _slopes(answer, answer.terms[0], known)
    if not ends or not np.all(np.isfinite(columns)):
        return {}
    weights, left = scipy.optimize.nnls(np.stack(columns, -1).astype(np.float64), wanted)
    explained = left <= _UNEXPLAINED * np.linalg.norm(wanted)
    gains = weights[len(binding) :].tolist()
    return dict(zip([end.name for end in ends], gains, strict=True)) if explained else {}


def gains(answer: Answer, binding: Sequence[Term], ends: Sequence[Variable]) -> dict[str, float]:
    """Return the relative gain by wider ranges, for the ends at which it is known."""
    if len(answer.objectives) > 1:  # a compromise of several goals has no one gradient
        return {}
    changes = {end.name: abs(moved(end)) for end in ends}
    return {name: gain * changes[name] for name, gain in multipliers(answer, binding, ends).items() if changes[name]}


def lessened(answer: Answer, broken: Term, end: Variable) -> float:
    """Return the relative improvement of a limit's value if the end were moved."""
    place = answer.terms.index(broken)
    return float(-broken.statement.sign * np.sign(broken.exact) * end.sensitivity.elasticity[place]) * moved(end)


def moved(end: Variable) -> float:
    """Return the relative change of a variable that moves its end outwards, within the factor's bounds."""
    value = end.value
    if value == 0:
        return 0.0
    farther = value + _outward(end) * _FARTHER * abs(value)
    return float(np.clip(farther, FACTORS[end.name].low, FACTORS[end.name].high)) / value - 1


def _outward(end: Variable) -> float:
    assert end.edge is not None
    return end.edge.outward


def _slopes(answer: Answer, term: Term, known: Sequence[Variable]) -> Array:
    """Return the relative change of a term's size by each variable's, with the sign of its statement, (variable,)."""
    place = answer.terms.index(term)
    slopes = np.array([variable.sensitivity.elasticity[place] for variable in known])
    return np.asarray(term.statement.sign * np.sign(term.exact) * slopes)
