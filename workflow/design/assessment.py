"""The verdict on a design: predicted against exact, margins, what binds, and what small errors in building it cost."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import qmc

from solver.names import CHOICES, EVERY_QUANTITY, FACTORS, PEAKS, PROFILES
from workflow.dataset import factorial
from workflow.design import budget
from workflow.design.question import Question
from workflow.design.scenarios import Scenarios
from workflow.design.sources import Exact, Factors, Predicted, Source, shape
from workflow.design.terms import Term
from workflow.study.model import Study

Array = NDArray[np.float64]

#: Excess over a limit's scale that counts as none: rounding of the exact solver, which is good to 4e-14.
ROUNDING = 1e-12
_NORMAL = 1.959964  # standard deviations of a 95 % interval
_BINDS = 1e-3  # margin below which a limit binds
_ERROR = 0.01  # relative error in building a variable
_NOTHING = 1e-9  # share of the goal that counts as no change
_EDGE = 1e-6  # distance from the end of a scaled range, of length 2, that counts as none
_PLAIN = 10.0  # times a limit, from which an excess is written without digits behind the point
_STEP = 1e-3  # relative step of elasticities
_LINEAR_FIELD = 3e5  # V/m: beyond it, ferroelectric ceramics are not linear
_SLENDER = 0.3  # contact width over radius up to which a circle is a parabola (1 % in the profile's slope)
_PILOT = 512


@dataclass(frozen=True)
class Counted:
    """What the terms count as at one design: values, the deciding scenario of each, and a standard deviation."""

    values: Array
    scenarios: list[int]
    stds: Array


def count(question: Question, factors: Mapping[bool, Factors], sets: Mapping[bool, Scenarios], source: Source) -> Array:
    """Every term's deciding value at some designs, (n, terms)."""
    out: dict[int, Array] = {}
    for drawn, chosen in sets.items():
        members = [(k, term) for k, term in enumerate(question.terms) if term.drawn == drawn]
        terms = [term for _, term in members]
        values = question.values(source, factors[drawn], chosen, terms) if terms else []
        for (k, term), value in zip(members, values, strict=True):
            out[k] = term.worst(term.statistic.rows(value))
    return np.stack([out[k] for k in range(len(question.terms))], -1)


def settled(question: Question, terms: Sequence[Term], x: Array, source: Predicted, exact: Exact) -> tuple[Array, int]:
    """Exact values of some terms at one design over the scenarios of the verdict, and the searched cases they took."""
    factors = {drawn: question.factors(x[None], chosen) for drawn, chosen in question.judged.items()}
    values, cases = [], 0
    for term in terms:
        if budget.names(term):
            found = budget.settle(question, x, term, source, exact)
            values.append(found.value)
            cases += found.cases
        else:
            value = question.values(exact, factors[term.drawn], question.judged[term.drawn], [term])[0]
            values.append(float(term.worst(term.statistic.rows(value))[0]))
    return np.array(values), cases


def excesses(question: Question, x: Array, source: Source) -> Array:
    """Relative excess of every limit at a design over the scenarios of the search; (k,)."""
    factors = {drawn: question.factors(x[None], chosen) for drawn, chosen in question.searched.items()}
    values = count(question, factors, question.searched, source)[0]
    return np.array([float(t.oriented(value)) for t, value in zip(question.terms, values, strict=True) if t.limited])


def doubts(question: Question, x: Array, source: Predicted) -> Array:
    """Half of the 95 % interval of every limited term at a design, over its scale; (k,)."""
    stds = _counted(question, x, source, question.searched).stds
    scaled = [std / term.scale for term, std in zip(question.terms, stds, strict=True) if term.limited]
    return _NORMAL * np.array(scaled).reshape(-1)


def _counted(question: Question, x: Array, source: Predicted, sets: Mapping[bool, Scenarios]) -> Counted:
    """Terms on the surrogate, with standard deviations carried through expression and statistic as if they added."""
    values, scenarios, stds = [], [], []
    for term in question.terms:
        chosen = sets[term.drawn]
        factors = question.factors(x[None], chosen)
        rows, row, weights = _deciding(question, factors, chosen, term, source)
        sizes = {name: std[0] for name, std in source.stds(factors, _quantities(term)).items()}
        values.append(float(rows[row]))
        scenarios.append(int(weights.argmax()))
        stds.append(float(weights @ _carried(question, factors, term, source, sizes)))
    return Counted(np.array(values), scenarios, np.array(stds))


def _deciding(
    question: Question, factors: Factors, chosen: Scenarios, term: Term, source: Source
) -> tuple[Array, int, Array]:
    """Rows of a term at one design, the one that decides, and the weight of every scenario in it."""
    value = question.values(source, factors, chosen, [term])[0]
    rows = term.statistic.rows(value)[0]
    row = int(np.flatnonzero(rows == term.worst(rows))[0])
    return rows, row, np.abs(term.statistic.jacobian(value[0])[row])


def _quantities(term: Term) -> list[str]:
    return [name for name in term.expression.names() if name in EVERY_QUANTITY]


def _carried(question: Question, factors: Factors, term: Term, source: Source, sizes: Mapping[str, Array]) -> Array:
    """Sum over quantities of |d expression / d quantity| times a size of each; (scenarios,)."""
    known = question.known(source, factors, [term.expression])
    partials = term.expression.partials({name: one[0] for name, one in known.items()})[1]
    total = np.zeros(shape(factors)[1])
    for name, size in sizes.items():
        total += np.abs(partials[name]) * size
    return total


def judge(question: Question, x: Array, source: Predicted, exact: Exact) -> xr.Dataset:
    """Everything that is said about one design.

    Returns
    -------
    xarray.Dataset
        Over ``factor``: ``value``, ``role``, and of every variable ``cost`` (share of the objective lost by a 1 % error
        in it; NaN where that is next to zero), ``loss`` (the same in its units), ``matters`` (whether that error
        changes any objective), ``margin_left`` (least margin of all limits after it) and ``edge`` (in words, the end
        of the range at which it stands). Over ``term``, the objective first:
        ``predicted``, ``predicted_std``, ``half`` (of the interval, tolerance included), ``exact``, ``inside``,
        ``limit``, ``margin``, ``units``. Over both: ``elasticity`` and ``worst`` (the scenario that decides). Over
        ``quantity``: its exact range over the scenarios. Scalars: ``feasible``, ``status``, ``flags``.
    """
    question_terms, sets = question.terms, question.judged
    factors = {drawn: question.factors(x[None], chosen) for drawn, chosen in sets.items()}
    guessed = _counted(question, x, source, sets)
    solved, _ = settled(question, question_terms, x, source, exact)
    limits = np.array([term.bound for term in question_terms])
    scales = np.array([term.scale for term in question_terms])
    signs = np.array([term.sign for term in question_terms])
    margin = signs * (limits - solved) / scales
    half = _NORMAL * guessed.stds + _tolerances(question, x, source)
    corner = _corners(question, x, exact)
    worst = [_case(question, factors[t.drawn], s) for t, s in zip(question_terms, guessed.scenarios, strict=True)]
    found = _sensitivities(question, x, solved, budget.spared(question, source, exact), list(worst[0]))
    idle = [name for name, one in zip(worst[0], found["matters"].values, strict=True) if not one]
    edges = _edges(question, x)
    out = xr.Dataset(
        {
            "value": ("factor", list(worst[0].values())),
            "role": ("factor", [_role(question, name) for name in worst[0]]),
            "predicted": ("term", guessed.values),
            "predicted_std": ("term", guessed.stds),
            "half": ("term", half),
            "exact": ("term", solved),
            "inside": ("term", np.abs(solved - guessed.values) <= half + 1e-12 * np.abs(solved)),
            "limit": ("term", limits),
            "margin": ("term", margin),
            "units": ("term", [term.units for term in question_terms]),
            "worst": (("term", "factor"), np.array([list(case.values()) for case in worst])),
            "exact_low": ("quantity", [float(one.min()) for one in corner.values()]),
            "exact_high": ("quantity", [float(one.max()) for one in corner.values()]),
            "feasible": bool(np.all(margin[~np.isnan(margin)] >= -ROUNDING)),
            "edge": ("factor", [edges.get(name, "") for name in worst[0]]),
            "status": _status(question, margin, edges, idle),
            "flags": "; ".join([*_flags(corner, _radius(question, factors[False])), *question.notes]),
        },
        coords={
            "factor": list(worst[0]),
            "term": [term.label for term in question_terms],
            "quantity": list(corner),
        },
    )
    return out.merge(found)


def _corners(question: Question, x: Array, exact: Exact) -> dict[str, Array]:
    """Every quantity of a design, exactly, over many corners of the ranges; what is searched for over a few."""
    out: dict[str, Array] = {}
    for sets, searched_for in ((question.judged, False), (question.searched, True)):
        names = [name for name in exact.quantities if (name in PEAKS) == searched_for]
        out |= exact.values(question.factors(x[None], sets[False]), names) if names else {}
    return out


def outside(answer: xr.Dataset) -> str:
    """Which exact values left their intervals, in words."""
    terms = answer["term"].values[~answer["inside"].values]
    parts = [
        f"{name}: exact {float(one['exact']):.7g} is outside {float(one['predicted']):.7g} +- {float(one['half']):.2g}"
        for name in terms
        for one in [answer.sel(term=name)]
    ]
    return "; ".join(parts)


def allowances(study: Study, source: Predicted, names: Sequence[str]) -> dict[str, float]:
    """The study's tolerance of some quantities: a share of their range over the box."""
    box = qmc.Sobol(len(study.factors), rng=0).random(_PILOT)
    levels = {
        one.name: one.from_unit(2 * box[:, [column]] - 1).clip(one.low, one.high)
        for column, one in enumerate(factorial.inputs(study))
    }
    return {name: float(study.validation.tolerance * np.ptp(one)) for name, one in source.values(levels, names).items()}


def _tolerances(question: Question, x: Array, source: Predicted) -> Array:
    """What the study's tolerance may make of each term."""
    names = list(dict.fromkeys(name for term in question.terms for name in _quantities(term)))
    sizes = allowances(question.study, source, names)
    out = []
    for term in question.terms:
        chosen = question.searched[term.drawn]
        factors = question.factors(x[None], chosen)
        _, _, weights = _deciding(question, factors, chosen, term, source)
        own = {name: np.asarray(sizes[name]) for name in _quantities(term)}
        out.append(float(weights @ _carried(question, factors, term, source, own)))
    return np.array(out)


def _case(question: Question, factors: Factors, scenario: int) -> dict[str, float]:
    """Every factor of the factorial in one scenario of one design."""
    return {name: float(np.broadcast_to(one, shape(factors))[0, scenario]) for name, one in factors.items()}


def _role(question: Question, name: str) -> str:
    target = question.target
    if name in target.variables:
        return "variable"
    return "worst case" if name in target.worst_case else "uncertain" if name in target.uncertain else "given"


def _edges(question: Question, x: Array) -> dict[str, str]:
    """Variables that stand at an end of their range, which is the study's box or a part of it that was asked for."""
    out = {}
    for (name, one), u in zip(question.inputs.items(), x, strict=True):
        if abs(u) > 1 - _EDGE:
            end, (low, high) = ("upper", "lower")[int(u < 0)], _box(question, name)
            studied = one.high == high if u > 0 else one.low == low
            out[name] = f"{end} end of the {'studied range' if studied else 'range asked for'}"
    return out


def _status(question: Question, margin: Array, edges: Mapping[str, str], idle: Sequence[str]) -> str:
    limited = [(term, m) for term, m in zip(question.terms, margin, strict=True) if term.limited]
    worst, least = min(limited, key=lambda pair: pair[1], default=(None, 0.0))
    if worst is not None and least < -ROUNDING:
        missed = f"{-100 * least:.3g}" if least > -_PLAIN else f"{-100 * least:.0f}"
        return f"infeasible: {worst.label} binds; the least violated design misses it by {missed} %"
    binding = ", ".join(term.label for term, m in limited if m < _BINDS)
    parts = [f"feasible; binding: {binding or 'none'}"]
    parts += [f"{name} at the {end}" for name, end in edges.items() if name not in idle]
    parts += [f"{', '.join(idle)} of no effect on the goal"] if idle else []
    return "; ".join(parts)


def _radius(question: Question, factors: Factors) -> Array | None:
    """Radius of a round punch over the scenarios, wherever the question has it; None for other profiles."""
    profile = str(question.study.fixed.get("profile", CHOICES["profile"][0]))
    if "radius" not in PROFILES[profile][0]:
        return None
    return factors["radius"] if "radius" in factors else np.full((1, 1), float(question.study.fixed["radius"]))


def _flags(corner: Mapping[str, Array], radius: Array | None) -> list[str]:
    """Where a design leaves what the theory holds for."""
    flags = []
    width = corner["contact_trailing"] + corner["contact_leading"]
    # an insulating punch has no one voltage
    field = float((np.abs(corner["voltage"]) / width).max()) if "voltage" in corner else 0.0
    if field > _LINEAR_FIELD:
        flags.append(f"nominal field |voltage| / contact width = {field / 1e6:.3g} kV/mm is beyond 0.3 kV/mm")
    share = float((width / radius).max()) if radius is not None else 0.0
    if share > _SLENDER:
        flags.append(f"the contact is {share:.2g} of the radius wide: no longer a parabola")
    return flags


def _sensitivities(question: Question, x: Array, solved: Array, near: Source, factors: list[str]) -> xr.Dataset:
    """Elasticity of every term, and what a 1 % error costs, for every continuous variable.

    By differences on ``near``, from the exact values ``solved`` at the design.
    """
    names = list(question.inputs)
    design = {name: one[0] for name, one in question.physical(x[None]).items()}
    shares = np.array([1.0, *(1 + step for _ in names for step in (-_STEP, _STEP, -_ERROR, _ERROR))])
    varied = {name: np.full(shares.size, value) for name, value in design.items()}
    for k, name in enumerate(names):
        mine = slice(1 + 4 * k, 5 + 4 * k)
        # the surrogate, where it stands in, knows no case beyond its box
        low, high = _physical_range(name) if isinstance(near, Exact) else _box(question, name)
        varied[name][mine] = np.clip(design[name] * shares[mine], low, high)
    sets = question.judged
    values = count(question, {drawn: question.at(varied, chosen) for drawn, chosen in sets.items()}, sets, near)
    values += solved - values[0]
    here, around = values[0], values[1:].reshape(len(names), 4, len(question.terms))
    elasticity = np.full((len(factors), len(question.terms)), np.nan)
    loss, cost, left = (np.full(len(factors), np.nan) for _ in range(3))
    matters = np.ones(len(factors), dtype=bool)
    wanted = len(question.target.objectives)
    largest = np.abs(around).max((0, 1), initial=0.0)
    # a share of what is next to zero says nothing
    whole = np.where(np.abs(here) > _NOTHING * largest, here, np.nan)
    for k, name in enumerate(names):
        row, off = factors.index(name), around[k, 2:]
        if design[name] == 0:
            continue  # which has no 1 % of it
        change = varied[name][2 + 4 * k] / varied[name][1 + 4 * k] - 1
        with np.errstate(divide="ignore", invalid="ignore"):
            elasticity[row] = (around[k, 1] - around[k, 0]) / whole / change if change else np.nan
        loss[row] = max(float((question.terms[0].sign * (here[0] - off[:, 0])).max()), 0.0)
        cost[row] = loss[row] / abs(whole[0])
        same = np.abs(off - here) <= _NOTHING * np.maximum(np.abs(here), largest)
        matters[row] = not np.all(same[:, :wanted])
        margins = [-term.oriented(off[:, t]) for t, term in enumerate(question.terms) if t >= wanted]
        left[row] = float(np.min(margins)) if margins else np.nan
    over = {"cost": cost, "loss": loss, "matters": matters, "margin_left": left}
    return xr.Dataset(
        {"elasticity": (("factor", "term"), elasticity)} | {key: ("factor", one) for key, one in over.items()}
    )


def _physical_range(name: str) -> tuple[float, float]:
    return FACTORS[name].low, FACTORS[name].high


def _box(question: Question, name: str) -> tuple[float, float]:
    return question.study.factors[name].low, question.study.factors[name].high
