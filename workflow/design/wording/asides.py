"""What is said beside the verdict: what tolerances and the materials' constants cost, and figures of the device."""

import numpy as np

from workflow.design.question.terms import BINDS
from workflow.design.verdict.answer import Answer
from workflow.design.verdict.merit import MOST_LOAD
from workflow.design.verdict.term import ROUNDING, Term
from workflow.language import sizes, titles
from workflow.language.constants import FIGURES
from workflow.language.numbers import number, shown
from workflow.language.titles import capital, listed

_SAME = 1.005  # share of the load that is as good as none more
_SMALL = 1e-3  # spread that is not told
_ERROR = 0.01  # in building a variable that has no tolerance


def tolerated(answer: Answer) -> str:
    """That the limits are kept within the tolerances, what these cost, and the optimum without them."""
    given, cost = [variable for variable in answer.variables if variable.tolerance], answer.tolerated
    if not given or cost is None:
        return ""
    bands = [f"{sizes.told(variable.name, variable.tolerance)} of {variable.title}" for variable in given]
    goal = answer.terms[0]
    at = [f"{variable.title} {titles.value(variable.name, cost.values[variable.name])}" for variable in given]
    at += filter(None, [cost.choice])
    share = number(100 * abs(goal.exact - cost.exact) / abs(cost.exact), 2) if cost.exact else "–"
    return (
        f"Within {listed(bands)} every limit is kept as it is asked for. "
        f"{capital('; '.join(tolerances(answer)))}. "
        f"Nominal optimum: {goal.shown(cost.exact)} at {listed(at)}, "
        f"from which all tolerances together take {share} %."
    )


def tolerances(answer: Answer) -> list[str]:
    """What each tolerance of a design costs, in words."""
    parts = []
    for variable in answer.variables if answer.tolerated else ():
        assert answer.tolerated is not None
        cost, gain = (each.get(variable.name, np.nan) for each in (answer.tolerated.cost, answer.tolerated.gain))
        if not variable.tolerance or not np.isfinite(cost):
            continue
        words = f"{sizes.told(variable.name, variable.tolerance)} of {variable.title}"
        text = f"{words} costs {number(100 * cost, 2)} %" if cost > 0 else f"{words} costs nothing"
        parts.append(f"{text} (half of it would gain {number(100 * gain, 2)} %)" if gain > 0 else text)
    return parts


def spread(answer: Answer) -> str:
    """What the spread of the constants makes of a design, in a sentence; empty where nothing is known of it."""
    goal = answer.terms[0]
    if not goal.spread > _SMALL:
        return ""
    most = answer.constants[int(np.nanargmax(np.abs(goal.effect)))]
    prior = most.prior.replace("+-", "± ")
    parts = [f"the goal by {_percent(goal.spread)} (most by {most.constant}, {prior})"]
    for limit in answer.limits:
        if limit.spread > _SMALL:
            binds = " (it binds: with other constants it may be broken)" if abs(limit.margin) < BINDS else ""
            parts.append(f"{limit.title} by {_percent(limit.spread)}{binds}")
    how = "one standard deviation: what published values differ by, 5 % at least; to first order"
    return f"The spread of the materials' constants ({how}) moves {listed(parts)}."


def band(spread: float) -> str:
    """Spread that uncertain constants give a value, as text behind it; empty where none or unknown."""
    return f" {_percent(spread)}" if spread > _SMALL else ""


def within(answer: Answer) -> str:
    """The tolerances within which a design is to be built, in brackets; empty where there is none."""
    bands = [
        f"{variable.title} ± {sizes.told(variable.name, variable.tolerance)}"
        for variable in answer.variables
        if variable.tolerance
    ]
    return f" ({listed(bands)})" if bands else ""


def exceeded(answer: Answer) -> str:
    """What of a design is beyond what its materials bear, without the sources; empty where nothing is."""
    return f"{capital('; '.join(answer.exceeded))}." if answer.exceeded else ""


def first_to_break(answer: Answer) -> str:
    """Which limit breaks first: within the tolerances, else as one variable is off by 1 %; empty without limits."""
    if not answer.limits or answer.broken:
        return ""
    if any(variable.tolerance for variable in answer.variables):
        first = min(answer.limits, key=lambda limit: limit.margin)
        return f"Within the tolerances {_first(first, first.margin)}."
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
    return f"1 % off in {variable.title}, {_first(first, margin)}."


def _first(limit: Term, margin: float) -> str:
    """That a limit is the first to break, or comes nearest to it, and what is left of it, as a share of it."""
    if margin > _SMALL:
        return f"{limit.title} comes nearest to its limit: {number(100 * margin, 2)} % left"
    left = f"{number(-100 * margin, 2)} % beyond" if margin < -ROUNDING else "nothing left"
    return f"{limit.title} is the first to break: {left}"


def _percent(share: float) -> str:
    return f"± {number(100 * share, 2)} %"


def device(answer: Answer) -> str:
    """Figures of a device, and how far the load may rise; empty where nothing is known of them."""
    return " ".join(filter(None, (_figures(answer), _overload(answer))))


def _figures(answer: Answer) -> str:
    parts = []
    for figure in answer.figures:
        ends = sorted((figure.figure_low, figure.figure_high), key=abs)
        told = dict.fromkeys(shown(end, FIGURES[figure.figure].units, 3) for end in ends)
        parts.append(f"{titles.title(figure.figure)} {' to '.join(told)}")
    return f"{capital(listed(parts))}." if parts else ""


def _overload(answer: Answer) -> str:
    """How far the load may rise, with the dynamic range where noise is known."""
    if answer.overload is None:
        return ""
    share, stops = answer.overload.overload, answer.overload.overload_term
    if not stops:
        return f"No limit is met up to {number(MOST_LOAD, 2)} times the load."
    words = answer.term(stops).words
    told = f"The load may rise to {number(share, 3)} times its own before {words} stops it"
    if share < _SAME:
        told = f"The load may not rise: {words} stops it"
    ranges = [figure.figure_low for figure in answer.figures if figure.figure == "dynamic_range"]
    reach = f": a dynamic range of {number(share * ranges[0], 2)}" if ranges else ""
    return f"{told}{reach}."
