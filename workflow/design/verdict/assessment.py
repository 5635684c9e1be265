"""The verdict on a design: exact and predicted values, margins, and sensitivity to errors and constants."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from approximation.arrays import Array
from approximation.sobol import sobol_points
from solver.names import ALL_PEAKS, ALL_QUANTITIES, CHOICES, PROFILES
from solver.units import written
from workflow.dataset import factorial
from workflow.design.question import costly
from workflow.design.question.question import Question
from workflow.design.question.risk import Key, Term, WorstCase
from workflow.design.question.scenarios import Scenarios
from workflow.design.question.sources import Exact, Predicted, Source, shape
from workflow.design.verdict import linearity, merit
from workflow.design.verdict.answer import Answer, Constant, End, Range, Role, Scenario, Sensitivity, Variable
from workflow.design.verdict.answer import Term as JudgedTerm
from workflow.language.factors import FACTORS
from workflow.language.numbers import shown
from workflow.language.statements import Limit, Objective
from workflow.study import uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError

_EDGE = 1e-6  # distance from the end of a scaled range, of length 2, that counts as none
_SLENDER = 0.3  # contact width over radius up to which a circle is a parabola (1 % in the profile's slope)
_WIDE, _SMOOTH = 1e-5, 1e-7  # m: width above that of tips, and depth below which roughness decides the contact
_PILOT = 512
_ELASTIC_STEP = 1e-3  # relative step of elasticities
_ERROR = 0.01  # relative error in building a variable
_SHARES = 1 + np.array([-_ELASTIC_STEP, _ELASTIC_STEP, -_ERROR, _ERROR])
_NO_CHANGE = 1e-9  # share of the goal that counts as no change


@dataclass(frozen=True)
class Prediction:
    """Terms on the surrogate."""

    values: Array  # (term,)
    scenarios: list[int]  # the one that decides, by term
    stds: Array  # standard deviations, (term,)
    reaches: Array  # half-widths of the 95 % intervals, (term,)


def exactly(design: Question, terms: Sequence[Term]) -> tuple[Array, int]:
    """Return exact values of some terms at one design in the verdict, (term,), and the number of costly cases."""
    values, cases = [], 0
    for term in terms:
        if costly.names(design, term):
            value, searched = costly.count_exactly(design, term)
            cases += searched
        else:
            value = float(term.counted(design.value(design.exact, design.judged[term.measure.key], term))[0])
        values.append(value)
    return np.array(values), cases


def doubts(design: Question) -> Array:
    """Return half of the 95 % interval of every limited term at one design, over its scale, (limit,)."""
    scales = np.array([term.scale for term in design.limits])
    return np.asarray(predict(design, design.searched).reaches[design.objectives :] / scales)


def predict(design: Question, sets: Mapping[Key, Scenarios]) -> Prediction:
    """Predict the terms on the surrogate; correlated errors pass through expressions and risk measures."""
    values, scenarios = [], []
    errors: list[tuple[float, float]] = []
    for term in design.terms:
        chosen = sets[term.measure.key]
        rows = design.value(design.predicted, chosen, term)
        slopes = term.slopes(rows[0])
        values.append(float(term.counted(rows)[0]))
        scenarios.append(int(np.abs(slopes).argmax()))
        partials = _partials(design, chosen, term)
        weights = {name: slopes * partials[name] for name in _quantities(term)}
        errors.append(design.predicted.errors(design.factors(chosen), weights) if weights else (0.0, 0.0))
    stds, reaches = np.array(errors).reshape(-1, 2).T
    return Prediction(np.array(values), scenarios, stds, reaches)


def _quantities(term: Term) -> list[str]:
    return [name for name in term.expression.names() if name in ALL_QUANTITIES]


def _partials(design: Question, chosen: Scenarios, term: Term) -> dict[str, Array]:
    """Return derivatives of a term's expression by the names in it, on the surrogate, (scenario,) each."""
    known = design.known(design.predicted, design.factors(chosen), [term.expression])
    return term.expression.partials({name: values[0] for name, values in known.items()})[1]


def judge(design: Question) -> Answer:
    """Return the answer of one design, without its name, choices and pictures."""
    terms = design.terms
    guessed = predict(design, design.judged)
    exact, _ = exactly(design, terms)
    corner = _corners(design)
    worst = [_case(design, term, scenario) for term, scenario in zip(terms, guessed.scenarios, strict=True)]
    beyond = linearity.beyond(design.study, corner, _field_below(design, corner))
    thickness = design.factor("thickness", corner["depth"]) if "depth" in corner else None
    beyond += linearity.beyond_small_strain(design.study, corner, _radius(design, corner), thickness)
    notes = [*(words for words, _ in beyond), *_flags(design, corner), *design.notes]
    constants, effects = spread(design, worst)
    out = Answer(
        terms=_terms(design, guessed, exact, worst, effects),
        variables=_variables(design, exact, worst[0]),
        ranges=tuple(Range(name, float(values.min()), float(values.max())) for name, values in corner.items()),
        beyond="; ".join(f"{words} ({reason})" for words, reason in beyond),
        exceeded=tuple(words for words, _ in beyond),
        flags="; ".join(notes),
        statistic=str(design.target.statistic),
        figures=merit.over(design, corner),
        constants=constants,
    )
    return replace(out, overload=merit.first_limit(design, worst)) if out.feasible else out


def _terms(
    design: Question, guessed: Prediction, exact: Array, worst: Sequence[Scenario], effects: Array
) -> tuple[JudgedTerm, ...]:
    """Return the judged terms of one design; effects: of the constants on the terms, (term, constant)."""
    half = guessed.reaches + tolerances(design)
    inside = np.abs(exact - guessed.values) <= half + 1e-12 * np.abs(exact)
    judged = []
    stated: list[Objective | Limit] = [*design.target.objectives, *design.target.limits]
    for k, statement in enumerate(stated):
        term = design.terms[k]
        bound, source = linearity.bound(design.study, statement) if isinstance(statement, Limit) else ("", "")
        judged.append(
            JudgedTerm(
                statement=statement,
                predicted=float(guessed.values[k]),
                predicted_std=float(guessed.stds[k]),
                half=float(half[k]),
                exact=float(exact[k]),
                inside=bool(inside[k]),
                limit=term.bound,
                margin=float(term.sign * (term.bound - exact[k]) / term.scale),
                units=term.units,
                bound=bound,
                source=source,
                worst=worst[k],
                effect=tuple(effects[k].tolist()),
                spread=float(np.sqrt((effects[k] ** 2).sum())) if effects[k].size else np.nan,
            )
        )
    return tuple(judged)


def _variables(design: Question, exact: Array, worst: Scenario) -> tuple[Variable, ...]:
    """Return the factors in the case that decides the first objective, the variables without tolerances."""
    nominal = {**worst, **{name: float(values[0]) for name, values in design.variables.items()}}
    nominal |= {name: value for name, value in design.held.items() if name in design.target.variables}
    unknown, known = Sensitivity((np.nan,) * len(exact)), sensitivities(design, exact)
    edges = _edges(design)
    return tuple(
        Variable(
            name,
            value,
            _role(design, name),
            known.get(name, unknown),
            tolerance=_tolerance(design, name),
            edge=edges.get(name),
        )
        for name, value in nominal.items()
    )


def _corners(design: Question) -> dict[str, Array]:
    """Return exact quantities of a design over many corners of the ranges, costly ones over a few."""
    out: dict[str, Array] = {}
    for sets, slow in ((design.judged, False), (design.searched, True)):
        names = [name for name in design.study.quantities if (name in design.study.costly) == slow]
        out |= design.exact.values(design.factors(sets[False]), names) if names else {}
    return out


def _field_below(design: Question, corner: Mapping[str, Array]) -> float | None:
    """Return the largest field below the contact's middle [V/m] over the corners; None where others replace it."""
    kind = design.study.kind
    if "voltage" not in corner or "nominal_field" in corner or kind.contact == "point" or kind.air:
        return None
    return design.exact.field_below(design.factors(design.judged[False]))


def allowances(study: Study, source: Predicted, names: Sequence[str]) -> dict[str, float]:
    """Return the study's tolerance of some quantities, SI: a share of their range over the box."""
    box = sobol_points(_PILOT, len(study.factors))
    levels = {
        axis.name: axis.from_unit(2 * box[:, [column]] - 1).clip(axis.low, axis.high)
        for column, axis in enumerate(factorial.inputs(study))
    }
    ranges = {name: np.ptp(values) for name, values in source.values(levels, names).items()}
    return {name: float(study.validation.tolerance * size) for name, size in ranges.items()}


def tolerances(design: Question) -> Array:
    """Return the change of each term by the study's tolerance of the quantities, (term,)."""
    terms = design.terms
    names = list(dict.fromkeys(name for term in terms for name in _quantities(term)))
    sizes = allowances(design.study, design.predicted, names)
    out = []
    for term in terms:
        chosen = design.searched[term.measure.key]
        weights = term.weights(design.value(design.predicted, chosen, term)[0])
        partials = _partials(design, chosen, term)
        out.append(
            sum(sizes[name] * float(weights @ np.abs(partials[name] + 0 * weights)) for name in _quantities(term))
        )
    return np.array(out)


def _case(design: Question, term: Term, scenario: int) -> dict[str, float]:
    """Return every factor of the factorial in one scenario of a term's verdict on one design."""
    factors = design.factors(design.judged[term.measure.key])
    return {name: float(np.broadcast_to(values, shape(factors))[0, scenario]) for name, values in factors.items()}


def _role(question: Question, name: str) -> Role:
    target = question.target
    if name in target.variables:
        return Role.VARIABLE
    return Role.WORST_CASE if name in target.worst_case else Role.UNCERTAIN if name in target.uncertain else Role.GIVEN


def _tolerance(question: Question, name: str) -> str:
    """Return a tolerance as the study writes it; empty without one."""
    tolerance = question.target.tolerance.get(name, "")
    return tolerance if isinstance(tolerance, str) else f"{tolerance:g} {written(FACTORS[name].units)}".strip()


def _edges(design: Question) -> dict[str, End]:
    """Return the ends at which variables lie, of the studied range or of the part that was asked for."""
    out = {}
    for (name, axis), u in zip(design.inputs.items(), design.x[0], strict=True):
        if abs(u) > 1 - _EDGE:
            low, high = design.room(name)
            out[name] = End.of(upper=u > 0, studied=axis.high == high if u > 0 else axis.low == low)
    return out


def _radius(design: Question, corner: Mapping[str, Array]) -> Array | None:
    """Return the radius of a round punch over the scenarios; None for other profiles."""
    if "radius" not in PROFILES[str(design.study.fixed.get("profile", CHOICES["profile"][0]))].needs:
        return None
    return design.factor("radius", corner[design.study.kind.ends[0]])


def _flags(design: Question, corner: Mapping[str, Array]) -> list[str]:
    """Return remarks on a contact that is too wide for a parabola or too shallow for real surfaces."""
    trailing, leading = design.study.kind.extents(corner)
    width, radius = trailing + leading, _radius(design, corner)
    share = float((width / radius).max()) if radius is not None else 0.0
    flags = [f"the contact is {share:.2g} of the radius wide: no longer a parabola"] if share > _SLENDER else []
    if "depth" in corner and width.max() > _WIDE and (depth := float(corner["depth"].max())) < _SMOOTH:
        flags.append(f"depth of {shown(depth, 'm', 3)}: both surfaces must be smoother than most are")
    return flags


def sensitivities(design: Question, exact: Array) -> dict[str, Sensitivity]:
    """Return elasticities of terms, and costs of a 1 % error, by differences, for variables other than zero."""
    source = costly.affordable(design)
    varied = _varied(design, source)
    # few draws as in the search: their error at the design is added to all
    sets = {key: design.searched[key] if key is True else chosen for key, chosen in design.judged.items()}
    counts = design.at_variables(varied).count(source, sets)
    counts += exact - counts[0]
    around = counts[1:].reshape(len(varied), len(_SHARES), len(exact))
    largest = np.abs(around).max((0, 1), initial=0.0)
    return {
        name: _effects(design, values[0], values[1 + 4 * k : 5 + 4 * k], counts[0], around[k], largest)
        for k, (name, values) in enumerate(varied.items())
        if values[0] != 0  # zero has no 1 %
    }


def _varied(design: Question, source: Source) -> dict[str, Array]:
    """Return the variables at the design, then one after another moved by `_SHARES`, (1 + 4 d,) each."""
    count = 1 + len(_SHARES) * len(design.variables)
    varied = {name: np.full(count, nominal) for name, (nominal,) in design.variables.items()}
    for k, (name, values) in enumerate(varied.items()):
        # a surrogate in place of the solver ends at its box
        factor = FACTORS[name]
        low, high = (factor.low, factor.high) if isinstance(source, Exact) else design.room(name)
        values[1 + 4 * k : 5 + 4 * k] = np.clip(values[0] * _SHARES, low, high)
    return varied


def _effects(
    question: Question, nominal: float, moved: Array, nominal_counts: Array, around: Array, largest: Array
) -> Sensitivity:
    """Return the effects of one variable from the terms at its value, (term,), and at four moved values, (4, term)."""
    # no shares of values next to zero
    whole = np.where(np.abs(nominal_counts) > _NO_CHANGE * largest, nominal_counts, np.nan)
    change = (moved[1] - moved[0]) / nominal
    with np.errstate(divide="ignore", invalid="ignore"):
        elasticity = (around[1] - around[0]) / whole / change if change else np.full(len(nominal_counts), np.nan)
    wanted, erred = question.objectives, around[2:]
    loss = max(float((question.terms[0].sign * (nominal_counts[0] - erred[:, 0])).max()), 0.0)
    same = np.abs(erred - nominal_counts) <= _NO_CHANGE * np.maximum(np.abs(nominal_counts), largest)
    return Sensitivity(
        elasticity=tuple(elasticity.tolist()),
        cost=float(loss / abs(whole[0])),
        loss=loss,
        matters=not np.all(same[:, :wanted]),
        margin_left=float(np.min(-question.excess(erred))) if question.limits else np.nan,
    )


def spread(design: Question, worst: Sequence[Scenario]) -> tuple[tuple[Constant, ...], Array]:
    """Return constants of a design's materials, and relative changes of the terms by a standard deviation of each.

    Each is moved alone (`workflow.study.uncertainty`), in the deciding case of a term; design and allowables stay.
    Constants are independent a priori: their effects add as squares.
    """
    try:
        constants = uncertainty.uncertain(design.study)
    except InputError:  # a material whose constants follow its composition
        return (), np.empty((len(design.terms), 0))
    effects = np.full((len(design.terms), len(constants)), np.nan)
    places = [k for k, term in enumerate(design.terms) if _tells(design.study, term)]
    terms, cases = [design.terms[k] for k in places], [worst[k] for k in places]
    effects[places] = uncertainty.sensitivities(
        design.study, constants, lambda varied_study: _case_values(design, varied_study, terms, cases)
    )
    return tuple(Constant(constant.name, constant.prior) for constant in constants), effects


def _tells(study: Study, term: Term) -> bool:
    """Return whether one case decides a term, and takes less than seconds for every constant."""
    searched = study.kind.tabled and not ALL_PEAKS.keys().isdisjoint(term.expression.names())
    return isinstance(term.measure, WorstCase) and not searched


def _case_values(design: Question, study: Study, terms: Sequence[Term], cases: Sequence[Mapping[str, float]]) -> Array:
    """Return each term in its own case, with the constants of a study, (term,)."""
    factors = {name: np.array([[case[name]] for case in cases]) for name in (cases[0] if cases else {})}
    known = design.known(Exact(study), factors, [term.expression for term in terms])
    values = [np.broadcast_to(term.expression.evaluate(known), (len(cases), 1)) for term in terms]
    return np.array([rows[place, 0] for place, rows in enumerate(values)])
