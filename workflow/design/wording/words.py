"""The verdict on a design in words: recommended, at the edge of the studied range, or not reachable."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context

from workflow.design.verdict import multipliers
from workflow.design.verdict.answer import ROOM, Answer
from workflow.design.verdict.term import Term
from workflow.design.verdict.variable import Variable
from workflow.design.wording import asides
from workflow.language import titles
from workflow.language.evidence import unverified
from workflow.language.numbers import number
from workflow.language.titles import capital, listed

RECOMMENDED, AT_EDGE, UNREACHABLE = "recommended", "at the edge of the studied range", "not reachable"
#: What comes first of a design that is beyond what its materials bear.
BEYOND = "beyond linear theory"

_UNREAD = 0.5  # share of its range that is left of a factor which a read-out cannot identify
_NOTHING = 1e-3  # least share that a moved end must bring to be told


@dataclass(frozen=True)
class Verdict:
    """What a design comes to."""

    # ``RECOMMENDED``, ``AT_EDGE`` or ``UNREACHABLE``; of a design beyond what its materials bear ``BEYOND`` and what
    # it would be otherwise
    kind: str
    stops: str  # What stops the design from being better, in words
    advice: str = ""  # What would make it better, or reachable; empty where nothing is known to
    idle: str = ""  # Which variables do not matter, and which ends of ranges; empty where all do
    tolerance: str = ""  # What the tolerances cost, and the nominal optimum; empty where there is none
    device: str = ""  # Figures of the device, and how far the load may rise; empty where nothing is known of them
    beyond: str = ""  # What is beyond what the materials bear, with sources; empty where nothing is
    sources: str = ""  # Where the figures of the materials come from that the limits name

    @property
    def why(self) -> str:
        """What stops the design, and what would help."""
        return " ".join([capital(self.stops), *filter(None, (self.advice, self.idle))])

    def __str__(self) -> str:
        more = (self.advice, self.idle, self.tolerance, self.device, self.beyond, self.sources)
        return " ".join([f"{capital(self.kind)}: {self.stops}", *filter(None, more)])


def verdict(answer: Answer) -> Verdict:
    """The verdict on one design."""
    spoken = replace(
        _unreachable(answer) if answer.broken else _reached(answer),
        sources=_sources(answer),
        tolerance=asides.tolerated(answer),
        device=asides.device(answer),
    )
    if answer.broken or not answer.beyond:
        return spoken
    return replace(spoken, kind=f"{BEYOND}; otherwise {spoken.kind}", beyond=f"{capital(answer.beyond)}.")


def _sources(answer: Answer) -> str:
    """Where what the materials bear comes from, for every limit that names it."""
    sources = {term.bound: term.source for term in answer.terms}
    return " ".join(f"{capital(bound)}: {source}{unverified(source)}." for bound, source in sources.items() if bound)


def _idle(answer: Answer) -> str:
    """That some variables do not matter, and the rule that takes their values."""
    if not answer.idle:
        return ""
    words = capital(listed([variable.title for variable in answer.idle]))
    room = f"every limit has {number(100 * ROOM, 2)} % of room, or as much as it can"
    return f"{words} {_do(answer.idle)} not matter to the goal: the least is taken at which {room}."


def _do(several: Sequence[object]) -> str:
    return "do" if len(several) > 1 else "does"


def _unreachable(answer: Answer) -> Verdict:
    """By how much which limits are missed, and what would help."""
    parts = [
        f"{limit.title} must be {'at most' if limit.statement.sign > 0 else 'at least'} "
        f"{limit.at} and comes to {limit.shown(limit.exact)}, "
        f"{number(-100 * limit.margin, 3)} % beyond"
        for limit in answer.broken
    ]
    return Verdict(UNREACHABLE, f"{'; '.join(parts)}, in the least violated design.", _way_out(answer))


def _way_out(answer: Answer) -> str:
    """Limits that this design would keep, and the end of a range that, moved, would lessen the miss."""
    loosened = [f"{limit.title} of {_rounded_away(limit)}" for limit in answer.broken]
    ways = [f"A limit on {listed(loosened)} would make it reachable."]
    if len(answer.broken) == 1:
        for end in (variable for variable in answer.variables if variable.edge):
            gain = multipliers.lessened(answer, answer.broken[0], end)
            if gain > _NOTHING:
                ways.append(f"{capital(_farther(end))} would likely change it by {_percent(gain)} for the better.")
    return " ".join(ways)


def _rounded_away(limit: Term) -> str:
    """A limit that the design keeps, in three digits: rounded to the side that is kept."""
    digits = ROUND_CEILING if limit.statement.sign > 0 else ROUND_FLOOR
    rounded = Context(prec=3, rounding=digits).create_decimal_from_float(limit.exact)
    return limit.shown(float(rounded))


def _reached(answer: Answer) -> Verdict:
    """What stops a design that keeps its limits: ends of ranges beyond which more is to be had, and limits."""
    gains = multipliers.gains(answer, answer.binding, answer.at_ends)
    slight = [end for end in answer.at_ends if gains.get(end.name, 1.0) <= _NOTHING]
    ends = [end for end in answer.at_ends if end not in slight]
    idle = _idle(answer)
    if slight:
        told = f"{capital(listed([_end(end) for end in slight]))} {_do(slight)} not stop it"
        idle = f"{told}: next to nothing is gained beyond. {idle}".strip()
    stops = [*map(_end, ends), *(limit.words for limit in answer.binding)]
    told = f"{listed(stops)} {'stop' if len(stops) > 1 else 'stops'} it."
    if ends:
        return Verdict(AT_EDGE, told, _enlarged(ends, gains), idle)
    return Verdict(RECOMMENDED, told if stops else "best within the ranges, and no limit stops it.", "", idle)


def _end(variable: Variable) -> str:
    assert variable.edge is not None
    return f"{variable.title} at {variable.edge.words} ({variable.words})"


def _enlarged(ends: Sequence[Variable], gains: dict[str, float]) -> str:
    """What moved ends of the ranges would bring."""
    parts = [
        f"{_farther(end)} would likely bring {_percent(gains[end.name])} more" for end in ends if end.name in gains
    ]
    return f"By the gradient, {listed(parts)}." if parts else "A better design may lie beyond."


def _farther(end: Variable) -> str:
    """The end, moved."""
    return f"{end.title} of {titles.value(end.name, end.value * (1 + multipliers.moved(end)))}"


def _percent(share: float) -> str:
    return f"{number(100 * share, 2)} %"


def unread(name: str, left: float) -> str:
    """That a read-out cannot identify a factor, in words; empty where it can."""
    if left < _UNREAD:
        return ""
    return f"{titles.title(name)} cannot be told from these measurements: what is left of its range is {_percent(left)}"
