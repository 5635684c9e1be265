"""Arithmetic of quantities as a tree with value, derivatives and unit."""

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
    """Return the unit of a quantity, constant or factor, as the interface writes it."""
    return (ALL_QUANTITIES.get(name) or CONSTANTS.get(name) or FACTORS[name]).units


class Expression(ABC):
    """A node of the tree."""

    @abstractmethod
    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Return the value, and its derivative by every name; arrays of the values' common shape."""

    @abstractmethod
    def unit(self) -> units.Unit | None:
        """Return the unit in SI, None for a bare number; ValueError where unlike units are added."""

    def evaluate(self, values: Mapping[str, Array]) -> Array:
        """Return the value without derivatives."""
        return self.partials(values)[0]

    def names(self) -> list[str]:
        """Return the names in the expression, each once, in their order."""
        return list(dict.fromkeys(node.name for node in self.walk() if isinstance(node, Name)))

    def interface_unit(self) -> str | None:
        """Return the interface's unit of a quantity, its size or a sum; None if the expression has another unit."""
        unit = self.unit()
        for name in self.names():
            if unit is not None and units.parse(units_of(name)).fits(unit):
                return units_of(name)
        return None

    def walk(self) -> Iterator["Expression"]:
        """Yield this node and every node below it."""
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
        """Return the value, which has no derivatives."""
        return np.float64(self.value) * np.ones(()), {}

    def unit(self) -> units.Unit | None:
        """Return the unit behind the number; None of a bare one, which takes the unit of what it is added to."""
        return self.measured_in


@dataclass(frozen=True)
class Name(Expression):
    """A quantity, factor or constant."""

    name: str

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Return the value of the name, and 1 as its derivative."""
        value = np.asarray(values[self.name], dtype=np.float64)
        return value, {self.name: np.ones_like(value)}

    def unit(self) -> units.Unit | None:
        """Return the unit of the name in the interface."""
        return units.parse(units_of(self.name))


@dataclass(frozen=True)
class Operation(Expression):
    """An operator or function of other expressions, by its symbol or name in `_RULES`."""

    symbol: str
    parts: tuple[Expression, ...]

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Return value and derivatives by the chain rule; at a kink the derivative from one side."""
        parts = [part.partials(values) for part in self.parts]
        total: Partials = {}
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # the search refuses poles by name
            value, *slopes = _RULES[self.symbol](*(value for value, _ in parts))
            for outer, (_, partials) in zip(slopes, parts, strict=True):
                for name, inner in partials.items():
                    total[name] = total[name] + outer * inner if name in total else outer * inner
        return value, total

    def unit(self) -> units.Unit | None:
        """Return the unit by the rules of units; ValueError where unlike units are added or compared."""
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


def _selected(index_of: Callable[..., Any], *values: Array) -> tuple[Any, ...]:
    """Return the value that `index_of` (argmin, argmax) selects, and its derivatives: 1 by the selected value."""
    stack = np.stack(np.broadcast_arrays(*values))
    index = index_of(stack, axis=0)
    slopes = (np.where(index == k, 1.0, 0.0) for k in range(len(values)))
    return np.take_along_axis(stack, index[None], 0)[0], *slopes


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
    "min": partial(_selected, np.argmin),
    "max": partial(_selected, np.argmax),
}
