"""The verdict on a design: predicted against exact, margins, what binds, and where the theory ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import qmc

from solver.names import ALL_QUANTITIES, CHOICES, PROFILES
from workflow.dataset import factorial
from workflow.design import budget, figures, linearity, perturbation, spread
from workflow.design.designs import Designs
from workflow.design.question import Question
from workflow.design.scenarios import Scenarios
from workflow.design.sources import Predicted, Source, shape
from workflow.design.terms import BINDS, Key, Term
from workflow.language.factors import FACTORS
from workflow.language.numbers import written
from workflow.study.model import Study

Array = NDArray[np.float64]

#: Excess over a limit's scale that counts as none: rounding of the exact solver, which is good to 4e-14.
ROUNDING = 1e-12
#: Margin that a variable which does not matter leaves to every limit.
ROOM = 0.01
_EDGE = 1e-6  # distance from the end of a scaled range, of length 2, that counts as none
_PLAIN = 10.0  # times a limit, from which an excess is written without digits behind the point
_SLENDER = 0.3  # contact width over radius up to which a circle is a parabola (1 % in the profile's slope)
_PILOT = 512


@dataclass(frozen=True)
class Prediction:
    """What the terms count as on the surrogate: values, the deciding scenario of each, and how far off they may be.

    The standard deviation, and the reach of the 95 % interval.
    """

    values: Array
    scenarios: list[int]
    stds: Array
    reaches: Array


def exactly(design: Designs, terms: Sequence[Term]) -> tuple[Array, int]:
    """What some terms exactly count as at one design in the verdict, and the costly cases that they took."""
    values, cases = [], 0
    for term in terms:
        if budget.names(design.question, term):
            found = budget.count_exactly(design, term)
            values.append(found.value)
            cases += found.cases
        else:
            values.append(float(term.counted(design.values(design.exact, design.question.judged[term.key], term))[0]))
    return np.array(values), cases


def excesses(design: Designs, source: Source) -> Array:
    """Relative excess of every limit at one design over the scenarios of the search; (k,)."""
    terms, counts = design.question.terms, design.count(source, design.question.searched)[0]
    return np.array([float(t.oriented(value)) for t, value in zip(terms, counts, strict=True) if t.limited])


def doubts(design: Designs) -> Array:
    """Half of the 95 % interval of every limited term at one design, over its scale; (k,)."""
    terms, reaches = design.question.terms, predict(design, design.question.searched).reaches
    scaled = [reach / term.scale for term, reach in zip(terms, reaches, strict=True) if term.limited]
    return np.array(scaled).reshape(-1)


def predict(design: Designs, sets: Mapping[Key, Scenarios]) -> Prediction:
    """Terms on the surrogate, with what may be off carried through expression and risk measure as if it added."""
    values, scenarios = [], []
    stds: list[float] = []
    reaches: list[float] = []
    for term in design.question.terms:
        chosen = sets[term.key]
        found = design.values(design.predicted, chosen, term)
        weights = term.weights(found[0])
        values.append(float(term.counted(found)[0]))
        scenarios.append(int(weights.argmax()))
        for source, sizes in ((design.predicted.stds, stds), (design.predicted.reaches, reaches)):
            own = {name: size[0] for name, size in source(design.factors(chosen), _quantities(term)).items()}
            sizes.append(float(weights @ _carried(design, chosen, term, own)))
    return Prediction(np.array(values), scenarios, np.array(stds), np.array(reaches))


def _quantities(term: Term) -> list[str]:
    return [name for name in term.expression.names() if name in ALL_QUANTITIES]


def _carried(design: Designs, chosen: Scenarios, term: Term, sizes: Mapping[str, Array]) -> Array:
    """Sum over quantities of |d expression / d quantity| times a size of each; (scenarios,)."""
    known = design.question.known(design.predicted, design.factors(chosen), [term.expression])
    partials = term.expression.partials({name: values[0] for name, values in known.items()})[1]
    total = np.zeros(chosen.count)
    for name, size in sizes.items():
        total += np.abs(partials[name]) * size
    return total


def judge(design: Designs) -> xr.Dataset:
    """Everything that is said about one design.

    Returns
    -------
    xarray.Dataset
        Over ``factor``: ``value``, of a variable without its tolerance, ``tolerance`` in words, ``role``, and of every
        variable ``cost`` (share of the objective lost by a 1 % error in it; NaN where that is next to zero), ``loss``
        (the same in its units), ``matters`` (whether that error changes any objective), ``margin_left`` (least margin
        of all limits after it) and ``edge`` (in words, the end of the range at which it stands). Over ``term``, the
        objective first:
        ``predicted``, ``predicted_std``, ``half`` (reach of the 95 % interval, tolerance included), ``exact``,
        ``inside``, ``limit``, ``margin``, ``units``, and of a limit that names what a material bears ``bound`` (whose)
        and ``source``. Over both: ``elasticity`` and ``worst`` (the scenario that
        decides). What :mod:`~workflow.design.figures` says of a
        device, and :mod:`~workflow.design.spread` of constants. Over ``quantity``: its exact range over the
        scenarios. Scalars: ``feasible``, ``status``, ``beyond`` (where the material is beyond what linear theory holds
        for), ``flags`` (that, and what else is to be known).
    """
    question, terms = design.question, design.question.terms
    guessed = predict(design, question.judged)
    exact, _ = exactly(design, terms)
    limits = np.array([term.bound for term in terms])
    scales = np.array([term.scale for term in terms])
    signs = np.array([term.sign for term in terms])
    margin = signs * (limits - exact) / scales
    half = guessed.reaches + tolerances(design)
    corner = _corners(design)
    worst = [_case(design, term, scenario) for term, scenario in zip(terms, guessed.scenarios, strict=True)]
    nominal = worst[0] | {name: float(values[0]) for name, values in design.variables.items()}
    nominal |= {name: value for name, value in question.held.items() if name in question.target.variables}
    sensitivity = perturbation.sensitivities(design, exact, list(worst[0]))
    idle = [name for name, matters in zip(worst[0], sensitivity["matters"].values, strict=True) if not matters]
    edges = _edges(design)
    beyond = linearity.beyond(question.study, corner)
    bounds = [linearity.bound(question.study, limit) for limit in question.target.limits]
    bounds = [("", "")] * question.objectives + bounds
    out = xr.Dataset(
        {
            "value": ("factor", list(nominal.values())),
            "tolerance": ("factor", [_tolerance(question, name) for name in nominal]),
            "role": ("factor", [_role(question, name) for name in worst[0]]),
            "predicted": ("term", guessed.values),
            "predicted_std": ("term", guessed.stds),
            "half": ("term", half),
            "exact": ("term", exact),
            "inside": ("term", np.abs(exact - guessed.values) <= half + 1e-12 * np.abs(exact)),
            "limit": ("term", limits),
            "margin": ("term", margin),
            "units": ("term", [term.units for term in terms]),
            "bound": ("term", [words for words, _ in bounds]),
            "source": ("term", [source for _, source in bounds]),
            "worst": (("term", "factor"), np.array([list(case.values()) for case in worst])),
            "exact_low": ("quantity", [float(values.min()) for values in corner.values()]),
            "exact_high": ("quantity", [float(values.max()) for values in corner.values()]),
            "feasible": bool(np.all(margin[~np.isnan(margin)] >= -ROUNDING)),
            "edge": ("factor", [edges.get(name, "") for name in worst[0]]),
            "status": _status(question, margin, edges, idle),
            "beyond": "; ".join(f"{words} ({reason})" for words, reason in beyond),
            "flags": "; ".join(
                [*(words for words, _ in beyond), *_flags(corner, _radius(design, corner)), *question.notes]
            ),
        },
        coords={
            "factor": list(worst[0]),
            "term": [term.label for term in terms],
            "quantity": list(corner),
        },
    )
    parts = [out, sensitivity, figures.over(design, corner), spread.over(design, worst)]
    if bool(out["feasible"]):
        parts.append(figures.first_limit(design, worst))
    return xr.merge(parts)


def _corners(design: Designs) -> dict[str, Array]:
    """Every quantity of a design, exactly, over many corners of the ranges; what is costly over a few."""
    out: dict[str, Array] = {}
    for sets, costly in ((design.question.judged, False), (design.question.searched, True)):
        names = [name for name in design.exact.quantities if (name in design.question.study.costly) == costly]
        out |= design.exact.values(design.factors(sets[False]), names) if names else {}
    return out


def outside(answer: xr.Dataset) -> str:
    """Which exact values left their intervals, in words."""
    terms = answer["term"].values[~answer["inside"].values]
    parts = []
    for name in terms:
        exact, predicted, half = (float(answer[key].sel(term=name)) for key in ("exact", "predicted", "half"))
        parts.append(f"{name}: exact {exact:.7g} is outside {predicted:.7g} +- {half:.2g}")
    return "; ".join(parts)


def allowances(study: Study, source: Predicted, names: Sequence[str]) -> dict[str, float]:
    """The study's tolerance of some quantities: a share of their range over the box."""
    box = qmc.Sobol(len(study.factors), rng=0).random(_PILOT)
    levels = {
        axis.name: axis.from_unit(2 * box[:, [column]] - 1).clip(axis.low, axis.high)
        for column, axis in enumerate(factorial.inputs(study))
    }
    ranges = {name: np.ptp(values) for name, values in source.values(levels, names).items()}
    return {name: float(study.validation.tolerance * size) for name, size in ranges.items()}


def tolerances(design: Designs) -> Array:
    """What the study's tolerance may make of each term; (terms,)."""
    terms = design.question.terms
    names = list(dict.fromkeys(name for term in terms for name in _quantities(term)))
    sizes = allowances(design.question.study, design.predicted, names)
    out = []
    for term in terms:
        chosen = design.question.searched[term.key]
        weights = term.weights(design.values(design.predicted, chosen, term)[0])
        own = {name: np.asarray(sizes[name]) for name in _quantities(term)}
        out.append(float(weights @ _carried(design, chosen, term, own)))
    return np.array(out)


def _case(design: Designs, term: Term, scenario: int) -> dict[str, float]:
    """Every factor of the factorial in one scenario of a term's verdict on one design."""
    factors = design.factors(design.question.judged[term.key])
    return {name: float(np.broadcast_to(values, shape(factors))[0, scenario]) for name, values in factors.items()}


def _role(question: Question, name: str) -> str:
    target = question.target
    if name in target.variables:
        return "variable"
    return "worst case" if name in target.worst_case else "uncertain" if name in target.uncertain else "given"


def _tolerance(question: Question, name: str) -> str:
    """A tolerance as the study writes it; empty where there is none."""
    given = question.target.tolerance.get(name, "")
    return given if isinstance(given, str) else f"{given:g} {written(FACTORS[name].units)}".strip()


def _edges(design: Designs) -> dict[str, str]:
    """Variables that stand at an end of their range, which is the study's box or a part of it that was asked for."""
    out = {}
    for (name, axis), u in zip(design.question.inputs.items(), design.x[0], strict=True):
        if abs(u) > 1 - _EDGE:
            low, high = design.question.room(name)
            end, studied = ("upper", axis.high == high) if u > 0 else ("lower", axis.low == low)
            out[name] = f"{end} end of the {'studied range' if studied else 'range asked for'}"
    return out


def _status(question: Question, margin: Array, edges: Mapping[str, str], idle: Sequence[str]) -> str:
    limited = [(term, m) for term, m in zip(question.terms, margin, strict=True) if term.limited]
    worst, least = min(limited, key=lambda pair: pair[1], default=(None, 0.0))
    if worst is not None and least < -ROUNDING:
        missed = f"{-100 * least:.3g}" if least > -_PLAIN else f"{-100 * least:.0f}"
        return f"infeasible: {worst.label} binds; the least violated design misses it by {missed} %"
    binding = ", ".join(term.label for term, m in limited if m < BINDS)
    parts = [f"feasible; binding: {binding or 'none'}"]
    parts += [f"{name} at the {end}" for name, end in edges.items() if name not in idle]
    parts += [f"{', '.join(idle)} of no effect on the goal"] if idle else []
    return "; ".join(parts)


def _radius(design: Designs, corner: Mapping[str, Array]) -> Array | None:
    """Radius of a round punch over the scenarios, wherever the question has it; None for other profiles."""
    fixed = design.question.study.fixed
    if "radius" not in PROFILES[str(fixed.get("profile", CHOICES["profile"][0]))].needs:
        return None
    factors = design.factors_of(corner["contact_trailing"])
    return factors["radius"] if "radius" in factors else np.full((1, 1), float(fixed["radius"]))


def _flags(corner: Mapping[str, Array], radius: Array | None) -> list[str]:
    """Where a design leaves what the theory of the contact holds for."""
    width = corner["contact_trailing"] + corner["contact_leading"]
    share = float((width / radius).max()) if radius is not None else 0.0
    return [f"the contact is {share:.2g} of the radius wide: no longer a parabola"] if share > _SLENDER else []
