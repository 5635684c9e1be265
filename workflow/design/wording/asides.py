"""Sentences beside the verdict: cost of tolerances, spread by material constants, figures of the device."""

import numpy as np

from workflow.design.question.terms import BINDS
from workflow.design.verdict.answer import ROUNDING, Answer, Term
from workflow.design.verdict.merit import MOST_LOAD
from workflow.language import given, titles
from workflow.language.constants import FIGURES
from workflow.language.numbers import number, shown
from workflow.language.titles import capital, listed

_SAME = 1.005  # factor of the load that counts as no overload
_SMALL = 1e-3  # spread that is not reported
_ERROR = 0.01  # assumed error in building a variable without a tolerance


def tolerated(answer: Answer) -> str:
    """Every limit holds within the tolerances; their cost, and the optimum without them."""
    variables, cost = [variable for variable in answer.variables if variable.tolerance], answer.tolerated
    if not variables or cost is None:
        return ""
    goal = answer.terms[0]
    values = [f"{variable.title} {titles.value(variable.name, cost.values[variable.name])}" for variable in variables]
    values += filter(None, [cost.choice])
    share = number(100 * abs(goal.exact - cost.exact) / abs(cost.exact), 2) if cost.exact else "–"
    return (
        f"Every limit holds within {listed(_bands(answer))}. {capital('; '.join(tolerances(answer)))}. "
        f"Without tolerances the optimum is {goal.shown(cost.exact)} at {listed(values)}; "
        f"all tolerances together cost {share} % of it."
    )


def tolerances(answer: Answer) -> list[str]:
    """Cost of each tolerance of a design as a share of the goal, in words."""
    parts = []
    for variable in answer.variables if answer.tolerated else ():
        assert answer.tolerated is not None
        cost, gain = (shares.get(variable.name, np.nan) for shares in (answer.tolerated.cost, answer.tolerated.gain))
        if not variable.tolerance or not np.isfinite(cost):
            continue
        words = f"the tolerance ± {given.told(variable.name, variable.tolerance)} of {variable.title}"
        text = f"{words} costs {number(100 * cost, 2)} % of the goal" if cost > 0 else f"{words} costs nothing"
        parts.append(f"{text} (half the tolerance would gain {number(100 * gain, 2)} %)" if gain > 0 else text)
    return parts


def spread(answer: Answer) -> str:
    """Spread of goal and limits by the uncertain material constants, in words; empty where unknown."""
    goal = answer.terms[0]
    if not goal.spread > _SMALL:
        return ""
    largest = int(np.nanargmax(np.abs(goal.effect)))
    share = f"{_percent(abs(goal.effect[largest]))} by {answer.constants[largest].constant} alone"
    parts = [f"the goal by {_percent(goal.spread)} ({share})"]
    for limit in answer.limits:
        if limit.spread > _SMALL:
            binds = ", which may exceed its limit" if abs(limit.margin) < BINDS else ""
            parts.append(f"{limit.title} by {_percent(limit.spread)}{binds}")
    return (
        f"Published material constants differ, which changes {listed(parts)}: "
        "one standard deviation of each constant, at least 5 %."
    )


def band(spread: float) -> str:
    """Relative spread of a value by uncertain constants, as text after it; empty where none or unknown."""
    return f" {_percent(spread)}" if spread > _SMALL else ""


def within(answer: Answer) -> str:
    """Tolerances of a design in brackets; empty without any."""
    bands = listed(_bands(answer))
    return f" ({bands})" if bands else ""


def _bands(answer: Answer) -> list[str]:
    tolerated = [variable for variable in answer.variables if variable.tolerance]
    return [f"{variable.title} ± {given.told(variable.name, variable.tolerance)}" for variable in tolerated]


def exceeded(answer: Answer) -> str:
    """Exceeded limits of materials and theory, without sources; empty without any."""
    return f"{capital('; '.join(answer.exceeded))}." if answer.exceeded else ""


def first_to_break(answer: Answer) -> str:
    """Limit with the least room within the tolerances, or with one variable 1 % off; empty without limits."""
    if not answer.limits or answer.broken:
        return ""
    if any(variable.tolerance for variable in answer.variables):
        first = min(answer.limits, key=lambda limit: limit.margin)
        return f"Within the tolerances, {_first(first, first.margin)}."
    errors = [
        (limit.margin - _ERROR * abs(elasticity * limit.exact / limit.limit), variable, limit)
        for variable in answer.variables
        if variable.chosen
        for limit, elasticity in zip(answer.limits, variable.sensitivity.elasticity[-len(answer.limits) :], strict=True)
        if limit.limit and np.isfinite(elasticity)
    ]
    if not errors:
        return ""
    margin, variable, first = min(errors, key=lambda error: error[0])
    return f"With {variable.title} 1 % off, {_first(first, margin)}."


def _first(limit: Term, margin: float) -> str:
    """The limit with its margin as a share of the bound, in words."""
    if margin > _SMALL:
        return f"{limit.title} has the least room to its limit: {number(100 * margin, 2)} %"
    if margin < -ROUNDING:
        return f"{limit.title} is {number(-100 * margin, 2)} % beyond its limit"
    return f"{limit.title} is at its limit"


def _percent(share: float) -> str:
    return f"± {number(100 * share, 2)} %"


def device(answer: Answer) -> str:
    """Figures of a device, and the overload; empty where unknown."""
    return " ".join(filter(None, (_figures(answer), _overload(answer))))


def _figures(answer: Answer) -> str:
    parts = []
    for figure in answer.figures:
        ends = sorted((figure.figure_low, figure.figure_high), key=abs)
        values = dict.fromkeys(shown(end, FIGURES[figure.figure].units, 3) for end in ends)
        parts.append(f"{titles.title(figure.figure)} {' to '.join(values)}")
    return f"{capital(listed(parts))}." if parts else ""


def _overload(answer: Answer) -> str:
    """Factor by which the load may rise until a limit is reached, in words."""
    if answer.overload is None:
        return ""
    factor, label = answer.overload.overload, answer.overload.overload_term
    if not label:
        return f"No limit is reached up to {number(MOST_LOAD, 2)} times the load."
    words = answer.term(label).words
    if factor < _SAME:
        return f"A larger load exceeds the limit {words}."
    return f"The load may rise {number(factor, 3)} times until it reaches the limit {words}."
