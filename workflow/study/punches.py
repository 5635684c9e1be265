"""What presses a device whose study does not say: a punch of steel."""

from solver.names import OF_A_PUNCH
from workflow.study.contents import Contents
from workflow.study.solvable import hanging_on_datum

_USUAL = "steel"


def settle(study: Contents) -> None:
    """Give a study with a device that names no punch one of steel, or leave it rigid where its groups need that.

    Nothing is solved.
    """
    if study.device is None or not {*OF_A_PUNCH}.isdisjoint({*study.fixed, *study.categories, *study.factors}):
        return
    study.fixed["punch"] = _USUAL
    try:
        hanging_on_datum(study)
    except ValueError:  # what its groups do not tell of a punch that gives way
        del study.fixed["punch"]
    study._pressed = True


def told(study: Contents) -> str:
    """What was chosen, in a line; empty where the study said it itself or has no device."""
    if not study._pressed:
        return ""
    if "punch" in study.fixed:
        return f"punch: {_USUAL}, the default of a study with a device (fixed: {{punch: rigid}} for a rigid one)"
    return f"punch: rigid, since its groups do not tell what one of {_USUAL} makes of its surrogate.outputs"
