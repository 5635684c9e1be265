"""Abel transforms of ring charges around a point contact, on the panels of a line contact (points, sections 6 and 8).

Lengths are in contact radii. Parts that vary as cos(angle) have the factor (s/r)^m, m = 1, in both integrals.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.cache import cached
from solver.gap.grid import Grid, gauss
from solver.halfplane.pressing import ContactError

_NODES_IN_TAU = 24  # theta' = theta +- tau^2 has no root at the target

_FARTHEST = 1e5  # end of the finite panels in contact radii, for usual contacts
_MARGIN = 10.0  # of the panels' end over the gap's: beyond, densities are the last panel's powers to 1e-9
_END_RATIO = 100.0  # of the ends of successive grids: contacts within it share one
_NARROWEST = 1e-12  # contact radius over the gap's end: a contact of an atom under a ball of 100 m
_LAST_LENGTH = 6.3  # of the infinite panel in theta: S is negligible beyond
_RULE = 9  # nodes between two breaks of a rule


@dataclass(frozen=True, eq=False)
class Rings:
    """Transforms of densities at the nodes of a grid; they are the same for every body and radius."""

    grid: Grid
    order: int = 0  # m

    @property
    def parity(self) -> int:
        """Parity of S and chi in s: 1 even, -1 odd."""
        return 1 - 2 * self.order

    @cached_property
    def turned(self) -> "Rings":
        """Rings of the same grid whose densities vary as cos(angle)."""
        return Rings(self.grid, 1)

    @cached_property
    def size(self) -> Array:
        """Densities over the unknowns at the nodes, (n,): 1/r^2, by which densities in wide gaps fall."""
        return np.asarray(1 / self.grid.distance**2)

    @cached_property
    def ends(self) -> Array:
        """Ends of the panels in theta; (panel + 1,)."""
        return np.append(self.grid.ends, self.grid.ends[-1] + _LAST_LENGTH)

    @cached_property
    def rule(self) -> tuple[Array, Array]:
        """Nodes and weights of :meth:`ruled` on whole panels."""
        return self.ruled(np.arange(self.grid.panels), self.ends[:-1], self.ends[1:])

    def ruled(self, panel: Indices, start: Array, stop: Array) -> tuple[Array, Array]:
        """Nodes s on pieces of panels, (piece, point), and weights of int S ds from S over ``size``, (..., node)."""
        x, w = gauss(np.array([0.0, 1.0]), _RULE)
        theta = start[:, None] + (stop - start)[:, None] * x
        s = np.cosh(theta)
        weights = (stop - start)[:, None] * w * np.sinh(theta) / s**2
        return s, weights[..., None] * self.grid.interpolations_at(panel, theta)

    @cached_property
    def abel(self) -> Array:
        """Matrix from densities over their size to S at the nodes; (n, n)."""
        grid, theta = self.grid, self.grid.theta
        result = np.zeros((grid.count, grid.count))
        for panel in range(grid.panels - 1):
            low, high = grid.limits[panel]
            rows = np.flatnonzero(theta < high)
            target = theta[rows, None]
            tau, weights = _between(np.sqrt(np.maximum(low - theta[rows], 0)), np.sqrt(high - theta[rows]))
            source = target + tau**2
            kernel = 2 * weights * np.tanh(source) / np.sqrt(np.sinh(source + target) * _sinhc(tau))
            kernel *= (np.cosh(target) / np.cosh(source)) ** self.order
            shape = grid.interpolations(np.full(rows.size, panel), source)
            result[rows, grid.slice(panel)] = np.einsum("rp,rpn->rn", kernel, shape)
        v = np.exp(-theta)[:, None]
        start = grid.limits[-1, 1]  # of the infinite panel in u = exp(-theta)
        tau, weights = _between(np.sqrt(1 - np.minimum(start / v[:, 0], 1)), np.ones(grid.count))
        u = v * (1 - tau**2)
        kernel = 4 * weights * v * (1 - u**2) / (1 + u**2) / np.sqrt((2 - tau**2) * (1 - (u * v) ** 2))
        kernel *= ((1 - tau**2) * (1 + v**2) / (1 + u**2)) ** self.order
        shape = grid.interpolations(np.full(grid.count, grid.panels - 1), u)
        result[:, grid.slice(grid.panels - 1)] = np.einsum("rp,rpn->rn", kernel, shape)
        return result

    @cached_property
    def at_edge(self) -> Array:
        """Row from densities over their size to S(1); (n,)."""
        return self._integrated(lambda theta: np.cosh(theta) ** -self.order / np.sinh(theta))

    @cached_property
    def totals(self) -> Array:
        """Row from densities over their size to int_1^inf S ds, of order 0; (n,)."""
        return self._integrated(lambda theta: np.arctan(np.sinh(theta)))

    def poisson(self, x: Array) -> Array:
        """Density induced below the contact at x = sqrt(1 - r^2), without the part of S within; (x, n)."""
        height, r = x[:, None], np.sqrt((1 - x) * (1 + x))[:, None]

        def induced(theta: Array) -> Array:
            kernel = 2 / np.pi * height / (np.sinh(theta) * (np.sinh(theta) ** 2 + height**2))
            return np.asarray(kernel * (r / np.cosh(theta)) ** self.order)

        return self._integrated(induced)

    def interpolation(self, r: Array) -> Array:
        """Matrix from densities over their size to densities at r > 1; (r, n)."""
        return np.asarray(self.grid.interpolation(np.arccosh(r)) / r[:, None] ** 2)

    def _integrated(self, function: Callable[[Array], Array]) -> Array:
        """Row of int f D r dr for functions f of theta, (..., point); (..., n)."""
        return self.grid.integrated(lambda theta: function(theta) / (np.cosh(theta) * self.grid.size_at(theta)))

    @cached_property
    def displacement(self) -> Array:
        """Matrix from F at the nodes to (2/pi) int_1^r F (s/r)^m ds / sqrt(r^2 - s^2) at the nodes r; (n, n)."""
        grid, result = self.grid, np.zeros((self.grid.count, self.grid.count))
        for panel, rows, source, kernel in self._rules():
            shape = grid.interpolations_at(np.full(rows.size, panel), source)
            result[rows, grid.slice(panel)] = np.einsum("rp,rpn->rn", kernel, shape)
        return result

    def power(self, exponent: float) -> Array:
        """Return (2/pi) int_1^r (s^exponent - 1) (s/r)^m ds / sqrt(r^2 - s^2) at the nodes r; (n,)."""
        if exponent not in self._powers:
            result = np.zeros(self.grid.count)
            for _, rows, source, kernel in self._rules():
                result[rows] += np.sum(kernel * np.expm1(exponent * np.log1p(2 * np.sinh(source / 2) ** 2)), -1)
            self._powers[exponent] = result
        return self._powers[exponent]

    @cached_property
    def _powers(self) -> dict[float, Array]:
        return {}

    def _rules(self) -> Iterator[tuple[int, Indices, Array, Array]]:
        """Yield each panel, the nodes beyond its start, and theta and weights of their rules, (target, point)."""
        grid, theta = self.grid, self.grid.theta
        ends = np.append(grid.ends, np.inf)
        for panel in range(grid.panels):
            low, high = ends[panel], ends[panel + 1]
            rows = np.flatnonzero(theta > low)
            target = theta[rows, None]
            tau, weights = _between(np.sqrt(np.maximum(theta[rows] - high, 0)), np.sqrt(theta[rows] - low))
            source = target - tau**2
            kernel = 4 / np.pi * weights * np.sinh(source) / np.sqrt(np.sinh(target + source) * _sinhc(tau))
            yield panel, rows, source, kernel * (np.cosh(source) / np.cosh(target)) ** self.order


@cached
def rings(reach: float) -> Rings:
    """Rings whose finite panels end at ``reach`` contact radii, shared by all contacts."""
    return Rings(Grid.up_to(reach))


def reach_of(radius: float, end: float) -> float:
    """End of the finite panels in contact radii, for a contact whose gap ends at the distance ``end``."""
    if not radius >= _NARROWEST * end:
        raise ContactError(
            f"contact: narrower than {_NARROWEST:g} of the distance at which its gap ends: charges beside it cannot be "
            "resolved; must be insulated"
        )
    beyond = np.log(_MARGIN * end / (radius * _FARTHEST)) / np.log(_END_RATIO)
    return float(_FARTHEST * _END_RATIO ** max(np.ceil(beyond), 0.0))


def _sinhc(tau: Array) -> Array:
    """Return sinh(tau^2) / tau^2."""
    return np.where(tau > 0, np.sinh(tau**2) / np.where(tau > 0, tau, 1.0) ** 2, 1.0)


def _between(low: Array, high: Array) -> tuple[Array, Array]:
    """Nodes and weights of Gauss's rule between each pair of ends; (row, point) each."""
    x, w = gauss(np.array([0.0, 1.0]), _NODES_IN_TAU)
    return low[:, None] + (high - low)[:, None] * x, (high - low)[:, None] * w
