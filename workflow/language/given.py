"""Numbers as a study gives them, one rule for all sections: a bare one is in SI, a text is read with its unit."""

from collections.abc import Mapping
from typing import Any

from solver.units import in_si
from workflow.language.expressions import units_of
from workflow.language.factors import FACTORS

_NUMBERS = ("low", "high", "choices", "uniform", "normal", "triangular")  # of a range or a distribution
#: Bare numbers of a device from which a forgotten unit is more likely than a meant number, and the unit that is meant.
_USUAL = {
    "input_capacitance": (1e-3, "pF"),
    "cable_capacitance": (1e-3, "pF"),
    "feedback_capacitance": (1e-3, "pF"),
    "charge_noise": (1e-6, "fC"),
    "voltage_noise": (1.0, "uV"),
}


def number(name: str, given: float | str) -> float:
    """The value in SI of a number of a factor or device."""
    if isinstance(given, str):
        return in_si(given, units_of(name))
    most, usual = _USUAL.get(name, (float("inf"), ""))
    if given >= most:
        said = f"{given:g} {units_of(name)}"
        raise ValueError(f"{given:g} is {said}; did you mean {given:g} {usual}? {said!r} is read as it stands")
    return given


def entries(section: Any) -> Any:
    """A section of numbers by the names of factors, in SI; what is no text for a number is left as it is."""
    if not isinstance(section, Mapping):
        return section
    return {name: _read(name, given, (name,)) if name in FACTORS else given for name, given in section.items()}


def _read(name: str, given: Any, place: tuple[str, ...]) -> Any:
    if isinstance(given, str):
        try:
            return number(name, given)
        except ValueError as error:
            raise ValueError(f"{': '.join(place)}: {error}") from None
    if isinstance(given, list):
        return [_read(name, item, place) for item in given]
    if isinstance(given, Mapping):
        return {key: _read(name, item, (*place, key)) if key in _NUMBERS else item for key, item in given.items()}
    return given
