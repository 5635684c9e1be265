"""Panels for exterior charges on both sides of a contact, and the half-plane's response (theory section 10).

Outside the contact X = +-cosh(theta). A density is a polynomial in u = theta on each finite panel; on the infinite
panel u = exp(-theta), and the density is u^2 times powers and logarithms of u. On a half-plane a charge at theta'
induces charge -(1/pi) (2 - delta_n0) exp(-n theta') (+-1)^n T_n / sqrt(1 - X^2) in the contact, changes the contact's
potential by -M/pi theta', and causes a potential relative to the contact of M/pi times

    G = log|sinh((theta + theta')/2) / sinh((theta - theta')/2)|,    log[cosh((theta + theta')/2) / cosh(...)]

on the same side and on the other side.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Indices
from approximation.chebyshev import legendre_rule
from solver.arrays import Array, BoolArray
from solver.cache import cached

RULE = 12  # nodes of an interval, exact for the product of density and kernel polynomials
_GRADED = 0.12 ** np.arange(8.0)  # ends of intervals of the infinite panel, towards the logarithm at its end
_NODES, _WEIGHTS = (legendre_rule(RULE) + np.array([[1.0], [0.0]])) / 2  # of the interval from 0 to 1
# A rule of n nodes errs by rho^-2n for a function that is analytic within the ellipse with foci at the interval's ends
# whose semi-axes add to rho half-intervals (Trefethen, SIAM Review 50 (2008) 67).
_ELLIPSE = 4.0  # rho: an error of rho^-16 remains with densities of degree 6, 2e-10


def spans(start: Array, stop: Array) -> tuple[Array, Array]:
    """Nodes and weights, (interval, node) each, on intervals from start to stop, (interval,) each."""
    length = (stop - start)[:, None]
    return start[:, None] + length * _NODES, length * _WEIGHTS


def gauss(ends: Array, count: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss's rule with ``count`` nodes on each interval between ends; (node,) each."""
    x, w = legendre_rule(count)
    half = np.diff(ends) / 2
    return (ends[:-1, None] + half[:, None] * (1 + x)).ravel(), (half[:, None] * w).ravel()


#: Pieces of intervals: target, interval, start and end of each; pieces of one interval of a target are adjacent.
Pieces = tuple[Indices, Indices, Array, Array]


def pieces(ends: Array, breaks: Array, marked: BoolArray) -> Pieces:
    """Cut marked intervals (target, interval) between ends (interval + 1,) at the target's breaks (target, break)."""
    points = np.sort(np.concatenate([np.tile(ends, (len(breaks), 1)), breaks], 1), 1)
    start, stop = points[:, :-1], np.minimum(points[:, 1:], ends[-1])
    interval = np.clip(np.searchsorted(ends, (start + stop) / 2) - 1, 0, ends.size - 2)
    target, piece = np.nonzero((stop > start) & np.take_along_axis(marked, interval, 1))
    return target, interval[target, piece], start[target, piece], stop[target, piece]


def add_pieces(out: Array, target: Indices, panel: Indices, parts: Array) -> None:
    """Add parts (piece, ...) of adjacent pieces to ``out`` (target, panel, ...)."""
    first = np.flatnonzero(np.diff(target * out.shape[1] + panel, prepend=-1))
    if first.size:
        out[target[first], panel[first]] += np.add.reduceat(parts, first)


@dataclass(frozen=True, eq=False)
class Rules:
    """Quadrature rules on intervals of u."""

    panel: NDArray[np.intp]  # Panel of the densities; (interval,)
    # Ends in u; (interval,)
    start: Array
    stop: Array
    theta: Array  # Nodes; (interval, node)
    shape: Array  # Weights times the density at the nodes per unknown of the panel; (interval, node, unknown)


#: Powers of u with a logarithm on the infinite panel: by u_y above a ground; where potentials grow like log X.
LEVEL, GROWING = (2,), (0, 1, 2)

#: Ends of the panels in theta next to the edge: charges vary on the scale on which the gap opens.
_EDGE = (0.0, 0.0006, 0.005, 0.03, 0.12, 0.3, 0.6, 1.0)
_MIDDLE = (1.4, 1.9)  # ends of the next panels
_WIDTH = 0.9  # of the other finite panels
CLOSE = float(np.cosh(_EDGE[-1]))  # X at which the panels next to the edge end
_PANEL_NODES = 7
_NEAR = 0.04  # theta up to which integration from the edge is more accurate than a difference from the edge's value
_FINE = 24  # nodes of the rules that integrate over a piece of a panel
_RATIO = 0.12  # of the lengths of pieces towards a singular point


@dataclass(frozen=True, eq=False)
class Grid:
    """Panels of one side."""

    ends: tuple[float, ...]  # Ends of the finite panels in theta
    logarithms: tuple[int, ...] = LEVEL

    @classmethod
    def up_to(cls, distance: float, logarithms: tuple[int, ...] = LEVEL) -> "Grid":
        """Grid whose last finite panel ends at X >= ``distance``; similar distances share one."""
        last = np.arccosh(max(distance, 2.0))
        count = max(int(np.ceil((last - _MIDDLE[-1]) / _WIDTH)), 0)
        return _grid(count, logarithms)

    @cached_property
    def _local(self) -> Array:
        return np.asarray(legendre_rule(_PANEL_NODES)[0])

    @property
    def panels(self) -> int:
        """Number of panels, the last one infinite."""
        return len(self.ends)

    @cached_property
    def limits(self) -> Array:
        """Ends of the panels in u; (panel, 2)."""
        return np.array([*pairwise(self.ends), (0.0, np.exp(-self.ends[-1]))])

    @cached_property
    def u(self) -> Array:
        """Nodes in u; (panel, node)."""
        return np.asarray(self.limits.mean(1)[:, None] + np.diff(self.limits, axis=1) / 2 * self._local)

    @cached_property
    def theta(self) -> Array:
        """Nodes in theta; (n,)."""
        theta = np.array(self.u)
        theta[-1] = -np.log(self.u[-1])
        return theta.ravel()

    @property
    def distance(self) -> Array:
        """Nodes |X|; (n,)."""
        return np.cosh(self.theta)

    @property
    def count(self) -> int:
        """Number of nodes."""
        return self.theta.size

    def size_at(self, theta: Array) -> Array:
        """Density over the unknown at theta: 1, on the infinite panel u^2; any shape."""
        return np.where(theta > self.ends[-1], np.exp(-2 * theta), 1.0)

    @cached_property
    def size(self) -> Array:
        """Densities over the unknowns at the nodes; (n,)."""
        return self.size_at(self.theta)

    @cached_property
    def _barycentric(self) -> Array:
        differences = self._local[:, None] - self._local + np.eye(_PANEL_NODES)
        return np.asarray(1 / np.prod(differences, 1))

    @cached_property
    def _at_infinity(self) -> Array:
        """Matrix from values at the nodes of the last panel to coefficients of its terms; (term, node)."""
        return np.asarray(np.linalg.inv(self._far_terms(self.u[-1])))

    def _far_terms(self, u: Array) -> Array:
        """Terms of u^-2 times the density on the last panel: powers, then powers times logarithm; (..., term)."""
        relative = u[..., None] / self.limits[-1, 1]
        powers = relative ** np.arange(_PANEL_NODES - len(self.logarithms))
        logs = np.log(np.where(relative > 0, relative, 1.0)) * relative ** np.array(self.logarithms)
        return np.concatenate([powers, logs], -1)

    def interpolations(self, panels: Indices, u: Array) -> Array:
        """Interpolation matrices from nodes of panels (piece,) to points u (piece, point); (piece, point, node)."""
        low, high = self.limits[panels].T[..., None]
        distance = ((2 * u - low - high) / (high - low))[..., None] - self._local
        matrices = self._barycentric / np.where(distance == 0, 1e-200, distance)  # at a node it alone counts
        matrices /= matrices.sum(-1, keepdims=True)
        infinite = panels == self.panels - 1
        matrices[infinite] = self._far_terms(u[infinite]) @ self._at_infinity
        return np.asarray(matrices)

    def interpolations_at(self, panels: Indices, theta: Array) -> Array:
        """Interpolation matrices from nodes of panels (piece,) to theta (piece, point); (piece, point, node)."""
        infinite = (panels == self.panels - 1)[:, None]
        return self.interpolations(panels, np.where(infinite, np.exp(-theta), theta))

    def interpolation(self, theta: Array) -> Array:
        """Interpolation matrix from all nodes to theta (point,); (point, n)."""
        panels = np.minimum(np.searchsorted(self.ends[1:], theta), self.panels - 1)
        matrix = np.zeros((theta.size, self.panels, _PANEL_NODES))
        matrix[np.arange(theta.size), panels] = self.interpolations_at(panels, theta[:, None])[:, 0]
        return matrix.reshape(theta.size, self.count)

    def ruled(self, panels: Indices, u: Array, weights: Array) -> tuple[Array, Array]:
        """Return theta at u, (piece, point), and weights of int D dX for the unknowns of D, (piece, point, node)."""
        # panels: (piece,); u, weights: nodes and weights in u of rules on pieces of panels, (piece, point)
        infinite = (panels == self.panels - 1)[:, None]
        charge = weights * np.where(infinite, (1 - u**2) / 2, np.sinh(u))
        return np.where(infinite, -np.log(u), u), charge[..., None] * self.interpolations(panels, u)

    @cached_property
    def infinite_ends(self) -> Array:
        """Ends of the intervals of the infinite panel in u, rising, graded towards the logarithm at 0."""
        return np.concatenate([[0.0], self.limits[-1, 1] * _GRADED[::-1]])

    @cached_property
    def rules(self) -> Rules:
        """One rule for every finite panel and for every interval of the infinite one."""
        last, ends, inner = self.panels - 1, np.array(self.ends), self.infinite_ends
        start, stop = np.concatenate([ends[:-1], inner[:-1]]), np.concatenate([ends[1:], inner[1:]])
        panel = np.minimum(np.arange(start.size), last)
        return Rules(panel, start, stop, *self.ruled(panel, *spans(start, stop)))

    @property
    def close(self) -> int:
        """Number of nodes on the panels next to the edge, up to X = CLOSE."""
        return (len(_EDGE) - 1) * _PANEL_NODES

    def rough_at(self, X: Array, strip: float) -> BoolArray:
        """Mark intervals whose rule is inaccurate for kernels singular at X +- i strip; (point, interval)."""
        rules, theta = self.rules, np.arccosh(X + 1j * strip)[:, None]
        singular = np.where(rules.panel == self.panels - 1, np.exp(-theta), theta)
        z = (2 * singular - rules.start - rules.stop) / (rules.stop - rules.start)
        return np.asarray(np.abs(z + np.sqrt(z - 1) * np.sqrt(z + 1)) < _ELLIPSE)

    def slice(self, panel: int) -> slice:
        """Indices of the nodes of a panel."""
        return slice(panel * _PANEL_NODES, (panel + 1) * _PANEL_NODES)

    @cached_property
    def _whole(self) -> list[tuple[Array, Array]]:
        """Theta and weights of every panel's rule, graded towards the edge and towards infinity."""
        return [self._ruled(panel, 0.0 if panel == 0 else None)[1:] for panel in range(self.panels)]

    def _ruled(self, panel: int, singular: float | None) -> tuple[Array, Array, Array]:
        """Nodes u of one panel, graded towards ``singular``, with theta and weights of :meth:`ruled`; (point, ...)."""
        low, high = self.limits[panel]
        ends = [low, high]
        if panel == self.panels - 1:
            ends += list(high * _RATIO ** np.arange(1, 10))
        if singular is not None:
            inner = min(max(singular, low), high)
            for side, length in ((-1.0, inner - low), (1.0, high - inner)):
                if length > 0:
                    ends += list(inner + side * length * _RATIO ** np.arange(1, 10))
            ends.append(inner)
        u, weights = gauss(np.unique(ends), _FINE)
        theta, shape = self.ruled(np.array([panel]), u[None], weights[None])
        return u, theta[0], shape[0]

    def integrated(self, function: Callable[[Array], Array]) -> Array:
        """Row of the integral over X of the density times functions of theta, (..., point); (..., n)."""
        return np.concatenate([function(theta) @ shape for theta, shape in self._whole], -1)

    def induced_terms(self, count: int) -> Array:
        """Matrix to coefficients of T_n / sqrt(1 - X^2) in the charge induced within the contact; (count, n)."""
        orders = np.arange(count)[:, None]
        return self.integrated(lambda theta: np.exp(-orders * theta)) * np.where(orders, 2, 1) / -np.pi

    @cached_property
    def totals(self) -> Array:
        """Row of the integral of the density over X; (n,)."""
        return self.integrated(np.ones_like)

    @cached_property
    def rises(self) -> Array:
        """Row of the integral of theta times the density over X; (n,)."""
        return self.integrated(lambda theta: theta)

    def induced(self, X: Array) -> Array:
        """Matrix to the charge density induced at X within the contact, times sqrt(1 - X^2); (point, n)."""
        distance = (1 - X)[:, None]
        # sinh / (cosh - X), without cancellation next to the edge
        return self.integrated(lambda theta: np.sinh(theta) / (2 * np.sinh(theta / 2) ** 2 + distance)) / -np.pi

    @cached_property
    def green(self) -> tuple[Array, Array]:
        """Matrices of the integrals of G at the nodes of the same side and of the other side; (n, n) each."""
        same, across = np.zeros((2, self.count, self.count))
        for row, theta in enumerate(self.theta):
            for panel in range(self.panels):
                low, high = self.limits[panel]
                infinite = panel == self.panels - 1
                target = np.exp(-theta) if infinite else theta
                near = low - (high - low) < target < high + (high - low)
                u, source, shape = self._ruled(panel, target if near else None)
                distance = np.log(u / target) if infinite else u - target
                with np.errstate(divide="ignore"):
                    same_side = np.log(np.abs(np.sinh((theta + source) / 2) / np.sinh(distance / 2)))
                opposite = np.log(np.cosh((theta + source) / 2) / np.cosh((theta - source) / 2))
                same[row, self.slice(panel)] = same_side @ shape
                across[row, self.slice(panel)] = opposite @ shape
        return same, across

    @cached_property
    def cumulative(self) -> Array:
        """Matrix from f sinh(theta) at the nodes to the integral of f dX from the edge to each node; (n, n)."""
        result, before = np.zeros((self.count, self.count)), np.zeros(self.count)
        powers = np.arange(_PANEL_NODES)
        for panel in range(self.panels):
            part, (low, high) = self.slice(panel), self.limits[panel]
            local = (2 * self.u[panel] - low - high) / (high - low)
            if panel < self.panels - 1:
                to_series = np.linalg.inv(np.polynomial.legendre.legvander(local, _PANEL_NODES - 1))
                integrated = np.polynomial.legendre.legint(np.eye(_PANEL_NODES), lbnd=-1) * (high - low) / 2
                result[part] = before
                result[part, part] += np.polynomial.legendre.legvander(local, _PANEL_NODES) @ integrated @ to_series
                before = np.array(before)
                before[part] += np.polynomial.legendre.legval(1.0, integrated) @ to_series
            else:  # dX f = (f sinh) d(theta) = -(f sinh) dv / v
                v = (self.u[panel] / high)[:, None]
                rows = np.concatenate([-np.log(v), (1 - v ** powers[1:]) / powers[1:]], 1)
                result[part] = before
                result[part, part] += rows @ np.linalg.inv(v**powers)
        return result

    @property
    def near(self) -> int:
        """Number of nodes next to the edge, where the gap is of the order of a displacement's rounding."""
        return _PANEL_NODES * int(np.searchsorted(self.ends[1:], _NEAR))

    def from_edge(self, differences: Array, slopes: Array) -> Array:
        """Displacements less those at the edge, (..., n, c), integrated next to the edge to avoid cancellation."""
        near = slopes.shape[-2]
        rising = self.cumulative[:near, :near] * np.sinh(self.theta[:near])
        return np.concatenate([rising @ slopes, differences[..., near:, :]], -2)

    @cached_property
    def edge(self) -> Array:
        """Row to the density at the edge; (n,)."""
        return np.asarray(self.interpolation(np.zeros(1))[0])


@cached
def _grid(count: int, logarithms: tuple[int, ...]) -> Grid:
    return Grid((*_EDGE, *_MIDDLE, *(_MIDDLE[-1] + _WIDTH * np.arange(1, count + 1))), logarithms)


_SAMPLES = 129  # of a panel


def peak_of_panels(values: Array) -> Array:
    """Largest absolute value, (case,), of polynomials with ``values`` (case, panel, node) at Gauss's nodes."""
    samples = np.abs(values @ _resampled(values.shape[-1]))
    before, middle, after = samples[..., :-2], samples[..., 1:-1], samples[..., 2:]
    # between samples by parabolas
    top = (middle >= before) & (middle >= after)
    bend = np.where(top, before - 2 * middle + after, -1.0)
    rise = np.where(top, (after - before) ** 2 / (-8 * np.where(bend < 0, bend, -1.0)), 0.0)
    return np.asarray(np.maximum(np.max(samples, (-2, -1)), np.max(middle + rise, (-2, -1))))


@cache
def _resampled(count: int) -> Array:
    """Matrix from values at Gauss's nodes to equidistant samples; (node, sample)."""
    to_series = np.linalg.inv(np.polynomial.legendre.legvander(legendre_rule(count)[0], count - 1))
    samples = np.polynomial.legendre.legvander(np.linspace(-1, 1, _SAMPLES), count - 1)
    return np.asarray((samples @ to_series).T)
