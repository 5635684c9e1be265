"""What the page tells of exact cases, solved by a rule of its own: the page itself reads files and solves nothing."""

from collections.abc import Mapping
from typing import Any

from solver import FactorError, MaterialError
from solver.names import AIR
from workflow.dataset import factorial
from workflow.design.verdict.answer import Answer
from workflow.report import datum_effect
from workflow.study.model import Study
from workflow.study.target import Target

_IN_AIR = ("voltage", "capacitance", "charge_sensitivity")  # what a device is read by, and air changes most


def solved(study: Study, designs: Mapping[str, Answer]) -> dict[str, Any]:
    """All of it, as plain data for a file.

    Parameters
    ----------
    study : Study
        A study with factors.
    designs : mapping of str to Answer
        The answer to each of its targets.

    Returns
    -------
    dict
        ``datum``: what hangs on it in the middle of the box. ``designs``: by target, ``contact`` (the ends of the
        contact [m]), ``in_air`` (see `in_air`), ``on_datum`` and ``edge``, as `workflow.report.datum_effect` has them.
    """
    return {
        "datum": datum_effect.changes(study),
        "designs": {name: _of_design(study, study.design[name], answer) for name, answer in designs.items()},
    }


def contact(study: Study, answer: Answer) -> dict[str, float]:
    """Both ends of the contact of a design [m], by name of their quantity."""
    found = factorial.exact(study.narrowed(answer.kinds), dict(answer.case), peaks=())
    return {name: float(found[name]) for name in study.kind.ends}


def in_air(study: Study, case: Mapping[str, float]) -> dict[str, float]:
    """Quantities of a device with air beside the contact of one case, over those without, by name.

    None of a study without a device, or of a contact that the theory of air does not cover.
    """
    if study.device is None:
        return {}
    try:
        air = factorial.exact(study.narrowed({"surroundings": AIR}), dict(case), peaks=())
    except (FactorError, MaterialError):
        return {}
    bare = factorial.exact(study, dict(case), peaks=())
    known = [name for name in _IN_AIR if name in air and name in bare and float(bare[name])]
    return {name: float(air[name] / bare[name]) for name in known}


def _of_design(study: Study, target: Target, answer: Answer) -> dict[str, Any]:
    return {
        "contact": contact(study, answer),
        "in_air": in_air(study.narrowed(answer.kinds), answer.case),
        "on_datum": datum_effect.of_design(study, target, answer),
        "edge": datum_effect.singular_zone(study, answer),
    }
