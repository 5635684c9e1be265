"""Arithmetic of quantities as a tree that knows its value, its derivatives and its unit."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
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
    """``left symbol right`` with + - * /."""

    symbol: str
    left: Expression
    right: Expression

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Value and derivatives of a sum, product or quotient."""
        a, da = self.left.partials(values)
        b, db = self.right.partials(values)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # a pole is found and named by the search
            if self.symbol in "+-":
                sign = 1.0 if self.symbol == "+" else -1.0
                return a + sign * b, _combined((1.0, da), (sign, db))
            if self.symbol == "*":
                return a * b, _combined((b, da), (a, db))
            return a / b, _combined((1 / b, da), (-a / b**2, db))

    def unit(self) -> units.Unit | None:
        """Equal units add; products and quotients multiply."""
        a, b = self.left.unit(), self.right.unit()
        if self.symbol in "+-":
            if a is not None and b is not None and not a.fits(b):
                raise ValueError(f"{str(a)!r} and {str(b)!r} cannot be added (unit mismatch)")
            return a or b
        if a is None and b is None:
            return None
        a, b = a or units.Unit.none(), b or units.Unit.none()
        return a * (b if self.symbol == "*" else b.power(Fraction(-1)))


@dataclass(frozen=True)
class Power(Expression):
    """An integer power."""

    base: Expression
    exponent: int

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Value and derivatives of a power."""
        a, da = self.base.partials(values)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            slope = self.exponent * a ** float(self.exponent - 1) if self.exponent else np.zeros_like(a)
            return a ** float(self.exponent), _combined((slope, da))

    def unit(self) -> units.Unit | None:
        """The base's unit, raised."""
        inner = self.base.unit()
        return inner.power(Fraction(self.exponent)) if inner is not None else None


@dataclass(frozen=True)
class Call(Expression):
    """A function of one argument; min and max take two or more."""

    function: str
    arguments: tuple[Expression, ...]

    def partials(self, values: Mapping[str, Array]) -> tuple[Array, Partials]:
        """Value and derivatives by the chain rule; at a kink the derivative from one side."""
        parts = [argument.partials(values) for argument in self.arguments]
        a, da = parts[0]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            if self.function == "abs":
                return np.abs(a), _combined((np.where(a < 0, -1.0, 1.0), da))
            if self.function == "sqrt":
                return np.sqrt(a), _combined((0.5 / np.sqrt(a), da))
            if self.function == "log":
                return np.log(a), _combined((1 / a, da))
            if self.function == "exp":
                return np.exp(a), _combined((np.exp(a), da))
        stack = np.stack(np.broadcast_arrays(*(value for value, _ in parts)))
        chosen = stack.argmin(0) if self.function == "min" else stack.argmax(0)
        value = np.take_along_axis(stack, chosen[None], 0)[0]
        return value, _combined(*((np.where(chosen == k, 1.0, 0.0), slope) for k, (_, slope) in enumerate(parts)))

    def unit(self) -> units.Unit | None:
        """That of the arguments, its root, or none."""
        inner = [unit for unit in (argument.unit() for argument in self.arguments) if unit is not None]
        for other in inner[1:]:
            if not other.fits(inner[0]):
                raise ValueError(
                    f"{self.function}: {str(inner[0])!r} and {str(other)!r} cannot be compared (unit mismatch)"
                )
        if not inner:
            return None
        if self.function in ("log", "exp") and not inner[0].fits(units.Unit.none()):
            raise ValueError(f"{self.function} needs a pure number, not {str(inner[0])!r} (unit mismatch)")
        return inner[0].power(Fraction(1, 2)) if self.function == "sqrt" else inner[0]


def _combined(*parts: tuple[Any, Partials]) -> Partials:
    """Sum of weight times partials."""
    total: Partials = {}
    for weight, partials in parts:
        for name, slope in partials.items():
            total[name] = total[name] + weight * slope if name in total else weight * slope
    return total
