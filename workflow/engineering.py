"""Values for people: a decimal prefix that keeps numbers short, exponents as superscripts."""

import re

import numpy as np

_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_RAISED = str.maketrans("-0123456789/", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ")


def prefixed(size: float, units: str) -> tuple[float, str]:
    """What to divide values of some size by, and the unit to write then.

    A prefix fits where the first symbol of the unit has no exponent, as in ``V m N-1``; a pure number has no unit.
    """
    scalable = re.match(r"[A-Za-z]+(?: |$)", units) is not None and not units.startswith("kg")
    power = 0
    if scalable and size and np.isfinite(size):
        power = int(np.clip(3 * np.floor(np.log10(abs(size)) / 3), -15, 12))
    return 10.0**power, (_PREFIXES[power] if scalable else "") + raised(units)


def raised(units: str) -> str:
    """Exponents of a unit as superscripts: ``V m N-1`` as V m N⁻¹, nothing for a pure number."""
    if units == "1":
        return ""
    return re.sub(r"([A-Za-z])(-?[0-9/]+)", lambda match: match[1] + match[2].translate(_RAISED), units)


def shown(value: float, units: str, digits: int = 5) -> str:
    """A value with its prefix and unit, as 122.61 mm; a dash where there is none."""
    if not np.isfinite(value):
        return "–"
    size, text = prefixed(value, units)
    number = value / size
    if number and not 1e-3 <= abs(number) < 1e5:
        mantissa, _, power = f"{number:.{digits - 1}e}".partition("e")
        plain = f"{float(mantissa):g}×10{str(int(power)).translate(_RAISED)}"
    else:
        plain = f"{number:.{digits}g}"
    return f"{plain.replace('-', '−')} {text}".strip()
