"""Nodes below a point contact with air beside it, lengths in contact radii."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from solver.arrays import Array
from solver.point.friction import legendre

_FIRST, _MORE = 14, 6.0  # of S below a narrow contact, and what wide ones add
_POWER = 3  # of the nodes where the profile is a power of s that is not even
_GRADED, _STEEP = 4, 20  # power of those that crowd about both ends, and how many more they are


@dataclass(frozen=True, eq=False)
class ContactRule:
    """Nodes and weights on 0 to 1; (node,) each."""

    nodes: Array
    weights: Array

    @classmethod
    def of(cls, reach: float, *, even: bool = True) -> Self:
        """As many as layers that vary over 1/reach of the radius ask for: for even functions of s, or for powers.

        Those for even functions serve products of odd ones, too.
        """
        count = _FIRST + int(_MORE * (np.sqrt(reach) + reach))
        x, w = np.polynomial.legendre.leggauss(2 * count)
        if even:
            return cls(x[count:], w[count:])
        t = (1 + x) / 2
        return cls(t**_POWER, w / 2 * _POWER * t ** (_POWER - 1))

    @property
    def graded(self) -> Self:
        """As fine, and finer about both ends: for what is kinked at the apex and has a logarithm at the edge."""
        x, w = np.polynomial.legendre.leggauss(self.nodes.size + _STEEP)
        t = (1 + x) / 2
        half, weights = t**_GRADED / 2, w * _GRADED * t ** (_GRADED - 1) / 4
        return type(self)(np.concatenate([half, 1 - half]), np.concatenate([weights, weights]))

    @property
    def series(self) -> Array:
        """From even S at the nodes to coefficients of the tractions in f_n (points, 4); (n, node)."""
        count = self.nodes.size
        n = np.arange(count)
        values = np.polynomial.legendre.legvander(self.nodes, 2 * count - 2)[:, ::2].T
        return np.asarray(2 / np.pi * (-1.0) ** n[:, None] * (4 * n[:, None] + 1) * values * self.weights)

    @property
    def odd_series(self) -> Array:
        """From odd S at the nodes to coefficients of psi in P_n(2 b - 1) (points, 8); (n, node)."""
        count = 2 * self.nodes.size
        x, w = np.polynomial.legendre.leggauss(count)
        b, orders = (1 + x) / 2, np.arange(1, count, 2)
        own, there = (np.polynomial.legendre.legvander(s, count - 1)[:, 1::2] for s in (self.nodes, b))
        values = there * (2 * orders + 1) @ own.T * self.weights
        series = (2 * np.arange(count)[:, None] + 1) * (legendre(b, count).T * w / 2)
        return np.asarray(2 / np.pi * series @ values)
