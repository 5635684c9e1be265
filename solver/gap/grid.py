"""Panels for charges on both sides of a contact, and the half-plane's response to them (theory section 10).

Beside the contact X = +-cosh(theta). On a side the density is a polynomial in u on each panel, u = theta, and on the
last one, which ends at infinity, u = exp(-theta) and the density u^2 times a polynomial. The contact of a half-plane
answers a charge beside it, its own total kept, by charges that leave it an equipotential: the potential relative to it
is M/pi times

    G = log|sinh((theta + theta')/2) / sinh((theta - theta')/2)|,    log[cosh((theta + theta')/2) / cosh(...)]

on the same side and across, the contact's potential changes by -M/pi times theta', and its charge by the coefficients
-(1/pi) (2 - delta_n0) exp(-n theta') (+-1)^n of T_n / sqrt(1 - X^2).

A rule of n nodes errs by rho^-2n for a function that is analytic within the ellipse with foci at the interval's ends
whose semi-axes add to rho (over half the interval; Trefethen, SIAM Review 50 (2008) 67). The nearest singularities of
a stack's kernels lie at the distance of the strip from a target.
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

RULE = 12  # nodes where charges and a panel of the kernel meet: exact for both
GRADED = 0.12 ** np.arange(8.0)  # of the infinite panel, towards the logarithm at its end
_SHARE, _WEIGHTS = (legendre_rule(RULE) + np.array([[1.0], [0.0]])) / 2  # of an interval
_ELLIPSE = 4.0  # rho^-16 is left, beside densities of degree 6: 2e-10


def spans(start: Array, stop: Array) -> tuple[Array, Array]:
    """Nodes and weights on intervals from start to stop, (interval,) each; (interval, node) each."""
    length = (stop - start)[:, None]
    return start[:, None] + length * _SHARE, length * _WEIGHTS


def gauss(ends: Array, count: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss's rule on each interval between ends (interval + 1,); (node,) each."""
    x, w = legendre_rule(count)
    half = np.diff(ends) / 2
    return (ends[:-1, None] + half[:, None] * (1 + x)).ravel(), (half[:, None] * w).ravel()


#: Pieces of intervals: target, interval, start and end of each, those of a target's interval side by side.
Pieces = tuple[Indices, Indices, Array, Array]


def pieces(ends: Array, breaks: Array, marked: BoolArray) -> Pieces:
    """Cut marked intervals (target, interval) between ends (interval + 1,) at the target's breaks (target, break)."""
    points = np.sort(np.concatenate([np.tile(ends, (len(breaks), 1)), breaks], 1), 1)
    start, stop = points[:, :-1], np.minimum(points[:, 1:], ends[-1])
    interval = np.clip(np.searchsorted(ends, (start + stop) / 2) - 1, 0, ends.size - 2)
    target, place = np.nonzero((stop > start) & np.take_along_axis(marked, interval, 1))
    return target, interval[target, place], start[target, place], stop[target, place]


def add_pieces(out: Array, target: Indices, panel: Indices, parts: Array) -> None:
    """Add parts (piece, ...) to ``out`` (target, panel, ...)."""
    first = np.flatnonzero(np.diff(target * out.shape[1] + panel, prepend=-1))
    if first.size:
        out[target[first], panel[first]] += np.add.reduceat(parts, first)


@dataclass(frozen=True, eq=False)
class Rules:
    """Rules on intervals of u."""

    panel: NDArray[np.intp]  # Panel of the densities; (interval,)
    # Ends in u; (interval,)
    start: Array
    stop: Array
    theta: Array  # Nodes; (interval, node)
    shape: (
        Array  # Weights times the density at the nodes per unknown of the panel; (interval, node, unknown of the panel)
    )

    def rough(self, singular: NDArray[np.complex128]) -> BoolArray:
        """Mark intervals to which singularities at u = ``singular`` (..., interval) lie too close."""
        z = (2 * singular - self.start - self.stop) / (self.stop - self.start)
        root = np.sqrt(z - 1) * np.sqrt(z + 1)
        return np.asarray(np.abs(z + root) < _ELLIPSE)


#: Powers with a logarithm far away: by u_y alone above a ground, and where the potentials grow like log X themselves.
LEVEL, GROWING = (2,), (0, 1, 2)

#: Ends of the panels in theta next to the edge: charges vary on the scale on which the gap opens.
_EDGE = (0.0, 0.0006, 0.005, 0.03, 0.12, 0.3, 0.6, 1.0)
_BEYOND = (1.4, 1.9)  # ends of the next ones
_WIDTH = 0.9  # of the panels beyond
CLOSE = float(np.cosh(_EDGE[-1]))  # X at which those next to the edge end
_PANEL_NODES = 7  # a panel
_NEAR = 0.04  # theta up to which integration from the edge is more accurate than a difference from the edge's value
_FINE = 24  # of the rules that integrate over a panel
_RATIO = 0.12  # of pieces towards a singular point


@dataclass(frozen=True, eq=False)
class Grid:
    """Panels of one side."""

    ends: tuple[float, ...]
    logarithms: tuple[int, ...] = LEVEL

    @classmethod
    def up_to(cls, distance: float, logarithms: tuple[int, ...] = LEVEL) -> "Grid":
        """Panels whose last finite one ends at X = distance or beyond; one for all that are not much apart."""
        last = np.arccosh(max(distance, 2.0))
        count = max(int(np.ceil((last - _BEYOND[-1]) / _WIDTH)), 0)
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
        """Density over the unknown: 1, on the infinite panel u^2; any shape."""
        return np.where(theta > self.ends[-1], np.exp(-2 * theta), 1.0)

    @cached_property
    def size(self) -> Array:
        """The same at the nodes; (n,)."""
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
        """Terms of u^-2 times the density on the last panel: powers, and some with the logarithm; (..., term)."""
        share = u[..., None] / self.limits[-1, 1]
        powers = share ** np.arange(_PANEL_NODES - len(self.logarithms))
        logs = np.log(np.where(share > 0, share, 1.0)) * share ** np.array(self.logarithms)
        return np.concatenate([powers, logs], -1)

    def interpolations(self, panels: Indices, u: Array) -> Array:
        """Interpolation matrices from nodes of panels (piece,) to points u (piece, point); (piece, point, node)."""
        low, high = self.limits[panels].T[..., None]
        distance = ((2 * u - low - high) / (high - low))[..., None] - self._local
        share = self._barycentric / np.where(distance == 0, 1e-200, distance)  # at a node it alone counts
        share /= share.sum(-1, keepdims=True)
        infinite = panels == self.panels - 1
        share[infinite] = self._far_terms(u[infinite]) @ self._at_infinity
        return np.asarray(share)

    def interpolations_at(self, panels: Indices, theta: Array) -> Array:
        """Interpolation matrices from nodes of panels (piece,) to theta (piece, point); (piece, point, node)."""
        infinite = (panels == self.panels - 1)[:, None]
        return self.interpolations(panels, np.where(infinite, np.exp(-theta), theta))

    def interpolation(self, theta: Array) -> Array:
        """Interpolation matrix from all nodes to theta; (place, n)."""
        panels = np.minimum(np.searchsorted(self.ends[1:], theta), self.panels - 1)
        whole = np.zeros((theta.size, self.panels, _PANEL_NODES))
        whole[np.arange(theta.size), panels] = self.interpolations_at(panels, theta[:, None])[:, 0]
        return whole.reshape(theta.size, self.count)

    def ruled(self, panels: Indices, u: Array, weights: Array) -> tuple[Array, Array]:
        """Theta at nodes u of rules on pieces of panels, and weights of int D dX by the unknowns of D.

        (piece, point) and (piece, point, node).

        panels: (piece,); u, weights: (piece, point).
        """
        infinite = (panels == self.panels - 1)[:, None]
        charge = weights * np.where(infinite, (1 - u**2) / 2, np.sinh(u))
        return np.where(infinite, -np.log(u), u), charge[..., None] * self.interpolations(panels, u)

    @cached_property
    def infinite_ends(self) -> Array:
        """Ends of the intervals of the infinite panel in u, graded towards the logarithm at its end; rising."""
        return np.concatenate([[0.0], self.limits[-1, 1] * GRADED[::-1]])

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
        """Mark intervals whose rule errs for a kernel with singularities at X +- i strip; (point, interval)."""
        theta = np.arccosh(X + 1j * strip)[:, None]
        infinite = self.rules.panel == self.panels - 1
        return self.rules.rough(np.where(infinite, np.exp(-theta), theta))

    def slice(self, panel: int) -> slice:
        """Nodes of a panel among all."""
        return slice(panel * _PANEL_NODES, (panel + 1) * _PANEL_NODES)

    @cached_property
    def _whole(self) -> list[tuple[Array, Array]]:
        """Theta and weights of every panel's rule, graded towards the edge and towards infinity."""
        return [self._ruled(panel, 0.0 if panel == 0 else None)[1:] for panel in range(self.panels)]

    def _ruled(self, panel: int, singular: float | None) -> tuple[Array, Array, Array]:
        """Nodes u, theta and weights as of :meth:`ruled` of one panel, graded towards u = at; (point, ...) each."""
        low, high = self.limits[panel]
        ends = [low, high]
        if panel == self.panels - 1:
            ends += list(high * _RATIO ** np.arange(1, 10))
        if singular is not None:
            inner = min(max(singular, low), high)
            for side, far in ((-1.0, inner - low), (1.0, high - inner)):
                if far > 0:
                    ends += list(inner + side * far * _RATIO ** np.arange(1, 10))
            ends.append(inner)
        u, weights = gauss(np.unique(ends), _FINE)
        theta, shape = self.ruled(np.array([panel]), u[None], weights[None])
        return u, theta[0], shape[0]

    def integrated(self, function: Callable[[Array], Array]) -> Array:
        """Integrals of functions of theta, (..., point), times the density over X; (..., n)."""
        return np.concatenate([function(theta) @ shape for theta, shape in self._whole], -1)

    def induced_terms(self, count: int) -> Array:
        """Coefficients of T_n / sqrt(1 - X^2) in the charge induced within the contact; (count, n)."""
        orders = np.arange(count)[:, None]
        return self.integrated(lambda theta: np.exp(-orders * theta)) * np.where(orders, 2, 1) / -np.pi

    @cached_property
    def totals(self) -> Array:
        """Integral of the density over X; (n,)."""
        return self.integrated(np.ones_like)

    @cached_property
    def rises(self) -> Array:
        """Integral of theta times the density; (n,)."""
        return self.integrated(lambda theta: theta)

    def induced(self, X: Array) -> Array:
        """Charge induced within the contact, times sqrt(1 - X^2); (point, n)."""
        distance = (1 - X)[:, None]
        # sinh / (cosh - X), without a difference next to the edge
        return self.integrated(lambda theta: np.sinh(theta) / (2 * np.sinh(theta / 2) ** 2 + distance)) / -np.pi

    @cached_property
    def green(self) -> tuple[Array, Array]:
        """Integrals of G against the density, at the nodes of the same side and of the other; (n, n) each."""
        same, across = np.zeros((2, self.count, self.count))
        for row, theta in enumerate(self.theta):
            for panel in range(self.panels):
                low, high = self.limits[panel]
                infinite = panel == self.panels - 1
                target = np.exp(-theta) if infinite else theta
                near = low - (high - low) < target < high + (high - low)
                u, other, shape = self._ruled(panel, target if near else None)
                distance = np.log(u / target) if infinite else u - target
                with np.errstate(divide="ignore"):
                    same_side = np.log(np.abs(np.sinh((theta + other) / 2) / np.sinh(distance / 2)))
                opposite = np.log(np.cosh((theta + other) / 2) / np.cosh((theta - other) / 2))
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
                share = self.u[panel] / high
                to_series = np.linalg.inv(share[:, None] ** powers)
                rows = np.concatenate([-np.log(share)[:, None], (1 - share[:, None] ** powers[1:]) / powers[1:]], 1)
                result[part] = before
                result[part, part] += rows @ to_series
        return result

    @property
    def near(self) -> int:
        """Number of nodes next to the edge, where the gap is as small as the rounding of a displacement."""
        return _PANEL_NODES * int(np.searchsorted(self.ends[1:], _NEAR))

    def from_edge(self, differences: Array, slopes: Array) -> Array:
        """Displacements less those at the edge: next to it by integration, since a difference would have no digits."""
        near = slopes.shape[-2]
        rising = self.cumulative[:near, :near] * np.sinh(self.theta[:near])
        return np.concatenate([rising @ slopes, differences[..., near:, :]], -2)

    @cached_property
    def edge(self) -> Array:
        """The density at the edge; (n,)."""
        return np.asarray(self.interpolation(np.zeros(1))[0])


@cached
def _grid(count: int, logarithms: tuple[int, ...]) -> Grid:
    return Grid((*_EDGE, *_BEYOND, *(_BEYOND[-1] + _WIDTH * np.arange(1, count + 1))), logarithms)


_SAMPLES = 129  # of a panel


def peak_of_panels(values: Array) -> Array:
    """Largest absolute values of polynomials by their values at Gauss's nodes; (case, panel, node) to (case,)."""
    samples = np.abs(values @ _resampled(values.shape[-1]))
    before, middle, after = samples[..., :-2], samples[..., 1:-1], samples[..., 2:]
    # between samples by parabolas
    top = (middle >= before) & (middle >= after)
    bend = np.where(top, before - 2 * middle + after, -1.0)
    rise = np.where(top, (after - before) ** 2 / (-8 * np.where(bend < 0, bend, -1.0)), 0.0)
    return np.asarray(np.maximum(np.max(samples, (-2, -1)), np.max(middle + rise, (-2, -1))))


@cache
def _resampled(count: int) -> Array:
    """Matrix from values at Gauss's nodes to those at even distances; (node, sample)."""
    to_series = np.linalg.inv(np.polynomial.legendre.legvander(legendre_rule(count)[0], count - 1))
    samples = np.polynomial.legendre.legvander(np.linspace(-1, 1, _SAMPLES), count - 1)
    return np.asarray((samples @ to_series).T)
