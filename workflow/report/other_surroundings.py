"""Quantities of a design's device in the other surroundings: air or insulation beside the contact."""

from collections.abc import Mapping
from typing import Any

from solver import FactorError, MaterialError
from solver.names import AIR, CHOICES, OF_A_GAP
from workflow.dataset import factorial
from workflow.language import titles
from workflow.study.model import Study

_READ = (
    "voltage",
    "capacitance_per_length",
    "capacitance",
    "charge_per_force",
)  # quantities that read a device and that air changes most
_HERE = {
    "insulated": "The surface beside the contact is insulated (surroundings: insulated). In air",
    AIR: "The surface beside the contact faces air (surroundings: air). With an insulated surface",
}


def compared(study: Study, case: Mapping[str, float]) -> dict[str, Any]:
    """Quantities that read a device in one case, in its own and in the other surroundings."""
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
        )
    except (FactorError, MaterialError):
        return {}
    present_values = factorial.exact(study, dict(case), peaks=())
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
