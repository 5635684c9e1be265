"""Limits whose number has no unit: read in SI, and told where that is far from every value, as 50 against a stress."""

from math import log10

import numpy as np
from numpy.typing import NDArray

from solver import units
from workflow.design.asking.terms import Term
from workflow.study.reading import InputError

_FAR = 100.0  # ratio of a bound to the nearest value from which a forgotten unit is more likely than a meant number
_PREFIXES = ("p", "n", "u", "m", "k", "M", "G")


def notes(what: str, term: Term, values: NDArray[np.float64]) -> list[str]:
    """A note where the bound of a limit is far beyond all values and holds everywhere; none where it is among them."""
    excess = term.sign * (values - term.bound)
    low, high = float(excess.min()), float(excess.max())
    nearest = term.bound + term.sign * (low if low > 0 else high)
    if low <= 0 <= high or nearest == 0 or 1 / _FAR < abs(nearest / term.bound) < _FAR:
        return []
    read = f"{term.bound:g} without a unit is {term.bound:g} {term.units}"
    told = (
        f"the values within the ranges are {values.min():.3g} to {values.max():.3g} {term.units}{_meant(term, values)}"
    )
    if low > 0:
        raise InputError(f"{what}: {read}, which nothing keeps: {told}")
    return [f"{term.label!r}: {read}, which everything keeps: {told}"]


def _meant(term: Term, values: NDArray[np.float64]) -> str:
    """The prefix that brings the bound closest to the values, where the unit takes one."""
    lone = term.expression.lone()
    if lone is None or lone.startswith("kg"):
        return "; a unit may stand behind the number"
    size = float(np.abs(values).max())
    scales = {prefix: units.parse(f"{prefix}{lone}").scale / units.parse(lone).scale for prefix in _PREFIXES}
    closest = min(scales, key=lambda prefix: abs(log10(abs(term.bound) * scales[prefix] / size)))
    return f"; did you mean {term.bound:g} {closest}{lone}?"
