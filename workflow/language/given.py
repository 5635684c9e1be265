"""Numbers as a study gives them, one rule for all sections: a bare one is in SI, a text is read with its unit."""

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from solver import units
from solver.units import in_si
from workflow.language.expressions import units_of
from workflow.language.factors import FACTORS, own_kind
from workflow.language.numbers import shown

if TYPE_CHECKING:
    from pydantic import ValidationInfo

_NUMBERS = ("low", "high", "choices", "uniform", "normal", "triangular")  # of a range or a distribution
#: Usual sizes, from and to, in SI: outside of them a bare number has probably lost its unit, and which one.
_USUAL_SIZES: dict[str, tuple[float, float, str]] = {
    "radius": (1e-10, 10.0, "mm"),
    "width": (1e-10, 1.0, "mm"),
    "gap_radius": (1e-10, 10.0, "mm"),
    "thickness": (1e-11, 0.05, "um"),
    "patch_size": (1e-10, 0.5, "mm"),
    "patch_pitch": (1e-10, 0.5, "mm"),
    "patch_position": (0.0, 10.0, "mm"),
    "friction": (0.0, 5.0, "%"),
    "load": (1e-9, 1e9, "mN/m"),
    "force": (1e-15, 1e8, "mN"),
    "charge": (1e-18, 1.0, "uC/m"),
    "total_charge": (1e-21, 1e-3, "pC"),
    "magnetic_charge": (1e-15, 10.0, "uWb/m"),
    "total_flux": (1e-18, 1.0, "nWb"),
    "speed": (1e-15, 1e5, "mm/s"),
    "base_modulus": (1e4, 1e14, "GPa"),
    "punch_modulus": (1e4, 1e14, "GPa"),
    "electrode_length": (1e-9, 100.0, "mm"),
    "drive_voltage": (1e-9, 1e6, "mV"),
    "temperature": (1e-3, 1e5, "mK"),
    "input_capacitance": (1e-18, 1e-3, "pF"),
    "cable_capacitance": (1e-18, 1e-3, "pF"),
    "feedback_capacitance": (1e-18, 1e-3, "pF"),
    "input_resistance": (1e2, 1e21, "GOhm"),
    "feedback_resistance": (1e2, 1e21, "GOhm"),
    "charge_noise": (1e-24, 1e-6, "fC"),
    "voltage_noise": (1e-15, 1.0, "uV"),
    "press": (1e-9, 1e6, "ms"),
    "hold": (1e-9, 1e9, "ms"),
}
_IMPLAUSIBLE = 1e9  # times the largest: no unit makes a number of it
_SIZE = re.compile(r"\s*(?P<value>\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+)\s*(?P<unit>.*?)\s*")


class UnitlessError(ValueError):
    """A bare number that has probably lost its unit."""


def check_bare(name: str, value: float, units: str = "") -> None:
    """Raise UnitlessError for a bare number orders of magnitude outside of what a factor or device has."""
    least, most, usual = _USUAL_SIZES.get(own_kind(name) or name, (0.0, float("inf"), ""))
    if 0 < abs(value) < least or most <= abs(value) < most * _IMPLAUSIBLE:
        text = f"{100 * value:g} %" if usual == "%" else f"{value:g} {units or units_of(name)}"
        usual = "mm" if usual == "um" and abs(value) < 1 else usual
        raise UnitlessError(f"{value:g} is {text}; did you mean {value:g} {usual}? {text!r} is read as it stands")


#: Pressure that destroys every piezoceramic [Pa]: a bare force that exceeds it has probably lost its unit.
DESTRUCTIVE_PRESSURE = 1.5e9


def lost_unit(value: float, unit: str, pressure: float) -> str:
    """Return a question about a bare force that presses with a destructive pressure [Pa]."""
    return (
        f"{value:g} has no unit, and {value:g} {unit} press with {shown(pressure, 'Pa', 3)}; did you mean {value:g} "
        f"m{unit}? the unit stands in the header or behind the number"
    )


def number(name: str, value: float | str, units: str = "", context: object = None) -> float:
    """Return the value in SI of a number of a factor or device; a text has its unit, a bare number is checked."""
    if isinstance(value, str):
        return in_si(value, units or units_of(name))
    if not getattr(context, "in_si", False):  # the context of a validation says that it was checked before
        check_bare(name, value, units)
    return value


def entries(section: Any, info: "ValidationInfo") -> Any:
    """Return a section of numbers by the names of factors in SI; other content stays as it is."""
    if not isinstance(section, Mapping):
        return section
    return {
        name: _read(name, value, (name,), info.context) if name in FACTORS else value for name, value in section.items()
    }


def _read(name: str, value: Any, place: tuple[str, ...], context: object) -> Any:
    if isinstance(value, str | int | float) and not isinstance(value, bool):
        try:
            return number(name, value, context=context)
        except ValueError as error:
            raise ValueError(f"{': '.join(place)}: {error}") from None
    if isinstance(value, list):
        return [_read(name, item, place, context) for item in value]
    if isinstance(value, Mapping):
        return {
            key: _read(name, item, (*place, key), context) if key in _NUMBERS else item for key, item in value.items()
        }
    return value


def size(name: str, text: str) -> tuple[float, float]:
    """Return a positive size of a quantity or factor: its absolute part in SI, and its share of the value."""
    match = _SIZE.fullmatch(units.plain(text.strip().removeprefix("±").removeprefix("+-")))
    if match is None or not float(match["value"]) > 0:
        raise ValueError(f"{text!r} is not a positive number with a unit, as '2 V' or '0.5 %'")
    unit = units.parse(match["unit"])
    if match["unit"] == "%":
        return 0.0, float(match["value"]) * unit.scale
    if match["unit"] and not unit.fits(units.parse(units_of(name))):
        raise ValueError(f"unit mismatch: {text!r} for a number in {units_of(name)}")
    return float(match["value"]) * unit.scale, 0.0


def size_in_words(name: str, text: str) -> str:
    """Return a size as people write it."""
    absolute, _ = size(name, text)
    in_degrees = text.strip().endswith("deg")
    return shown(absolute, units_of(name)) if absolute and not in_degrees else text.strip()
