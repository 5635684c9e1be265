"""Values for people: a decimal prefix that keeps numbers short, units with a slash; as templates/numbers.js."""

import math
import re
import textwrap
from decimal import ROUND_HALF_UP, Context

_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_RAISED = str.maketrans("-0123456789/", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ")
_JOINED = "\N{NO-BREAK SPACE}"
_MINUS = "\N{MINUS SIGN}"
_DIGITS = 15  # by which the size of a value chooses its prefix: all that a double has for certain


def number(value: float | None, digits: int = 4) -> str:
    """A number for people: plain from 0.001 to 99999 and else with a power of ten; a dash for none."""
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


def prefixed(size: float, units: str, digits: int = _DIGITS) -> tuple[float, str]:
    """Return the divisor for values of some size, and the unit to write behind them.

    A prefix fits where the first symbol of the unit has no exponent, as in ``V m N-1``; a pure number has no unit.
    """
    scalable = re.match(r"[A-Za-z]+(?: |$)", units) is not None and not units.startswith("kg")
    power = 0
    if scalable and size and math.isfinite(size):
        decimal = Context(prec=digits, rounding=ROUND_HALF_UP).create_decimal_from_float(float(size)).adjusted()
        power = min(max(3 * (decimal // 3), -15), 12)
    return 10.0**power, (_PREFIXES[power] if scalable else "") + written(units)


def written(units: str) -> str:
    """A unit as people write it, nothing for a pure number."""
    if units == "1":
        return ""
    over: list[str] = []
    under: list[str] = []
    for symbol, minus, power in re.findall(r"([^\W\d]+|%)(-?)([0-9/]*)", units):
        (under if minus else over).append(symbol + (power.translate(_RAISED) if power != "1" else ""))
    if not under:
        return "·".join(over)
    below = "·".join(under)
    return f"{'·'.join(over) or '1'}/{below if len(under) == 1 else f'({below})'}"


def shown(value: float, units: str, digits: int = 5) -> str:
    """A value with its prefix and unit; a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    if units == "%":  # a share
        return f"{number(100 * value, digits)} %"
    size, text = prefixed(value, units, digits)
    return f"{number(value / size + 0.0, digits)} {text}".strip()  # no -0


def label(text: str, units: str, most: int) -> str:
    """A text and its unit in lines, no word cut, the unit in one piece."""
    unit = f" [{units.replace(' ', _JOINED)}]" if units else ""
    return textwrap.fill(text.strip() + unit, most, break_on_hyphens=False)
