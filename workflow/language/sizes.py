"""Sizes beside a name, as errors and tolerances have them: ``0.5 %`` of the value, or ``2 V``."""

import re

from solver import units
from workflow.language.expressions import units_of
from workflow.language.numbers import shown

_SIZE = re.compile(r"\s*(?P<value>\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+)\s*(?P<unit>.*?)\s*")


def size(name: str, text: str) -> tuple[float, float]:
    """A size of a quantity or factor: its absolute part in SI, and its share of the value."""
    match = _SIZE.fullmatch(units.plain(text.strip().removeprefix("±").removeprefix("+-")))
    if match is None or not float(match["value"]) > 0:
        raise ValueError(f"{text!r} is not a positive number with a unit, as '2 V' or '0.5 %'")
    unit = units.parse(match["unit"])
    if match["unit"] == "%":
        return 0.0, float(match["value"]) * unit.scale
    if match["unit"] and not unit.fits(units.parse(units_of(name))):
        raise ValueError(f"unit mismatch: {text!r} for a number in {units_of(name)}")
    return float(match["value"]) * unit.scale, 0.0


def told(name: str, text: str) -> str:
    """A size as people write it."""
    absolute, _ = size(name, text)
    return shown(absolute, units_of(name)) if absolute else text.strip()
