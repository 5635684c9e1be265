"""Units: ``MPa``, ``kV/mm``, ``V m N-1``, ``C m-3/2`` to a scale on SI and the exponents of metre, kilogram, ...

The notation is that of CF (a symbol with its exponent behind it, a blank between symbols), with ``/`` for the symbols
behind it, ``%``, and the decimal prefixes of the SI (BIPM, The International System of Units, 9th edition, table 7).
"""

import re
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import isfinite
from typing import Self

_PREFIXES = {
    "": 1.0, "f": 1e-15, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2,
    "k": 1e3, "M": 1e6, "G": 1e9, "T": 1e12,
}  # fmt: skip
_ALONE = {"%": (1e-2, (0, 0, 0, 0, 0)), "1": (1.0, (0, 0, 0, 0, 0))}  # no prefix
_SYMBOLS: dict[str, tuple[float, tuple[int, int, int, int, int]]] = {  # exponents of m, kg, s, A, K
    "m": (1.0, (1, 0, 0, 0, 0)),
    "g": (1e-3, (0, 1, 0, 0, 0)),
    "s": (1.0, (0, 0, 1, 0, 0)),
    "A": (1.0, (0, 0, 0, 1, 0)),
    "K": (1.0, (0, 0, 0, 0, 1)),
    "N": (1.0, (1, 1, -2, 0, 0)),
    "Pa": (1.0, (-1, 1, -2, 0, 0)),
    "J": (1.0, (2, 1, -2, 0, 0)),
    "C": (1.0, (0, 0, 1, 1, 0)),
    "V": (1.0, (2, 1, -3, -1, 0)),
    "F": (1.0, (-2, -1, 4, 2, 0)),
    "T": (1.0, (0, 1, -2, -1, 0)),
    "Wb": (1.0, (2, 1, -2, -1, 0)),
    "H": (1.0, (2, 1, -2, -2, 0)),
    "Ohm": (1.0, (2, 1, -3, -2, 0)),
}
_PART = re.compile(r"(?P<over>/)?\s*(?P<symbol>%|1|[A-Za-zµμ]+)\^?(?P<power>[-+]?[0-9]+(?:/[0-9]+)?)?")
_QUANTITY = re.compile(r"\s*([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)(?![0-9._eE])\s*(\S.*)")
_FEW = 2  # symbols of a unit that reads well
_LARGEST_POWER, _LONGEST = 9, 100  # an exponent, also of its denominator; characters of a unit, or of a number with it


@dataclass(frozen=True)
class Unit:
    """A scale on SI and the exponents of metre, kilogram, second, ampere and kelvin.

    ``symbols`` are those that it was made of, with their exponents: what a reader knows it by.
    """

    scale: float
    exponents: tuple[Fraction, ...]
    symbols: tuple[tuple[str, Fraction], ...] = field(default=(), compare=False)

    @classmethod
    def none(cls) -> Self:
        """The unit of a pure number."""
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
        """The unit raised to a rational exponent."""
        symbols = tuple((symbol, exponent * power) for symbol, power in self.symbols if exponent)
        return Unit(self.scale ** float(exponent), tuple(exponent * power for power in self.exponents), symbols)

    def fits(self, other: "Unit") -> bool:
        """Whether both measure the same kind of quantity."""
        return self.exponents == other.exponents

    def __str__(self) -> str:
        """In SI without prefixes: as few symbols as tell it, or what it was made of, as ``V m N-1``."""
        symbols = _alone(self.exponents) or self.symbols
        if len(symbols) > _FEW:
            symbols = _per_length(self.exponents) or symbols
        ordered = [symbol for symbol in symbols if symbol[1] > 0] + [symbol for symbol in symbols if symbol[1] < 0]
        return " ".join(name if power == 1 else f"{name}{power}" for name, power in ordered) or "1"


def _alone(exponents: tuple[Fraction, ...]) -> tuple[tuple[str, Fraction], ...] | None:
    """The one symbol, or the power of a base unit, that has these exponents; nothing for a pure number."""
    for symbol, (_, own) in _SYMBOLS.items():
        if symbol != "g" and exponents == tuple(map(Fraction, own)):
            return ((symbol, Fraction(1)),)
    powers = tuple((name, power) for name, power in zip(("m", "kg", "s", "A", "K"), exponents, strict=True) if power)
    return powers if len(powers) < 2 else None


def _per_length(exponents: tuple[Fraction, ...]) -> tuple[tuple[str, Fraction], ...] | None:
    """The symbol that, times a power of the metre, has these exponents, as ``V m-1``."""
    for symbol, (_, own) in _SYMBOLS.items():
        length, *rest = (a - b for a, b in zip(exponents, own, strict=True))
        if symbol not in ("g", "m") and not any(rest):
            return (symbol, Fraction(1)), ("m", length)
    return None


def parse(text: str) -> Unit:
    """Read a unit; an empty text is a pure number."""
    unit, position = Unit.none(), 0
    text = text.strip()
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
    over, _, under = text.partition("/")
    top, bottom = int(over), int(under or 1)
    if abs(top) > _LARGEST_POWER or not 1 <= bottom <= _LARGEST_POWER:
        raise ValueError(f"{text!r}: an exponent must be a whole number from -9 to 9, or one over 2 to 9")
    return Fraction(top, bottom)


@lru_cache(maxsize=1024)  # numbers of a device are asked for at every step of a search
def in_si(text: str, units: str) -> float:
    """Read a number with its unit, as ``115 GPa`` or ``115GPa``: its value in SI.

    What a decimal prefix does is rounded once: ``11.2 nF/m`` is 11.2e-9 to the last bit.
    """
    match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError(f"{text[:_LONGEST]!r} is not a finite number [{units}], nor one with its unit")
    unit = parse(match[2])
    if not unit.fits(parse(units)):
        raise ValueError(f"{text!r}: unit mismatch: {match[2]!r} does not measure what {units!r} measures")
    value = scaled(match[1], unit.scale)
    if not isfinite(value):
        raise ValueError(f"{text!r} is not a finite number [{units}]")
    return value


def scaled(text: str, scale: float) -> float:
    """A number in digits, times a scale, rounded once; one that is not finite as it is."""
    return float(Decimal(text) * Decimal(repr(scale))) if isfinite(float(text)) else float(text)


def _symbol(text: str) -> Unit:
    if text in _ALONE:
        scale, exponents = _ALONE[text]
        return Unit(scale, tuple(map(Fraction, exponents)))
    for symbol, (scale, exponents) in _SYMBOLS.items():
        if text.endswith(symbol) and text[: -len(symbol)] in _PREFIXES:
            known = "kg" if symbol == "g" else symbol
            return Unit(
                scale * _PREFIXES[text[: -len(symbol)]], tuple(map(Fraction, exponents)), ((known, Fraction(1)),)
            )
    raise ValueError(f"{text!r} is not a unit; known are {', '.join(_SYMBOLS)} with decimal prefixes, and %")
