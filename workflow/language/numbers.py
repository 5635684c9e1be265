"""Numbers as texts for people, with decimal prefixes; templates/numbers.js writes them alike."""

import math
import textwrap
from decimal import ROUND_HALF_UP, Context

from solver.units import prefixed

_RAISED = str.maketrans("-0123456789/", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ")
_JOINED = "\N{NO-BREAK SPACE}"
_MINUS = "\N{MINUS SIGN}"


def number(value: float | None, digits: int = 4) -> str:
    """Return a number as text: plain from 0.001 to 99999, else with a power of ten; a dash for none."""
    if value is None or not math.isfinite(value):
        return "–"
    # halves away from zero, as JavaScript rounds them
    rounded = Context(prec=digits, rounding=ROUND_HALF_UP).create_decimal_from_float(float(value))
    power = rounded.adjusted() if rounded else 0
    if -3 <= power < 5:
        return f"{rounded.normalize():f}".replace("-", _MINUS)
    mantissa = f"{rounded.scaleb(-power).normalize():f}"
    return f"{mantissa}×10{str(power).translate(_RAISED)}".replace("-", _MINUS)


def counted(count: float) -> str:
    """Return a count in groups of three digits."""
    return f"{int(count):,}"


def shown(value: float, units: str, digits: int = 5) -> str:
    """Return a value with its prefix and unit; a dash for a value that is not finite."""
    if not math.isfinite(value):
        return "–"
    if units == "%":  # a share
        return f"{number(100 * value, digits)} %"
    size, text = prefixed(value, units, digits)
    return f"{number(value / size + 0.0, digits)} {text}".strip()  # no -0


def label(text: str, units: str, width: int) -> str:
    """Return a text and its unit in lines of a width in letters; neither words nor the unit are broken."""
    unit = f" [{units.replace(' ', _JOINED)}]" if units else ""
    return textwrap.fill(text.strip() + unit, width, break_on_hyphens=False)
