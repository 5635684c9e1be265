"""Units: read ``MPa``, ``kV/mm``, ``V m N-1``, ``C m-3/2`` as a scale on SI and exponents of base units.

The notation is that of CF (a symbol and its exponent, a blank between symbols), with ``/`` before a divisor, ``%``, and
the decimal prefixes of the SI (BIPM, The International System of Units, 9th edition, table 7). Printed notation is read
as well: ``C/m²``, ``kN·m⁻¹``, ``N/(V·m)``, ``1.5×10⁹``, ``GΩ``, with its minus and blanks.
"""

import math
import re
from dataclasses import dataclass, field
from decimal import ROUND_HALF_UP, Context, Decimal
from fractions import Fraction
from functools import lru_cache
from math import isfinite
from typing import Self

_PREFIXES = {
    "": 1.0, "f": 1e-15, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2,
    "k": 1e3, "M": 1e6, "G": 1e9, "T": 1e12,
}  # fmt: skip
VACUUM_PERMITTIVITY = 8.8541878188e-12  # F/m (CODATA 2022)
VACUUM_PERMEABILITY = 1.25663706127e-6  # N s2/C2
BOLTZMANN = 1.380649e-23  # J/K, exact since 2019
FREEZING = 273.15  # K, zero of the Celsius scale
CELSIUS = ("degC", "°C", "℃")
_ALONE = {  # no prefix
    "%": (1e-2, (0, 0, 0, 0, 0)),
    "ppm": (1e-6, (0, 0, 0, 0, 0)),
    "1": (1.0, (0, 0, 0, 0, 0)),
    "deg": (math.pi / 180, (0, 0, 0, 0, 0)),
    "eps0": (VACUUM_PERMITTIVITY, (-3, -1, 4, 2, 0)),
    "mu0": (VACUUM_PERMEABILITY, (1, 1, -2, -2, 0)),
}
_SYMBOLS: dict[str, tuple[float, tuple[int, int, int, int, int]]] = {  # exponents of m, kg, s, A, K
    "m": (1.0, (1, 0, 0, 0, 0)),
    "g": (1e-3, (0, 1, 0, 0, 0)),
    "s": (1.0, (0, 0, 1, 0, 0)),
    "A": (1.0, (0, 0, 0, 1, 0)),
    "K": (1.0, (0, 0, 0, 0, 1)),
    "N": (1.0, (1, 1, -2, 0, 0)),
    "Pa": (1.0, (-1, 1, -2, 0, 0)),
    "J": (1.0, (2, 1, -2, 0, 0)),
    "W": (1.0, (2, 1, -3, 0, 0)),
    "C": (1.0, (0, 0, 1, 1, 0)),
    "V": (1.0, (2, 1, -3, -1, 0)),
    "F": (1.0, (-2, -1, 4, 2, 0)),
    "T": (1.0, (0, 1, -2, -1, 0)),
    "Wb": (1.0, (2, 1, -2, -1, 0)),
    "H": (1.0, (2, 1, -2, -2, 0)),
    "Ohm": (1.0, (2, 1, -3, -2, 0)),
    "rad": (1.0, (0, 0, 0, 0, 0)),
}
_PART = re.compile(
    r"(?P<over>/)?\s*(?P<symbol>%|1(?![0-9])|eps0|mu0|[A-Za-zµμ]+)\^?(?P<power>[-+]?[0-9]+(?:/[0-9]+)?)?"
)
_QUANTITY = re.compile(r"\s*([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)(?![0-9._eE])\s*(\S.*)")
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ᐟ", "0123456789-+/")
_TYPESET = {  # typographic characters and those of ASCII
    **dict.fromkeys("\u2212\u2013\ufe63\uff0d", "-"),  # minus signs
    **dict.fromkeys("\u00a0\u2007\u2008\u2009\u200a\u202f\u2005\u2006", " "),
    **dict.fromkeys("\u22c5\u2219\u2022\u2062", "·"),
    **dict.fromkeys("\u200b\u2060\ufeff", ""),
}
_PRINTED = str.maketrans(_TYPESET)
_OHM = re.compile(r"[\u03a9\u2126](?P<joined>(?=[A-Za-zµμ]))?")  # Greek letter and sign of the unit
_TEN = re.compile(
    r"(?P<mantissa>[0-9.])?(?P<times>\s*[×xX*·]\s*)?(?<![0-9.])10"
    r"(?:(?P<raised>[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)|(?:\^|\*\*)\(?(?P<power>[-+]?[0-9]+)\)?)"
)
_VACUUM = (re.compile("(?:[εϵ]|eps(?:ilon)?)_?[0₀]"), "eps0"), (re.compile("(?:[µμ]|mu)_?[0₀]"), "mu0")
_GROUPED = re.compile(r"/\s*\((?P<group>[^()]*)\)")
_FEW = 2  # most symbols of a readable unit
_BARE = re.compile(r"\s*[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,4})?\s*")
_LARGEST_POWER, _LONGEST = 9, 100  # an exponent, also of its denominator; characters of a unit, or of a number with it


@dataclass(frozen=True)
class Unit:
    """A scale on SI and the exponents of metre, kilogram, second, ampere and kelvin."""

    scale: float
    exponents: tuple[Fraction, ...]
    symbols: tuple[tuple[str, Fraction], ...] = field(default=(), compare=False)  # as written, with exponents

    @classmethod
    def none(cls) -> Self:
        """Return the unit of a pure number."""
        return cls(1.0, (Fraction(0),) * 5)

    def __mul__(self, other: "Unit") -> "Unit":
        powers = dict(self.symbols)
        for symbol, power in other.symbols:
            powers[symbol] = powers.get(symbol, Fraction(0)) + power
        exponents = tuple(a + b for a, b in zip(self.exponents, other.exponents, strict=True))
        return Unit(
            self.scale * other.scale, exponents, tuple((symbol, power) for symbol, power in powers.items() if power)
        )

    def power(self, exponent: Fraction) -> "Unit":
        """Return the unit raised to a rational exponent."""
        symbols = tuple((symbol, exponent * power) for symbol, power in self.symbols if exponent)
        return Unit(self.scale ** float(exponent), tuple(exponent * power for power in self.exponents), symbols)

    def fits(self, other: "Unit") -> bool:
        """Return whether both units measure the same kind of quantity."""
        return self.exponents == other.exponents

    def __str__(self) -> str:
        """Return the unit in SI without prefixes, in as few symbols as possible or as written, like ``V m N-1``."""
        symbols = _alone(self.exponents) or self.symbols
        if len(symbols) > _FEW:
            symbols = _per_length(self.exponents) or symbols
        ordered = [symbol for symbol in symbols if symbol[1] > 0] + [symbol for symbol in symbols if symbol[1] < 0]
        return " ".join(name if power == 1 else f"{name}{power}" for name, power in ordered) or "1"


def _alone(exponents: tuple[Fraction, ...]) -> tuple[tuple[str, Fraction], ...] | None:
    """Return the symbol, or the power of a base unit, with these exponents; empty for a pure number."""
    for symbol, (_, dimensions) in _SYMBOLS.items():
        if symbol not in ("g", "rad") and exponents == tuple(map(Fraction, dimensions)):
            return ((symbol, Fraction(1)),)
    powers = tuple((name, power) for name, power in zip(("m", "kg", "s", "A", "K"), exponents, strict=True) if power)
    return powers if len(powers) < 2 else None


def _per_length(exponents: tuple[Fraction, ...]) -> tuple[tuple[str, Fraction], ...] | None:
    """Return the symbol that has these exponents times a power of the metre, as ``V m-1``."""
    for symbol, (_, dimensions) in _SYMBOLS.items():
        length, *excess = (a - b for a, b in zip(exponents, dimensions, strict=True))
        if symbol not in ("g", "m", "rad") and not any(excess):
            return (symbol, Fraction(1)), ("m", length)
    return None


def plain(text: str) -> str:
    """Return a printed number or unit in the characters that are parsed: ``-1.5×10⁻³ C/m²`` as ``-1.5e-3 C/m^2``."""
    if text.isascii() and "10" not in text and "**" not in text and "(" not in text:
        return text
    for constant, written in _VACUUM:
        text = constant.sub(written, text)
    text = _OHM.sub(lambda ohm: "Ohm" + (" " if ohm["joined"] is not None else ""), text.translate(_PRINTED))
    # Latin-1 has raised digits, but no raised minus
    text = re.sub("(?<=[-+])[⁰¹²³⁴⁵⁶⁷⁸⁹]+", lambda raised: raised[0].translate(_RAISED), text)
    text = _TEN.sub(_exponent, text)
    text = re.sub("[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ]+", lambda raised: f"^{raised[0].translate(_RAISED)}", text)
    text = re.sub(r"(?:\^|\*\*)\(?(?P<power>[-+]?[0-9]+(?:/[0-9]+)?)\)?", r"^\g<power>", text)
    return _GROUPED.sub(lambda under: "/" + re.sub(r"\s*[·* ]\s*", "/", under["group"].strip()), text)


def _exponent(ten: re.Match[str]) -> str:
    """Return a power of ten after a number as ``e9``, one alone as ``1e9``."""
    power = (ten["raised"] or ten["power"]).translate(_RAISED)
    if ten["times"] is None:
        return ten[0] if ten["mantissa"] else f"1e{power}"
    return f"{ten['mantissa']}e{power}" if ten["mantissa"] else ten[0]


def parse(text: str) -> Unit:
    """Read a unit; an empty text is a pure number."""
    unit, position = Unit.none(), 0
    text = text.strip() if len(text) > _LONGEST else plain(text).strip()
    if len(text) > _LONGEST:
        raise ValueError(f"a unit of {len(text)} characters is longer than {_LONGEST}")
    while position < len(text):
        match = _PART.match(text, position)
        if match is None:
            raise ValueError(f"{text[position:]!r} is not a unit")
        power = _power(match["power"] or "1")
        unit *= _symbol(match["symbol"]).power(-power if match["over"] else power)
        position = match.end()
        position += len(text[position:]) - len(text[position:].lstrip(" *·"))
    if not (isfinite(unit.scale) and unit.scale > 0):
        raise ValueError(f"{text!r} is beyond the range of numbers")
    return unit


def _power(text: str) -> Fraction:
    """Read an exponent, a whole number or a fraction."""
    over, _, under = text.partition("/")
    top, bottom = int(over), int(under or 1)
    if abs(top) > _LARGEST_POWER or not 1 <= bottom <= _LARGEST_POWER:
        raise ValueError(f"{text!r}: an exponent must be a whole number from -9 to 9, or one over 2 to 9")
    return Fraction(top, bottom)


@lru_cache(maxsize=1024)  # numbers of a device are asked for at every step of a search
def in_si(text: str, units: str) -> float:
    """Read a number with its unit in SI, rounded once: ``11.2 nF/m`` is 11.2e-9, ``33 degC`` is 306.15 K."""
    if "±" in text:
        raise ValueError(f"{text[:_LONGEST]!r} has an error behind it; write the value alone, as '5 {units}'")
    read = plain(text) if len(text) <= _LONGEST else text
    match = _QUANTITY.fullmatch(read) if len(read) <= _LONGEST else None
    if match is None and read != text and _BARE.fullmatch(read):
        return float(read)
    if match is None:
        raise ValueError(f"{text[:_LONGEST]!r} is not a finite number [{units}], nor one with its unit")
    if units == "K" and match[2].strip() in CELSIUS:
        return float(Decimal(match[1]) + Decimal(str(FREEZING)))
    unit = parse(match[2])
    if not unit.fits(parse(units)):
        raise ValueError(f"{text!r}: unit mismatch: {match[2]!r} does not measure what {units!r} measures")
    value = scaled(match[1], unit.scale)
    if not isfinite(value):
        raise ValueError(f"{text!r} is not a finite number [{units}]")
    return value


def scaled(text: str, scale: float) -> float:
    """Return a number in digits times a scale, rounded once; one that is not finite stays as it is."""
    return float(Decimal(text) * Decimal(repr(scale))) if isfinite(float(text)) else float(text)


def _symbol(text: str) -> Unit:
    """Read a symbol with its prefix."""
    if text in _ALONE:
        scale, exponents = _ALONE[text]
        return Unit(scale, tuple(map(Fraction, exponents)))
    for symbol, (scale, exponents) in _SYMBOLS.items():
        if text.endswith(symbol) and text[: -len(symbol)] in _PREFIXES:
            name = "kg" if symbol == "g" else symbol
            return Unit(
                scale * _PREFIXES[text[: -len(symbol)]], tuple(map(Fraction, exponents)), ((name, Fraction(1)),)
            )
    raise ValueError(f"{text!r} is not a unit; known are {', '.join(_SYMBOLS)} with decimal prefixes, and %")


_PRINTED_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_RAISING = str.maketrans("-0123456789/", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹ᐟ")
_DEGREE = math.pi / 180  # rad
_DIGITS = 15  # to which a value is rounded to choose its prefix: those that a double certainly has


def prefixed(size: float, units: str, digits: int = _DIGITS) -> tuple[float, str]:
    """Return the divisor for values of a size, and the unit to print after them; angles are in degrees from 1 deg."""
    if units == "rad" and _DEGREE <= abs(size) < math.inf:
        return _DEGREE, "deg"
    # a prefix fits if the first symbol of the unit has no exponent, as in ``V m N-1``, or is an area
    scalable = re.match(r"(?:[A-Za-z]+|m2)(?: |$)", units) is not None and not units.startswith("kg")
    exponent, shift, least, most = (2, 2, -9, 0) if units.startswith("m2") else (1, 0, -15, 12)  # 0.01 to 9999 mm²
    power = 0
    if scalable and size and math.isfinite(size):
        decimal = Context(prec=digits, rounding=ROUND_HALF_UP).create_decimal_from_float(float(size)).adjusted()
        power = min(max(3 * ((decimal + shift) // (3 * exponent)), least), most)
    return 10.0 ** (exponent * power), (_PRINTED_PREFIXES[power] if scalable else "") + written(units)


def written(units: str) -> str:
    """Return a unit as people write it, empty for a pure number."""
    if units == "1":
        return ""
    over: list[str] = []
    under: list[str] = []
    for symbol, minus, power in re.findall(r"([^\W\d]+|%)(-?)([0-9/]*)", units):
        (under if minus else over).append(symbol + (power.translate(_RAISING) if power != "1" else ""))
    if not under:
        return "·".join(over)
    below = "·".join(under)
    return f"{'·'.join(over) or '1'}/{below if len(under) == 1 else f'({below})'}"
