"""Axes that are products of powers of the inputs: their values and derivatives."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from approximation.arrays import Array
from surrogate.data.inputs import Input

Powers = Mapping[str, float]
# How far an axis may lie beyond its range, as a share of it, and still be its end.
NEAR = 1e-9


@dataclass(frozen=True)
class Group:
    """A training axis: a range with its scale, and the powers of the inputs whose product it is.

    Parameters
    ----------
    axis : Input
        Name, range, scale and units of the axis; the range must hold what the inputs' box gives, see `span`.
    powers : mapping of str to float
        Power of every input that it is made of; an input alone is ``{name: 1}``.
    constant : float
        What the product is multiplied by: the part that depends on no input.
    """

    axis: Input
    powers: Powers
    constant: float = 1.0


class Axes:
    """The axes as functions of points in the inputs."""

    def __init__(self, inputs: Sequence[Input], groups: Sequence[Group]) -> None:
        self.powers = np.stack([row_of(group.powers, inputs) for group in groups])
        self._constants = [group.constant for group in groups]
        self._low, self._high = np.array([(group.axis.low, group.axis.high) for group in groups]).T

    def values(self, X: Array) -> Array:
        """Return the axes' values at points (n, d): (n, axes), within their ranges where the points are in the box."""
        products = zip(self._constants, self.powers, strict=True)
        U = np.stack([constant * _product(X, row) for constant, row in products], axis=1)
        inside = np.clip(U, self._low, self._high)
        near = NEAR * (self._high - self._low)
        return np.asarray(np.where(np.abs(U - inside) <= near, inside, U))  # the ends, met but for rounding

    def jacobian(self, X: Array) -> Array:
        """Return the derivatives of the axes' values by the inputs at points (n, d): (axes, d, n)."""
        products = zip(self._constants, self.powers, strict=True)
        return np.stack([constant * _slopes(X, row) for constant, row in products])


def row_of(powers: Powers, inputs: Sequence[Input]) -> Array:
    """Return the power of every input, (d,)."""
    return np.array([powers.get(input_.name, 0.0) for input_ in inputs])


def middle(factor: Input) -> float:
    """Return the middle of a range on its scale."""
    return float(factor.from_unit(0.0))


def span(inputs: Sequence[Input], powers: Powers) -> tuple[float, float]:
    """Return the least and the largest value of a product of powers over a box."""
    low = high = 1.0
    for input_ in inputs:
        power = powers.get(input_.name, 0.0)
        if not power:
            continue
        ends = [input_.low**power, input_.high**power] + ([0.0] if input_.low < 0 < input_.high else [])
        products = [a * b for a in (low, high) for b in (min(ends), max(ends))]
        low, high = min(products), max(products)
    return low, high


def _product(X: Array, row: Array) -> Array:
    factors: list[Array] = [_power(X[:, k], row[k]) for k in np.flatnonzero(row)]
    return np.asarray(np.prod(factors, axis=0))


def _slopes(X: Array, row: Array) -> Array:
    """Derivatives of a product by every input, (d, n)."""
    slopes = np.zeros((len(row), len(X)))
    for k in np.flatnonzero(row):
        others = row.copy()
        others[k] = 0.0
        slopes[k] = row[k] * _power(X[:, k], row[k] - 1) * (_product(X, others) if others.any() else 1.0)
    return slopes


def _power(x: Array, power: float) -> Array:
    """Powers; whole small ones by products and quotients, which are exact at the ends of a range."""
    by_power: dict[float, Callable[[Array], Array]] = {
        0.0: np.ones_like, 1.0: np.asarray, 2.0: np.square, -1.0: np.reciprocal
    }  # fmt: skip
    return by_power[power](x) if power in by_power else np.asarray(x**power)
