"""Exact cases of the page, which a rule of their own solves: the page itself only reads files."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from solver import FactorError, MaterialError
from solver.names import AIR, ALL_QUANTITIES, CHOICES, OF_A_GAP
from workflow.dataset import factorial
from workflow.design.verdict.answer import Answer
from workflow.language import titles
from workflow.language.statements import Limit
from workflow.study.categories import output
from workflow.study.datum import hanging, inner, length
from workflow.study.model import Study
from workflow.study.target import Target

_TIMES = (0.1, 1.0, 10.0)  # lengths over the datum
_EDGE = 1 - 1e-12  # position X at which the field of the edge is read
_VISIBLE = 1e-3  # relative change that three digits show
_STRAIGHT = 1e-9  # relative difference of two slopes up to which they are equal
# quantities that read a device and that air changes most
_READ = ("voltage", "capacitance_per_length", "capacitance", "charge_per_force")
_HERE = {
    "insulated": "The surface beside the contact is insulated (surroundings: insulated). In air",
    AIR: "The surface beside the contact faces air (surroundings: air). With an insulated surface",
}


def solved(study: Study, designs: Mapping[str, Answer]) -> dict[str, Any]:
    """Return all exact cases of the page as plain data."""
    return {
        "datum": changes(study),
        "designs": {
            name: {
                "contact": contact(study, answer),
                "around": compared(study.narrowed(answer.combination), answer.case),
                "on_datum": of_design(study, study.design[name], answer),
                "edge": singular_zone(study, answer),
            }
            for name, answer in designs.items()
        },
    }


def contact(study: Study, answer: Answer) -> dict[str, float]:
    """Return both ends of the contact of a design [m], by name of their quantity."""
    ends = study.kind.ends
    solved = factorial.exact(study.narrowed(answer.combination), dict(answer.case), peaks=(), outputs=ends)
    return {name: float(solved[name]) for name in ends}


def changes(study: Study) -> list[dict[str, Any]]:
    """Return quantities that depend on the datum, at three lengths, and their change per decade, NaN if it varies.

    The cases are in the middle of the box. On films the base decides what depends on the datum, and every combination
    of categories has rows; on half-planes the first one.
    """
    rows: list[dict[str, Any]] = []
    if study.kind.datum == "absolute":
        return rows
    for combination in study.combinations if study.kind.datum == "by_base" else study.combinations[:1]:
        narrowed = study.narrowed(combination)
        hangs = hanging(narrowed)
        for name, values in _solved(narrowed, inner(study)).items():
            if name not in hangs:
                continue
            steps = np.diff(values)
            straight = abs(steps[1] - steps[0]) <= _STRAIGHT * np.abs(values).max()
            slope = float(steps.mean()) if straight else np.nan
            label = output(name, combination) if study.kind.datum == "by_base" else name
            rows.append({"name": label, "values": values.tolist(), "slope": slope, "units": ALL_QUANTITIES[name].units})
    return rows


def of_design(study: Study, target: Target, answer: Answer) -> list[dict[str, Any]]:
    """Return terms of a design that depend on the datum, at three lengths; ``moves``: whether they change visibly."""
    narrowed = study.narrowed(answer.combination)
    hangs, rows = hanging(narrowed), []
    constants = {name: narrowed.constant(name) for name in target.constants() if name not in narrowed.factors}
    for term in answer.terms:
        stated = term.statement
        if hangs.isdisjoint(stated.expression.names()):
            continue
        known: dict[str, Any] = {**narrowed.fixed, **constants, **term.worst, **_solved(narrowed, term.worst)}
        values = np.broadcast_to(stated.expression.evaluate(known), len(_TIMES))
        deviation = isinstance(stated, Limit) and stated.deviation
        moves = not (deviation or np.allclose(values, values[1], rtol=_VISIBLE, atol=0))
        rows.append({"name": term.name, "values": values.tolist(), "units": term.units, "moves": moves})
    return rows


def singular_zone(study: Study, answer: Answer) -> dict[str, float] | None:
    """Return the distance inside the trailing edge where edge charges add more to sigma_xx than the tension [m].

    In the case that decides a limit of ``trailing_tension``; else None. Near the edge sigma_xx grows as
    K / sqrt(1 - X^2), K its regular part there; air has no such singularity.
    """
    limits = [limit for limit in answer.limits if "trailing_tension" in limit.statement.expression.names()]
    narrowed = study.narrowed(answer.combination)
    if not limits or narrowed.kind.air or narrowed.kind.contact == "point":
        return None
    solved = factorial.exact(narrowed, dict(limits[0].worst), [_EDGE], peaks=(), regular=True)
    tension = float(solved["trailing_tension"])
    half = float(solved["contact_trailing"] + solved["contact_leading"]) / 2
    strength = float(solved["stress_xx_regular"][..., 0]) - tension * np.sqrt(1 - _EDGE**2)
    zone = half * (strength / tension) ** 2 / 2
    return {"zone": zone, "half": half, "tension": tension} if zone > 0 else None


def _solved(study: Study, case: Mapping[str, float]) -> dict[str, np.ndarray[Any, Any]]:
    """Return quantities of one case at the three lengths of the datum."""
    base = case.get("datum") or length(study) or 1.0
    solved = factorial.exact(study, {**case, "datum": base * np.array(_TIMES)}, peaks=())
    return {str(name): np.broadcast_to(values, len(_TIMES)) for name, values in solved.data_vars.items()}


def compared(study: Study, case: Mapping[str, float]) -> dict[str, Any]:
    """Return quantities that read a device in one case, in its own and in the other surroundings."""
    if study.device is None and not study.kind.layered:
        return {}
    present = study.surroundings[0]
    other = next(name for name in CHOICES["surroundings"] if name != present)
    fixed = {name: value for name, value in study.fixed.items() if name not in OF_A_GAP} | {"surroundings": other}
    try:
        solved = factorial.exact(
            study.model_copy(update={"fixed": fixed}),
            {name: value for name, value in case.items() if name not in OF_A_GAP},
            peaks=(),
            outputs=_READ,
        )
    except (FactorError, MaterialError):
        return {}
    present_values = factorial.exact(study, dict(case), peaks=(), outputs=_READ)
    known = [name for name in _READ if name in present_values and name in solved]
    return {
        "surroundings": present,
        "quantities": {name: [float(present_values[name]), float(solved[name])] for name in known},
    }


def told(compared: Mapping[str, Any]) -> str:
    """Return the comparison as a sentence; empty without one."""
    if not compared:
        return ""
    changed = [
        f"{titles.title(name)} {titles.value(name, other, 3)} instead of {titles.value(name, value, 3)}"
        for name, (value, other) in compared["quantities"].items()
    ]
    return f"{_HERE[compared['surroundings']]}, the design would have {titles.listed(changed)}."
