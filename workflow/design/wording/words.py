"""The verdict on a design in words; sentences on tolerances, spread by constants and figures of the device."""

from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context

import numpy as np

from solver.names import ALL_QUANTITIES
from workflow.design.question.risk import BINDS
from workflow.design.verdict import leftout, multipliers
from workflow.design.verdict.answer import ROOM, ROUNDING, Answer, Term, Variable
from workflow.design.verdict.leftout import LeftOut
from workflow.design.verdict.merit import MOST_LOAD
from workflow.language import given, titles
from workflow.language.constants import FIGURES
from workflow.language.numbers import number, shown
from workflow.language.titles import capital, listed
from workflow.language.wordings import unverified

#: First words of the verdict on a design that an effect which the model leaves out moves by more than `leftout.MOST`
#: times the printed band.
WITHIN = "recommended within the model"
RECOMMENDED, AT_EDGE, UNREACHABLE = "recommended", "at the edge of the studied range", "not reachable"
#: First words of the verdict on a design beyond a limit of its materials or beyond small strain.
BEYOND = "beyond linear theory"

_DRIVEN = ("stroke", "blocked", "drive", "electrode_stroke", "contact", "depth")  # begin names that no amplifier reads
_UNREAD = 0.5  # share of its range that remains of a factor which a read-out cannot identify
_NOTHING = 1e-3  # least gain by a wider range that is reported
_SAME = 1.005  # factor of the load that counts as no overload
_SMALL = 1e-3  # spread that is not reported
_ERROR = 0.01  # assumed error in building a variable without a tolerance


@dataclass(frozen=True)
class Verdict:
    """Verdict on one design, as sentences; a sentence that does not apply is empty."""

    kind: str  # RECOMMENDED, AT_EDGE or UNREACHABLE; BEYOND before it; with an effect left out, WITHIN, and that behind
    stops: str  # limits and range ends that bind
    advice: str = ""  # change that would give a better or a feasible design
    without_effect: str = ""  # variables and range ends without effect on the goal
    tolerance: str = ""  # cost of the tolerances, and the optimum without them
    device: str = ""  # figures of the device, and the overload
    beyond: str = ""  # exceeded limits of the theory, with sources
    sources: str = ""  # sources of the material limits that the study names

    @property
    def why(self) -> str:
        """Binding limits, and advice."""
        return " ".join([capital(self.stops), *filter(None, (self.advice, self.without_effect))])

    def __str__(self) -> str:
        sentences = (self.advice, self.without_effect, self.tolerance, self.device, self.beyond, self.sources)
        return " ".join([f"{capital(self.kind)}: {self.stops}", *filter(None, sentences)])


def verdict(answer: Answer) -> Verdict:
    """Return the verdict on one design."""
    sentences = replace(
        _unreachable(answer) if answer.broken else _reached(answer),
        sources=_sources(answer),
        tolerance=tolerated(answer),
        device=device(answer),
    )
    if answer.broken:
        return sentences
    kind = within(answer.left_out, _moved(answer), sentences.kind)
    if not answer.beyond:
        return replace(sentences, kind=kind)
    return replace(sentences, kind=f"{BEYOND}; otherwise {kind}", beyond=f"{capital(answer.beyond)}.")


def within(effects: Sequence[LeftOut], moved: Set[str], kind: str = RECOMMENDED) -> str:
    """Return the verdict on a feasible design with the largest effect, if any, that the model leaves out."""
    effect = leftout.largest(effects, moved)
    if not effect:
        return kind
    return f"{WITHIN if kind == RECOMMENDED else kind}; {effect.left_out_brief}"


def _moved(answer: Answer) -> set[str]:
    """Return what an effect must change to count for a question: the stress, or the signal of a contact."""
    names = {name for term in answer.terms for name in term.statement.expression.names()}
    stresses = {name for name in names & ALL_QUANTITIES.keys() if ALL_QUANTITIES[name].units == "Pa"}
    read = {name for name in names if name in FIGURES or name in ALL_QUANTITIES} - stresses
    driven = {name for name in read if name.startswith(_DRIVEN)}
    return {*(("stress",) if stresses else ()), *(("signal",) if read - driven else ())}


def _sources(answer: Answer) -> str:
    """Return the sources of the material limits that the study's limits name."""
    sources = {term.bound: term.source for term in answer.terms}
    return " ".join(f"{capital(bound)}: {source}{unverified(source)}." for bound, source in sources.items() if bound)


def _without_effect(answer: Answer) -> str:
    """Return a sentence on variables without effect on the goal, and the rule for their values; empty without any."""
    if not answer.without_effect:
        return ""
    words = listed([variable.title for variable in answer.without_effect])
    smallest, leave = (
        ("smallest values are", "leave") if len(answer.without_effect) > 1 else ("smallest value is", "leaves")
    )
    return (
        f"The goal does not depend on {words}; the {smallest} chosen that {leave} every limit "
        f"{number(100 * ROOM, 2)} % of room, or as much as possible."
    )


def _unreachable(answer: Answer) -> Verdict:
    """Return the verdict on an infeasible design: its violated limits, and the way to a feasible design."""
    parts = [
        f"{limit.title} is {limit.shown(limit.exact)} and must be "
        f"{'at most' if limit.statement.sign > 0 else 'at least'} {limit.at}: "
        f"{number(-100 * limit.margin, 3)} % beyond the limit"
        for limit in answer.broken
    ]
    return Verdict(UNREACHABLE, f"in the least violated design, {'; '.join(parts)}.", _way_out(answer))


def _way_out(answer: Answer) -> str:
    """Return sentences on limits that this design would satisfy, and on ends of ranges that bring it closer."""
    loosened = [f"{limit.title} to {_rounded_away(limit)}" for limit in answer.broken]
    ways = [f"Relaxing the limit on {listed(loosened)} makes the target reachable."]
    if len(answer.broken) == 1:
        for end in (variable for variable in answer.variables if variable.edge):
            gain = multipliers.lessened(answer, answer.broken[0], end)
            if gain > _NOTHING:
                ways.append(f"To first order, {_farther(end)} would bring it {_percent(gain)} closer to the limit.")
    return " ".join(ways)


def _rounded_away(limit: Term) -> str:
    """Return a bound that the design satisfies, rounded to three digits on the safe side."""
    digits = ROUND_CEILING if limit.statement.sign > 0 else ROUND_FLOOR
    rounded = Context(prec=3, rounding=digits).create_decimal_from_float(limit.exact)
    return limit.shown(float(rounded))


def _reached(answer: Answer) -> Verdict:
    """Return the verdict on a feasible design: limits and range ends that bind."""
    gains = multipliers.gains(answer, answer.binding, answer.at_ends)
    slight = [end for end in answer.at_ends if gains.get(end.name, 1.0) <= _NOTHING]
    ends = [end for end in answer.at_ends if end not in slight]
    remark = _without_effect(answer)
    if slight:
        words = listed([f"{end.title} ({end.words}, {_end(end)})" for end in slight])
        remark = f"A wider range of {words} would change the goal by less than {_percent(_NOTHING)}. {remark}".strip()
    bounds = [*(f"{end.title} at {_end(end)} ({end.words})" for end in ends), *(term.words for term in answer.binding)]
    if ends:
        return Verdict(AT_EDGE, f"limited by {listed(bounds)}.", _enlarged(ends, gains), remark)
    stops = f"limited by {listed(bounds)}." if bounds else "the best within the ranges; no limit is reached."
    return Verdict(RECOMMENDED, stops, "", remark)


def _end(variable: Variable) -> str:
    """Return the end of its range at which a variable lies; a tolerance keeps it from the end itself."""
    assert variable.edge is not None
    return f"{variable.edge.words}{', less the tolerance' if variable.tolerance else ''}"


def _enlarged(ends: Sequence[Variable], gains: dict[str, float]) -> str:
    """Return a sentence on the gain of the goal by wider ranges."""
    parts = [f"{_farther(end)} would gain {_percent(gains[end.name])}" for end in ends if end.name in gains]
    return f"To first order, {listed(parts)}." if parts else "A wider range may allow a better design."


def _farther(end: Variable) -> str:
    """Return a value beyond the end of a range, in words."""
    return f"{end.title} {titles.value(end.name, end.value * (1 + multipliers.moved(end)))}"


def _percent(share: float) -> str:
    return f"{number(100 * share, 2)} %"


def unread(name: str, left: float) -> str:
    """Return the sentence that a read-out cannot identify a factor; empty where it can."""
    if left < _UNREAD:
        return ""
    return f"these measurements do not determine {titles.title(name)}: {_percent(left)} of its range remains"


def tolerated(answer: Answer) -> str:
    """Return sentences on limits within the tolerances, their cost and the optimum without them; empty without any."""
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
    """Return the cost of each tolerance of a design as a share of the goal, in words."""
    parts: list[str] = []
    if answer.tolerated is None:
        return parts
    for variable in answer.variables:
        cost, gain = (shares.get(variable.name, np.nan) for shares in (answer.tolerated.cost, answer.tolerated.gain))
        if not variable.tolerance or not np.isfinite(cost):
            continue
        words = f"the tolerance ± {given.size_in_words(variable.name, variable.tolerance)} of {variable.title}"
        text = f"{words} costs {number(100 * cost, 2)} % of the goal" if cost > 0 else f"{words} costs nothing"
        parts.append(f"{text} (half the tolerance would gain {number(100 * gain, 2)} %)" if gain > 0 else text)
    return parts


def spread(answer: Answer) -> str:
    """Return the spread of goal and limits by the uncertain material constants, in words; empty where unknown."""
    goal = answer.terms[0]
    if not goal.spread > _SMALL:
        return ""
    largest = int(np.nanargmax(np.abs(goal.effect)))
    share = f"± {_percent(abs(goal.effect[largest]))} by {answer.constants[largest].constant} alone"
    parts = [f"the goal by ± {_percent(goal.spread)} ({share})"]
    for limit in answer.limits:
        if limit.spread > _SMALL:
            binds = ", which may exceed its limit" if abs(limit.margin) < BINDS else ""
            parts.append(f"{limit.title} by ± {_percent(limit.spread)}{binds}")
    return (
        f"Published material constants differ, which changes {listed(parts)}: "
        "one standard deviation of each constant, at least 5 %."
    )


def band(spread: float) -> str:
    """Return the relative spread of a value by uncertain constants as text after it; empty where none or unknown."""
    return f" ± {_percent(spread)}" if spread > _SMALL else ""


def in_brackets(answer: Answer) -> str:
    """Return the tolerances of a design in brackets; empty without any."""
    bands = listed(_bands(answer))
    return f" ({bands})" if bands else ""


def _bands(answer: Answer) -> list[str]:
    tolerated = [variable for variable in answer.variables if variable.tolerance]
    return [f"{variable.title} ± {given.size_in_words(variable.name, variable.tolerance)}" for variable in tolerated]


def exceeded(answer: Answer) -> str:
    """Return exceeded limits of materials and theory, without sources; empty without any."""
    return f"{capital('; '.join(answer.exceeded))}." if answer.exceeded else ""


def first_to_break(answer: Answer) -> str:
    """Return the limit with the least room within the tolerances, or with a variable 1 % off; empty without limits."""
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
    """Return the limit with its margin as a share of the bound, in words."""
    if margin > _SMALL:
        return f"{limit.title} has the least room to its limit: {number(100 * margin, 2)} %"
    if margin < -ROUNDING:
        return f"{limit.title} is {number(-100 * margin, 2)} % beyond its limit"
    return f"{limit.title} is at its limit"


def device(answer: Answer) -> str:
    """Return sentences on figures of a device and the overload; empty where unknown."""
    return " ".join(filter(None, (_figures(answer), _overload(answer))))


def _figures(answer: Answer) -> str:
    parts = []
    for figure in answer.figures:
        ends = sorted((figure.figure_low, figure.figure_high), key=abs)
        values = dict.fromkeys(shown(end, FIGURES[figure.figure].units, 3) for end in ends)
        parts.append(f"{titles.title(figure.figure)} {' to '.join(values)}")
    return f"{capital(listed(parts))}." if parts else ""


def _overload(answer: Answer) -> str:
    """Return a sentence on the factor by which the load may rise until a limit is reached; empty where unknown."""
    if answer.overload is None:
        return ""
    factor, label = answer.overload.overload, answer.overload.overload_term
    if not label:
        return f"No limit is reached up to {number(MOST_LOAD, 2)} times the load."
    words = answer.term(label).words
    if factor < _SAME:
        return f"A larger load exceeds the limit {words}."
    return f"The load may rise {number(factor, 3)} times until it reaches the limit {words}."
