"""Data of the what-if panel (whatif.html.j2): the surrogate, ranges, and the designs with limits."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup

from approximation.sobol import sobol_points
from solver.fields import FIELDS, fields_of
from solver.names import ALL_QUANTITIES, PROFILES
from surrogate import GaussianProcess
from surrogate.use.export import exported
from workflow.dataset import factorial
from workflow.design.question import scenarios
from workflow.design.question.sources import Predicted
from workflow.design.verdict import assessment
from workflow.design.verdict.answer import Answer
from workflow.language import grammar, titles
from workflow.language.constants import FIGURES_BY
from workflow.language.expressions import Expression, Name, Number, Operation
from workflow.language.factors import FACTORS
from workflow.language.titles import title
from workflow.report import firstscreen
from workflow.study import coupling
from workflow.study.categories import Combination, output
from workflow.study.datum import HANGING, inner, meaning
from workflow.study.model import Study
from workflow.study.target import Target

#: Points of the box by which the ranges of a surrogate in groups are found.
_POINTS = 4096
#: Figures of a device that are shown beside the sliders as large numbers.
_HEADLINES = ("signal_voltage", "smallest_force", "time_constant")


def content(
    study: Study,
    model: GaussianProcess,
    quantities: xr.Dataset,
    designs: Sequence[Answer],
    hangs: frozenset[str] = HANGING,
    fields: GaussianProcess | None = None,
) -> dict[str, Any] | None:
    """Return the panel's data; None where the browser cannot evaluate the surrogate."""
    stored = exported(model)
    if stored is None:
        return None
    values = [answer.case for answer in designs]
    places = [study.combinations.index(answer.combination) for answer in designs]
    start = values[0] if values else {}
    return {
        "surrogate": stored if _combines(study, designs) else {key: stored[key] for key in stored if key != "together"},
        "quantities": [
            {"name": name, **ALL_QUANTITIES[name].attrs, "long_name": meaning(name, hangs), "title": titles.title(name)}
            for name in coupling.felt_outputs(study)
        ],
        "figures": figures(study),
        "headlines": _HEADLINES,
        "titles": {name: titles.title(name) for name in study.factors},
        "categories": study.categories,
        "kinds": [_kind(study, model, kind) for kind in study.combinations],
        "ranges": _ranges(study, model, factorial.training_data(study, quantities)),
        "fixed": _held(study),
        "cases": [
            {"values": case, "kind": kind, **_target(study.narrowed(study.combinations[kind]), name, target, design)}
            for (name, target), design, case, kind in zip(study.design.items(), designs, values, places, strict=True)
        ],
        "stack": drawable(study),
        **charts(study, fields),
        "kind": places[0] if places else 0,
        "start": [
            float(np.clip(axis.to_unit(start[name]), -1, 1)) if name in start else 0.1
            for name, axis in model.box.items()
        ],
    }


def _combines(study: Study, designs: Sequence[Answer]) -> bool:
    """Return whether some goal, limit or figure has several quantities, whose errors the page combines."""
    names_of_terms = [term.statement.expression.names() for answer in designs for term in answer.terms]
    names_of_terms += [grammar.parse(figure["name"], study.meeting).names() for figure in figures(study)]
    return any(len({*names} & {*study.outputs}) > 1 for names in names_of_terms)


def figures(study: Study) -> list[dict[str, Any]]:
    """Return the figures of the device that follow from the page's quantities, factors and numbers, as formulas."""
    known = study.device.constants if study.device else {}
    available = {*known, *coupling.felt_outputs(study), *study.factors, *_held(study)}
    figures = FIGURES_BY[study.meeting]
    formulas = {name: grammar.parse(name, study.meeting) for name in figures}
    return [
        {"name": name, "title": titles.title(name), **figures[name].attrs, "tree": _tree(formula, known)}
        for name, formula in formulas.items()
        if set(formula.names()) <= available
    ]


def _held(study: Study) -> dict[str, float]:
    """Return numeric factors that are fixed, in the top layer of a body, or have a default."""
    return {name: value for name in FACTORS if isinstance(value := study.held(name), float | int)}


def _ranges(study: Study, model: GaussianProcess, learned: xr.Dataset) -> list[list[float]]:
    """Return the ends of every output over the box: of its factorial, or of a surrogate in groups."""
    if study.groups:
        t = 2 * sobol_points(_POINTS, len(model.box)) - 1
        X = np.stack([axis.from_unit(row) for axis, row in zip(model.box.values(), t.T, strict=True)], axis=1)
        return [[float(row.min()), float(row.max())] for row in model.predict_array(X).T]
    return [[float(learned[name].min()), float(learned[name].max())] for name in model.outputs_]


def _kind(study: Study, model: GaussianProcess, combination: Combination) -> dict[str, Any]:
    """Return the data of one combination of the categories: the surrogate's columns, and whether it has a pressure."""
    return {
        "names": combination,
        "allowances": assessment.allowances(study, Predicted(model, combination), study.outputs),
        "columns": [model.outputs_.index(output(name, combination)) for name in coupling.felt_outputs(study)],
        "pressure": closed_pressure(study, combination),
        "body": drawn_body(study, combination) if drawable(study) else None,
    }


def as_json(data: dict[str, Any] | None) -> Markup:
    """Return JSON that may be inside a script element."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return Markup(text.replace("<", "\\u003c").replace("&", "\\u0026"))


def _target(study: Study, name: str, target: Target, answer: Answer) -> dict[str, Any]:
    """Return a target's limits with the verdict on its design, and the scenarios by which the panel judges others."""
    corners = scenarios.corners(target, scenarios.SEARCHED)
    limits = []
    constants = {name: study.constant(name) for name in target.constants() if name not in study.factors}
    for limit in target.limits:
        term = answer.term(str(limit))
        limits.append(
            {
                "text": str(limit),
                "words": titles.bound(limit, term.limit, term.shown_units),
                "tree": _tree(limit.expression, constants),
                "value": term.limit,
                "upper": limit.upper,
                "units": term.shown_units,
                "judged": limit.probability is None and not limit.deviation,  # which several points decide
                "exact": term.exact if np.isfinite(term.exact) else None,
                "held": not term.broken,
            }
        )
    over = [titles.span(factor, *ends) for factor, ends in target.ranges.items()]
    if target.tolerance:
        over.append(f"the tolerances of {titles.listed([titles.title(name) for name in target.tolerance])}")
    return {
        "name": name,
        "title": study.titles[name],
        "beyond": bool(answer.beyond),
        "limits": limits,
        "goal": _goal(target, answer, " and ".join(over), constants),
        "variables": target.continuous,
        "over": " and ".join(over),
        "scenarios": {factor: values.tolist() for factor, values in corners.values.items()},
        "offsets": {factor: values.tolist() for factor, values in corners.offsets.items()},
        "tolerances": {factor: list(target.tolerances[factor]) for factor in corners.offsets},
        "count": corners.count,
        "few": _few(corners),
    }


def _few(corners: scenarios.Scenarios) -> list[int]:
    """Return the scenarios of the map: all while they are few, else those at ends of every range."""
    levels = [*corners.values.values(), *corners.offsets.values()]
    ends = [(level == level.min()) | (level == level.max()) for level in levels]
    many = corners.count > scenarios.SEARCHED[1]
    return np.flatnonzero(np.all(ends, axis=0)).tolist() if many else list(range(corners.count))


def _goal(target: Target, answer: Answer, over: str, constants: Mapping[str, float]) -> dict[str, Any]:
    """Return the first goal, over the scenarios where the worst case counts, else at one point."""
    first = target.objectives[0]
    worst = not target.statistic.drawn and bool(over)
    return {
        "title": titles.stated(first) + (f" at worst over {over}" if worst else ""),
        "short": titles.stated(first),
        "exact": answer.terms[0].exact if worst or not over else None,
        "tree": _tree(first.expression, constants),
        "units": answer.terms[0].shown_units,
        "maximise": first.maximise,
        "worst": worst,
    }


def _tree(node: Expression, constants: Mapping[str, float]) -> Any:
    """Return an expression as nested lists."""
    if isinstance(node, Number):
        return node.value
    if isinstance(node, Name):
        return constants.get(node.name, node.name)
    if isinstance(node, Operation):
        return [node.symbol, *(_tree(part, constants) for part in node.parts)]
    raise TypeError(f"unknown node {node!r}")


#: Quantities that give the contact pressure of a circular punch in closed form.
_PRESSURE = {"contact_trailing", "contact_leading", "pressure_exponent", "peak_pressure"}
#: Entries for the means of a surrogate; the others are for intervals.
_OF_MEANS = ("inputs", "axes", "groups", "outputs", "order", "trains")


def drawable(study: Study) -> bool:
    """Return whether the panel can draw the contact."""
    return not study.kind.space and set(study.outputs) >= set(study.kind.ends)


def closed_pressure(study: Study, combination: Combination) -> bool:
    """Return whether the contact pressure of a combination of categories has a closed form."""
    profile = {**study.fixed, **combination}.get("profile", "cylinder")
    return set(study.outputs) >= _PRESSURE and profile == "cylinder" and not study.kind.tabled


def drawn_body(study: Study, combination: Combination) -> dict[str, Any]:
    """Return punch and body of a combination of categories, as of `report.device.Device`, or names of factors."""
    case = {**study.fixed, **combination, **inner(study)}
    drawn = firstscreen.of_case(study, case, dict.fromkeys(study.kind.ends, 1.0))
    size, pressing = PROFILES[drawn.profile].needs[-1], study.kind.loads.force
    thickness: float | str | None = drawn.thickness
    if study.body:
        thickness = study.body[0].numbers["thickness"]
    elif "thickness" in study.factors:
        thickness = "thickness"
    below = {number for layer in study.body[1:] for number in layer.numbers.values()} | {"base_modulus"}
    return asdict(drawn) | {
        "size": size if size in study.factors else drawn.size,
        "thickness": thickness,
        "base": drawn.base if below.isdisjoint(study.factors) else "",  # words of what a slider moves would not follow
        "exponent": "exponent" if "exponent" in study.factors else drawn.exponent,
        "slides": "friction" if "friction" in study.factors else float(drawn.slides),
        "point": drawn.point,
        "pressing": pressing,
        "units": FACTORS[pressing].units,
        "ends": study.kind.ends,
    }


def charts(study: Study, model: GaussianProcess | None) -> dict[str, Any]:
    """Return charts under the punch and their surrogate; circular punches on half-planes need no surrogate."""
    is_known = not study.categories and "pressure_exponent" in study.outputs
    stored = exported(model) if model is not None and is_known else None
    pressure = any(closed_pressure(study, combination) for combination in study.combinations)
    names = ["contact_pressure"] if pressure else []
    if stored:
        names = [str(output["name"]) for output in stored["outputs"]]
    fields_of_study = coupling.fields(study)
    names = [name for name in names if fields_of(FIELDS[name].units) <= fields_of_study]
    return {
        "charts": [{"name": name, "title": title(name), "units": FIELDS[name].units} for name in names],
        "fields": None if stored is None else {key: stored[key] for key in _OF_MEANS if key in stored},
    }
