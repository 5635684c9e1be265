"""Quantities that depend on the datum, the arbitrary length of a half-plane's logarithmic potentials."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from solver.names import ALL_QUANTITIES
from workflow.dataset import factorial
from workflow.design.verdict.answer import Answer
from workflow.language.statements import Limit
from workflow.study.categories import output
from workflow.study.datum import HANGING, hanging, inner, length
from workflow.study.model import Study
from workflow.study.target import Target

_TIMES = (0.1, 1.0, 10.0)
_EDGE = 1 - 1e-12  # position X from which the field at the edge is read
_TOLD = 1e-3  # relative change that three digits tell
_STRAIGHT = 1e-9  # relative difference of two slopes up to which they are one


def changes(study: Study) -> list[dict[str, Any]]:
    """Quantities that depend on the datum in the middle of the box, at a tenth, one and ten times the datum.

    With the change per decade of the datum, NaN where that is not constant. Of half-planes the first name of every
    category is told, of films every name: the base decides what depends on the datum.
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
            said = output(name, combination) if study.kind.datum == "by_base" else name
            rows.append({"name": said, "values": values.tolist(), "slope": slope, "units": ALL_QUANTITIES[name].units})
    return rows


def of_design(study: Study, target: Target, answer: Answer) -> list[dict[str, Any]]:
    """The terms of a design that depend on the datum: in the case that decides, at the same three lengths.

    ``moves`` says whether they differ in what is told; a deviation has no value in one case.
    """
    narrowed = study.narrowed(answer.combination)
    hangs, rows = hanging(narrowed), []
    constants = {name: narrowed.constant(name) for name in target.constants()}
    for term in answer.terms:
        stated = term.statement
        if hangs.isdisjoint(stated.expression.names()):
            continue
        known: dict[str, Any] = {
            **narrowed.fixed,
            **constants,
            **term.worst,
            **_solved(narrowed, term.worst, all_quantities=True),
        }
        values = np.broadcast_to(stated.expression.evaluate(known), len(_TIMES))
        deviation = isinstance(stated, Limit) and stated.deviation
        moves = not (deviation or np.allclose(values, values[1], rtol=_TOLD, atol=0))
        rows.append({"name": term.name, "values": values.tolist(), "units": term.units, "moves": moves})
    return rows


def singular_zone(study: Study, answer: Answer) -> dict[str, float] | None:
    """Distance inside the trailing edge within which edge charges add more to sigma_xx than the tension [m].

    In the case that decides a limit of ``trailing_tension``; None without such a limit, in air, which has no such
    singularity, and of points. There sigma_xx grows as K / sqrt(1 - X^2): K is its regular part at the edge.
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


def _solved(
    study: Study, case: Mapping[str, float], *, all_quantities: bool = False
) -> dict[str, np.ndarray[Any, Any]]:
    """Quantities that depend on the datum, or all, of one case at the three lengths."""
    base = case.get("datum") or length(study) or 1.0
    solved = factorial.exact(study, {**case, "datum": base * np.array(_TIMES)}, peaks=())
    names = [str(name) for name in solved.data_vars if all_quantities or name in HANGING]
    return {name: np.broadcast_to(solved[name].values, len(_TIMES)) for name in names}
