"""Points that rest: a study of points that asks for what friction adds, and names no friction, has none."""

from solver.names import POINT_SLIDING
from workflow.study.contents import Contents


def settle(study: Contents) -> None:
    """Give a study of points ``friction: 0`` where it asks for ``trailing_tension``, say, and names no friction.

    Nothing is solved.
    """
    if study.kind.contact != "point" or "friction" in {*study.fixed, *study.categories, *study.factors}:
        return
    try:
        wanted = asked(study)
    except ValueError:  # which the target's own check tells
        return
    if not POINT_SLIDING.keys().isdisjoint(wanted):
        study.fixed["friction"] = 0.0


def asked(study: Contents) -> list[str]:
    """Names in targets, outputs and read-outs.

    Raises
    ------
    ValueError
        A target that is no expression.
    """
    wanted = [name for target in study.design.values() for name in target.names()]
    return [*wanted, *study.surrogate.outputs, *(name for one in study.readout.values() for name in one.measured)]
