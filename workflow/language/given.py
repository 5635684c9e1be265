"""Numbers as a study gives them, one rule for all sections: a bare one is in SI, a text is read with its unit."""

from collections.abc import Mapping
from typing import Any

from solver.units import in_si
from workflow.language.expressions import units_of
from workflow.language.factors import FACTORS
from workflow.language.numbers import shown

_NUMBERS = ("low", "high", "choices", "uniform", "normal", "triangular")  # of a range or a distribution
#: Bare numbers from which a lost unit is more likely than the number as it is, and the unit that is probably meant.
_LARGEST = {
    "input_capacitance": (1e-3, "pF"),
    "cable_capacitance": (1e-3, "pF"),
    "feedback_capacitance": (1e-3, "pF"),
    "charge_noise": (1e-6, "fC"),
    "voltage_noise": (1.0, "uV"),
}
_LARGEST_OF_FACTORS = {
    "radius": (10.0, "mm"),
    "width": (1.0, "mm"),
    "gap_radius": (10.0, "mm"),
    "thickness": (0.05, "um"),
    "patch_size": (0.5, "mm"),
    "patch_hole": (0.5, "mm"),
    "patch_length": (10.0, "mm"),
    "patch_pitch": (0.5, "mm"),
    "patch_position": (10.0, "mm"),
    "charge": (1.0, "uC/m"),
    "total_charge": (1e-3, "pC"),
    "magnetic_charge": (10.0, "uWb/m"),
    "total_flux": (1.0, "nWb"),
}
_IMPLAUSIBLE = 1e9  # over the largest number, up to which a unit may have been lost
_SMALLEST_OF_FACTORS = {"base_modulus": (1e4, "GPa"), "punch_modulus": (1e4, "GPa")}


_IMPLAUSIBLE = 1e9  # times the largest: no unit makes a number of it


class UnitlessError(ValueError):
    """A bare number that has probably lost its unit."""


def asked(name: str, value: float) -> None:
    """Raise UnitlessError for a bare number of a factor or device that has probably lost its unit."""
    largest, usual = (_LARGEST | _LARGEST_OF_FACTORS).get(name, (float("inf"), ""))
    smallest, lost = _SMALLEST_OF_FACTORS.get(name, (0.0, ""))
    size = abs(value) if name in FACTORS and FACTORS[name].low < 0 else value
    if largest <= size < largest * _IMPLAUSIBLE or 0 < value < smallest:
        text = f"{value:g} {units_of(name)}"
        usual = "mm" if usual == "um" and abs(value) < 1 else usual or lost
        raise UnitlessError(f"{value:g} is {text}; did you mean {value:g} {usual}? {text!r} is read as it stands")


#: Pressure that no piezoceramic bears [Pa], at which a bare force has probably lost its unit.
DESTROYED = 1.5e9


def lost_unit(value: float, unit: str, pressure: float) -> str:
    """Question about a bare force that presses with a destructive pressure [Pa]."""
    return (
        f"{value:g} has no unit, and {value:g} {unit} press with {shown(pressure, 'Pa', 3)}; did you mean {value:g} "
        f"m{unit}? the unit stands in the header or behind the number"
    )


def number(name: str, given: float | str) -> float:
    """The value in SI of a number of a factor or device."""
    if isinstance(given, str):
        return in_si(given, units_of(name))
    if name in _LARGEST:
        asked(name, given)
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
