"""The verdict on a design in words: recommended, at the edge of the studied range, or not reachable."""

from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import nnls

from workflow.design.asking.terms import BINDS
from workflow.design.verdict import figures
from workflow.design.verdict.assessment import ROOM, ROUNDING
from workflow.language import sizes, statements, titles
from workflow.language.factors import FACTORS
from workflow.language.numbers import number, shown
from workflow.language.titles import capital, listed

Array = NDArray[np.float64]

RECOMMENDED, AT_EDGE, UNREACHABLE = "recommended", "at the edge of the studied range", "not reachable"
#: What comes first of a design that is beyond what its materials bear.
BEYOND = "beyond linear theory"

_FARTHER = 0.1  # share by which an end of a range is moved in words
_UNEXPLAINED = 0.1  # share of a gradient that limits and ends may leave, and yet explain the optimum
_UNREAD = 0.5  # share of its range that is left of a factor which a read-out cannot identify
_NOTHING = 1e-3  # least share that a moved end must bring to be told


@dataclass(frozen=True)
class Verdict:
    """What a design comes to.

    Attributes
    ----------
    kind
        ``RECOMMENDED``, ``AT_EDGE`` or ``UNREACHABLE``; of a design beyond what its materials bear ``BEYOND`` and
        what it would be otherwise.
    stops
        What stops the design from being better, in words.
    advice
        What would make it better, or reachable; empty where nothing is known to.
    idle
        Which variables do not matter, and which ends of ranges; empty where all do.
    tolerance
        What the tolerances cost, and the nominal optimum; empty where there is none.
    device
        Figures of the device, and how far the load may rise; empty where nothing is known of them.
    beyond
        What is beyond what the materials bear, with sources; empty where nothing is.
    sources
        Where the figures of the materials come from that the limits name.
    """

    kind: str
    stops: str
    advice: str = ""
    idle: str = ""
    tolerance: str = ""
    device: str = ""
    beyond: str = ""
    sources: str = ""

    def __str__(self) -> str:
        more = (self.advice, self.idle, self.tolerance, self.device, self.beyond, self.sources)
        return " ".join([f"{capital(self.kind)}: {self.stops}", *filter(None, more)])


def verdict(answer: xr.Dataset) -> Verdict:
    """The verdict on one design.

    Parameters
    ----------
    answer
        As :func:`workflow.design.search.targets.answer` gives it, with its attributes.
    """
    told, beyond = _verdict(answer), answer["beyond"].item()
    told = replace(told, sources=_sources(answer), tolerance=_tolerated(answer), device=_device(answer))
    if told.kind == UNREACHABLE or not beyond:
        return told
    return replace(told, kind=f"{BEYOND}; otherwise {told.kind}", beyond=f"{capital(beyond)}.")


def _device(answer: xr.Dataset) -> str:
    """Figures of a device, and how far the load may rise."""
    stops = str(answer["overload_term"].item()) if "overload_term" in answer else ""
    return " ".join(
        filter(
            None,
            (figures.in_words(answer), figures.range_in_words(answer, _Limit.of(answer, stops).words if stops else "")),
        )
    )


def _tolerated(answer: xr.Dataset) -> str:
    """That the limits are kept within the tolerances, what these cost, and the optimum without them."""
    given = [str(name) for name in answer["factor"].values if str(answer["tolerance"].sel(factor=name).item())]
    if not given or "nominal_exact" not in answer:
        return ""
    bands = [
        f"{sizes.told(name, answer['tolerance'].sel(factor=name).item())} of {titles.title(name)}" for name in given
    ]
    exact, best = float(answer["exact"][0]), float(answer["nominal_exact"])
    nominal = answer["nominal_value"].sel(factor=given)
    at = [f"{titles.title(name)} {titles.value(name, float(nominal.sel(factor=name)))}" for name in given]
    at += filter(None, [str(answer["nominal_choice"].item())])
    share = number(100 * abs(exact - best) / abs(best), 2) if best else "–"
    return (
        f"Within {listed(bands)} every limit is kept as it is asked for. "
        f"{capital('; '.join(toleranced(answer)))}. "
        f"Nominal optimum: {shown(best, str(answer['units'].values[0]), 4)} at {listed(at)}, "
        f"from which all tolerances together take {share} %."
    )


def _sources(answer: xr.Dataset) -> str:
    """Where what the materials bear comes from, for every limit that names it."""
    found = dict(zip(answer["bound"].values.tolist(), answer["source"].values.tolist(), strict=True))
    return " ".join(f"{capital(words)}: {source}." for words, source in found.items() if words)


def _verdict(answer: xr.Dataset) -> Verdict:
    """The same, within linear theory."""
    limits = [_Limit.of(answer, str(name)) for name in answer["term"].values if _limited(answer, str(name))]
    idle = [str(name) for name in answer["factor"].values if not bool(answer["matters"].sel(factor=name))]
    edges = {
        str(name): str(edge) for name, edge in zip(answer["factor"].values, answer["edge"].values, strict=True) if edge
    }
    unmoved = ""
    if idle:
        words = capital(listed([titles.title(name) for name in idle]))
        room = f"every limit has {number(100 * ROOM, 2)} % of room, or as much as it can"
        unmoved = (
            f"{words} {'do' if len(idle) > 1 else 'does'} not matter to the goal: the least is taken at which {room}."
        )
    broken = [limit for limit in limits if limit.margin < -ROUNDING]
    if broken:
        return Verdict(UNREACHABLE, _missed(broken), _way_out(answer, broken, edges))
    edges = {name: edge for name, edge in edges.items() if name not in idle}
    binding = [limit for limit in limits if limit.margin < BINDS]
    gains = _gains(answer, binding, edges)
    ends = {name: f"{titles.title(name)} at {_end(edge)} ({_value(answer, name)})" for name, edge in edges.items()}
    slight = [name for name in edges if gains.get(name, np.inf) <= _NOTHING]
    if slight:
        told = f"{capital(listed([ends[name] for name in slight]))} {'do' if len(slight) > 1 else 'does'} not stop it"
        unmoved = f"{told}: next to nothing is gained beyond. {unmoved}".strip()
    edges = {name: edge for name, edge in edges.items() if name not in slight}
    stops = [ends[name] for name in edges]
    stops += [limit.words for limit in binding]
    told = f"{listed(stops)} {'stop' if len(stops) > 1 else 'stops'} it."
    if edges:
        return Verdict(AT_EDGE, told, _enlarged(answer, edges, gains), unmoved)
    return Verdict(RECOMMENDED, told if stops else "best within the ranges, and no limit stops it.", "", unmoved)


@dataclass(frozen=True)
class _Limit:
    """A limit and what it came to."""

    label: str
    parsed: statements.Limit
    bound: str
    value: float
    exact: float
    margin: float
    units: str

    @classmethod
    def of(cls, answer: xr.Dataset, label: str) -> "_Limit":
        one, parsed = answer.sel(term=label), statements.limit(label)
        return cls(
            label,
            parsed,
            str(one["bound"].values),
            float(one["limit"]),
            float(one["exact"]),
            float(one["margin"]),
            titles.units(parsed, str(one["units"].values)),
        )

    @property
    def name(self) -> str:
        return titles.limited(self.parsed)

    @property
    def words(self) -> str:
        chance = self.parsed.probability
        promised = f" with probability {chance:g}" if chance is not None else ""
        return f"{self.name} of {self.at}{promised}"

    @property
    def at(self) -> str:
        """The bound, and whose it is."""
        share = f"{number(100 * self.parsed.value, 3)} % of " if self.parsed.value != 1 else ""
        bound = self.bound.replace(" (", "; ").removesuffix(")")  # what is in brackets already, within ours
        return f"{shown(self.value, self.units, 4)}{f' ({share}the {bound})' if bound else ''}"


def _limited(answer: xr.Dataset, term: str) -> bool:
    return bool(np.isfinite(answer["limit"].sel(term=term)))


def _value(answer: xr.Dataset, name: str) -> str:
    return titles.value(name, float(answer["value"].sel(factor=name)))


def _end(edge: str) -> str:
    """An end of a range, told from an end of the part of it that was asked for."""
    return f"its {edge.removesuffix(' of the studied range').replace(' of the range asked for', ' as asked for')}"


def _missed(broken: list[_Limit]) -> str:
    """By how much which limits are missed."""
    parts = [
        f"{one.name} must be {'at most' if one.parsed.upper else 'at least'} "
        f"{one.at} and comes to {shown(one.exact, one.units, 4)}, "
        f"{number(-100 * one.margin, 4)} % beyond"
        for one in broken
    ]
    return f"{'; '.join(parts)}, in the least violated design."


def _way_out(answer: xr.Dataset, broken: list[_Limit], edges: dict[str, str]) -> str:
    """Limits that this design would keep, and the end of a range that, moved, would lessen the miss."""
    loosened = [f"{one.name} of {_rounded_away(one)}" for one in broken]
    ways = [f"A limit on {listed(loosened)} would make it reachable."]
    if len(broken) == 1:
        one = broken[0]
        sign = -1.0 if one.parsed.upper else 1.0  # less of an upper limit's value helps
        slopes = sign * np.sign(one.exact) * answer["elasticity"].sel(term=one.label)
        for name, edge in edges.items():
            change = _moved(answer, name, edge)
            gain = float(slopes.sel(factor=name)) * change
            if gain > _NOTHING:
                ways.append(
                    f"{capital(_to(answer, name, change))} would likely change it by {_percent(gain)} for the better."
                )
    return " ".join(ways)


def _rounded_away(one: _Limit) -> str:
    """A limit that the design keeps, in three digits: rounded to the side that is kept."""
    digits = ROUND_CEILING if one.parsed.upper else ROUND_FLOOR
    rounded = Context(prec=3, rounding=digits).create_decimal_from_float(one.exact)
    return shown(float(rounded), one.units, 4)


def _gains(answer: xr.Dataset, binding: list[_Limit], edges: dict[str, str]) -> dict[str, float]:
    """What moved ends of the ranges would likely bring, by the multipliers of the optimum; those that are known."""
    if int(np.isnan(answer["limit"].values).sum()) > 1:  # a compromise of several goals has no one gradient
        return {}
    found = multipliers(answer, [one.label for one in binding], edges)
    changes = {name: abs(_moved(answer, name, edges[name])) for name in found}
    return {name: gain * changes[name] for name, gain in found.items() if changes[name]}


def _enlarged(answer: xr.Dataset, edges: dict[str, str], gains: dict[str, float]) -> str:
    """The same in words."""
    parts = [
        f"{_to(answer, name, _moved(answer, name, edge))} would likely bring {_percent(gains[name])} more"
        for name, edge in edges.items()
        if name in gains
    ]
    return f"By the gradient, {listed(parts)}." if parts else "A better design may lie beyond."


def multipliers(answer: xr.Dataset, binding: list[str], edges: dict[str, str]) -> dict[str, float]:
    """Relative gain of the objective for a relative move outwards of every end at which a variable stands.

    At an optimum the objective's gradient is a sum of those of the limits that bind and of the ends of the ranges, none
    with a negative weight (Karush, Kuhn and Tucker): the weights, by non-negative least squares on the elasticities.
    Nothing where they do not explain the gradient, as at a kink.
    """
    goal = str(answer["term"].values[0])
    known = [str(name) for name in answer["factor"].values if np.isfinite(answer["elasticity"].sel(factor=name)[0])]
    ends = [name for name in edges if name in known]

    def slopes(term: str, sign: float) -> Array:
        one = answer.sel(term=term, factor=known)
        return np.asarray(sign * np.sign(float(one["exact"])) * one["elasticity"].values)

    columns = [slopes(label, statements.limit(label).sign) for label in binding]
    columns += [_outward(edges[name]) * (np.array(known) == name) for name in ends]
    wanted = slopes(goal, 1.0 if str(answer.attrs["goal"]).startswith("maximise") else -1.0)
    if not ends or not np.all(np.isfinite(columns)):
        return {}
    weights, left = nnls(np.stack(columns, -1).astype(np.float64), wanted)
    explained = left <= _UNEXPLAINED * np.linalg.norm(wanted)
    return dict(zip(ends, map(float, weights[len(binding) :]), strict=True)) if explained else {}


def _outward(edge: str) -> float:
    return 1.0 if edge.startswith("upper") else -1.0


def _moved(answer: xr.Dataset, name: str, edge: str) -> float:
    """Relative change of a variable that moves its end outwards, no farther than it has a meaning."""
    value = float(answer["value"].sel(factor=name))
    if value == 0:
        return 0.0
    end = value + _outward(edge) * _FARTHER * abs(value)
    return float(np.clip(end, FACTORS[name].low, FACTORS[name].high)) / value - 1


def _to(answer: xr.Dataset, name: str, change: float) -> str:
    value = float(answer["value"].sel(factor=name)) * (1 + change)
    return f"{titles.title(name)} of {titles.value(name, value)}"


def _percent(share: float) -> str:
    return f"{number(100 * share, 2)} %"


def unread(name: str, told: float) -> str:
    """That a read-out cannot identify a factor, in words; empty where it can.

    Parameters
    ----------
    name
        The factor.
    told
        Length of its 95 % intervals over that of the interval before any measurement.

    Examples
    --------
    >>> unread("friction", 0.97), unread("load", 0.01)
    ('friction cannot be told from these measurements: what is left of its range is 97 %', '')
    """
    if told < _UNREAD:
        return ""
    return f"{titles.title(name)} cannot be told from these measurements: what is left of its range is {_percent(told)}"


def toleranced(answer: xr.Dataset) -> list[str]:
    """What each tolerance of a design costs, in words."""
    parts = []
    for name in answer["factor"].values if "tolerance_cost" in answer else []:
        one = answer.sel(factor=name)
        if not str(one["tolerance"].item()):
            continue
        words = f"{sizes.told(str(name), one['tolerance'].item())} of {titles.title(str(name))}"
        cost, gain = float(one["tolerance_cost"]), float(one["tolerance_gain"])
        if not np.isfinite(cost):
            continue
        text = f"{words} costs {number(100 * cost, 2)} %" if cost > 0 else f"{words} costs nothing"
        parts.append(f"{text} (half of it would gain {number(100 * gain, 2)} %)" if gain > 0 else text)
    return parts
