"""Arithmetic of quantities as a tree that knows its value, its derivatives and its unit."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from approximation.arrays import Array
from solver import units
from solver.names import ALL_QUANTITIES
from workflow.language.constants import CONSTANTS
from workflow.language.factors import FACTORS

Partials = dict[str, Array]


def units_of(name: str) -> str:
    """The unit of a quantity, constant or factor, as the interface writes it."""
    return (ALL_QUANTITIES.get(name) or CONSTANTS.get(name) or FACTORS[name]).units


class Expression(ABC):
    """A node of the tree."""

    @abstractmethod
    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Value, and derivative by every name that occurs; arrays of the values' common shape."""

    @abstractmethod
    def unit(self) -> units.Unit | None:
        """Unit in SI, None for a bare number; ValueError where unlike units are added."""

    def evaluate(self, values: Mapping[str, Array]) -> Array:
        """Value alone."""
        return self.partials(values)[0]

    def names(self) -> list[str]:
        """Names that occur, each once, in their order."""
        return list(dict.fromkeys(node.name for node in self.walk() if isinstance(node, Name)))

    def lone(self) -> str | None:
        """The interface's unit where that is the expression's: a quantity, its size, sums; None otherwise."""
        unit = self.unit()
        for name in self.names():
            if unit is not None and units.parse(units_of(name)).fits(unit):
                return units_of(name)
        return None

    def walk(self) -> Iterator["Expression"]:
        """Itself and every node below."""
        yield self
        for part in vars(self).values():
            for node in part if isinstance(part, tuple) else (part,):
                if isinstance(node, Expression):
                    yield from node.walk()


@dataclass(frozen=True)
class Number(Expression):
    """A literal."""

    value: float  # In SI
    measured_in: units.Unit | None = None  # Its unit, where it was written with one

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """The value, with no derivative."""
        return np.float64(self.value) * np.ones(()), {}

    def unit(self) -> units.Unit | None:
        """Unit that stands behind it; None of a bare number: it takes the unit of what it is added to."""
        return self.measured_in


@dataclass(frozen=True)
class Name(Expression):
    """A quantity, factor or constant."""

    name: str

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """The value given under the name."""
        value = np.asarray(values[self.name], dtype=np.float64)
        return value, {self.name: np.ones_like(value)}

    def unit(self) -> units.Unit | None:
        """Unit of the interface."""
        return units.parse(units_of(self.name))


@dataclass(frozen=True)
class Operation(Expression):
    """An operator or function of other expressions, by its symbol or name in `_RULES`."""

    symbol: str
    parts: tuple[Expression, ...]

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Value and derivatives by the chain rule; at a kink the derivative from one side."""
        parts = [part.partials(values) for part in self.parts]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # a pole is found and named by the search
            value, *slopes = _RULES[self.symbol](*(value for value, _ in parts))
            return value, _combined(*zip(slopes, (inner for _, inner in parts), strict=True))

    def unit(self) -> units.Unit | None:
        """Equal units add and compare; products and quotients multiply; powers and roots have those of their unit."""
        inner = [part.unit() for part in self.parts]
        known = [unit for unit in inner if unit is not None]
        if not known:
            return None
        if self.symbol in ("*", "/"):
            left, right = (unit or units.Unit.none() for unit in inner)
            return left * (right if self.symbol == "*" else right.power(Fraction(-1)))
        if isinstance(power := self.parts[-1], Number) and self.symbol == "^":
            return known[0].power(Fraction(int(power.value)))
        for other in known[1:]:
            if not other.fits(known[0]):
                how, named = ("added", "") if self.symbol in ("+", "-") else ("compared", f"{self.symbol}: ")
                raise ValueError(f"{named}{str(known[0])!r} and {str(other)!r} cannot be {how} (unit mismatch)")
        if self.symbol in ("log", "exp") and not known[0].fits(units.Unit.none()):
            raise ValueError(f"{self.symbol} needs a pure number, not {str(known[0])!r} (unit mismatch)")
        return known[0].power(Fraction(1, 2)) if self.symbol == "sqrt" else known[0]


def _chosen(place: Callable[..., Any], *values: Array) -> tuple[Any, ...]:
    """The value at a place among several, and its slopes by each: 1 by the one that is chosen."""
    stack = np.stack(np.broadcast_arrays(*values))
    chosen = place(stack, axis=0)
    slopes = (np.where(chosen == k, 1.0, 0.0) for k in range(len(values)))
    return np.take_along_axis(stack, chosen[None], 0)[0], *slopes


#: Value of each operator and function, then its derivative by each part.
_RULES: dict[str, Callable[..., tuple[Any, ...]]] = {
    "+": lambda a, b: (a + b, 1.0, 1.0),
    "-": lambda a, b: (a - b, 1.0, -1.0),
    "*": lambda a, b: (a * b, b, a),
    "/": lambda a, b: (a / b, 1 / b, -a / b**2),
    "^": lambda a, b: (a**b, np.where(b == 0, 0.0, b * a ** (b - 1)), 0.0),  # whose exponent is a number
    "abs": lambda a: (np.abs(a), np.where(a < 0, -1.0, 1.0)),
    "sqrt": lambda a: (np.sqrt(a), 0.5 / np.sqrt(a)),
    "log": lambda a: (np.log(a), 1 / a),
    "exp": lambda a: (np.exp(a), np.exp(a)),
    "min": partial(_chosen, np.argmin),
    "max": partial(_chosen, np.argmax),
}


def _combined(*parts: tuple[Any, Partials]) -> Partials:
    """Sum of weight times partials."""
    total: Partials = {}
    for weight, partials in parts:
        for name, slope in partials.items():
            total[name] = total[name] + weight * slope if name in total else weight * slope
    return total
