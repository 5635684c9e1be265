"""Exact cases of the page, solved by a rule of their own: the page itself only reads files."""

from collections.abc import Mapping
from typing import Any

from workflow.dataset import factorial
from workflow.design.verdict.answer import Answer
from workflow.report import datum_effect, other_surroundings
from workflow.study.model import Study
from workflow.study.target import Target


def solved(study: Study, designs: Mapping[str, Answer]) -> dict[str, Any]:
    """All of it, as plain data for a file."""
    return {
        "datum": datum_effect.changes(study),
        "designs": {name: _of_design(study, study.design[name], answer) for name, answer in designs.items()},
    }


def contact(study: Study, answer: Answer) -> dict[str, float]:
    """Both ends of the contact of a design [m], by name of their quantity."""
    solved = factorial.exact(study.narrowed(answer.combination), dict(answer.case), peaks=())
    return {name: float(solved[name]) for name in study.kind.ends}


def _of_design(study: Study, target: Target, answer: Answer) -> dict[str, Any]:
    return {
        "contact": contact(study, answer),
        "around": other_surroundings.compared(study.narrowed(answer.combination), answer.case),
        "on_datum": datum_effect.of_design(study, target, answer),
        "edge": datum_effect.singular_zone(study, answer),
    }
