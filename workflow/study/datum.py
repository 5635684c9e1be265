"""The datum, the arbitrary length of a half-plane's logarithmic potentials, and the quantities that depend on it."""

from collections.abc import Collection

import numpy as np

from solver import solve
from solver.names import ALL_QUANTITIES, FACTORS
from surrogate import Input
from workflow.study.contents import Contents

#: Names of the quantities that change with the datum of a half-plane.
HANGING = frozenset(name for name, quantity in ALL_QUANTITIES.items() if quantity.on_datum)
_SAME = 1e-9  # relative difference up to which two values are one
_RELATIVE = " relative to the datum"


def length(study: Contents) -> float | None:
    """Return the datum of every case [m]; None where it is a factor."""
    if "datum" in study.factors:
        return None
    return float(study.fixed.get("datum", FACTORS["datum"].default or 1.0))


def inner(study: Contents, share: float = 0.5) -> dict[str, float]:
    """Return a point of the box, at a share of every range on its scale."""
    axes = [Input(name, axis.low, axis.high, axis.scale) for name, axis in study.factors.items()]
    return {axis.name: float(axis.from_unit(2 * share - 1)) for axis in axes}


def hanging(study: Contents) -> frozenset[str]:
    """Return the names of the quantities that change with the datum in some cases of a study."""
    if study.kind.datum != "by_base":
        return HANGING if study.kind.datum == "relative" else frozenset()
    # on films the solver decides, at a point where no charge is likely to be 0 and whose tables the check has made
    case = inner(study, 0.7) | {name: study.factors[name].high for name in study.tabled}
    datum = (case.pop("datum", None) or length(study) or 1.0) * np.array([1.0, 10.0])
    fixed = {name: value for name, value in study.fixed.items() if name != "datum"}
    cases = {**fixed, **study.categories, **case, "datum": datum}
    solved = study.solved(solve, cases)
    solved_values = {name: solved[name].transpose("datum", ...).values for name in HANGING if name in solved}
    return frozenset(
        name
        for name, values in solved_values.items()
        if np.any(np.abs(np.diff(values, axis=0)) > _SAME * np.abs(values[0]))
    )


def meaning(name: str, hanging: Collection[str]) -> str:
    """Return the meaning of a quantity, relative to the datum only where it depends on the datum."""
    words = ALL_QUANTITIES[name].long_name
    return words if name in hanging else words.removesuffix(_RELATIVE)
