"""Linear operators of point contacts in air and of their exterior charges, tabulated over the radius (points, 6).

Lengths are in contact radii, displacements over C a^e and tractions over C a^(e-1), as in :mod:`solver.point`.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Indices
from approximation.chebyshev import legendre_rule
from approximation.piecewise import Interval
from solver.arrays import Array, BoolArray
from solver.cache import cached
from solver.gap.grid import add_pieces, gauss, pieces
from solver.gap.newton import SplitOutputs
from solver.gap.rings import Rings, rings
from solver.line.kernel import CHANNEL
from solver.line.windows import number_of
from solver.point.friction import legendre
from solver.point.kernel import SurfaceKernel, normal_kernel
from solver.point.profile import SAMPLES, Shape, finite, halfspace_form
from solver.point.system import added_forms
from solver.point.table import PointKind, interval
from solver.stack.wavenumbers import strip

_FIRST, _GROWTH = 14, 6.0  # nodes of S below a narrow contact, and the growth of their number with its width
_POWER = 3  # grades nodes towards the apex, where the profile may be a power of s that is not even
_GRADED_POWER, _GRADED_NODES = 4, 20  # grades nodes towards apex and edge; additional nodes of the graded rule


@dataclass(frozen=True, eq=False)
class ContactRule:
    """Nodes and weights on 0 to 1; (node,) each."""

    nodes: Array
    weights: Array

    @classmethod
    def of(cls, reach: float, *, even: bool = True) -> Self:
        """Rule that resolves layers of width a/reach, for even functions of s (products of odd ones) or any powers."""
        count = _FIRST + int(_GROWTH * (np.sqrt(reach) + reach))
        x, w = legendre_rule(2 * count)
        if even:
            return cls(x[count:], w[count:])
        t = (1 + x) / 2
        return cls(t**_POWER, w / 2 * _POWER * t ** (_POWER - 1))

    @property
    def graded(self) -> Self:
        """Rule refined towards both ends: for integrands kinked at the apex and logarithmic at the edge."""
        x, w = legendre_rule(self.nodes.size + _GRADED_NODES)
        t = (1 + x) / 2
        half, weights = t**_GRADED_POWER / 2, w * _GRADED_POWER * t ** (_GRADED_POWER - 1) / 4
        return type(self)(np.concatenate([half, 1 - half]), np.concatenate([weights, weights]))

    @property
    def series(self) -> Array:
        """Matrix from even S at the nodes to coefficients of the tractions in f_n (points, 4); (n, node)."""
        count = self.nodes.size
        n = np.arange(count)
        values = np.polynomial.legendre.legvander(self.nodes, 2 * count - 2)[:, ::2].T
        return np.asarray(2 / np.pi * (-1.0) ** n[:, None] * (4 * n[:, None] + 1) * values * self.weights)

    @property
    def odd_series(self) -> Array:
        """Matrix from odd S at the nodes to coefficients of psi in P_n(2 b - 1) (points, 8); (n, node)."""
        count = 2 * self.nodes.size
        x, w = legendre_rule(count)
        b, orders = (1 + x) / 2, np.arange(1, count, 2)
        at_nodes, at_points = (np.polynomial.legendre.legvander(s, count - 1)[:, 1::2] for s in (self.nodes, b))
        values = at_points * (2 * orders + 1) @ at_nodes.T * self.weights
        series = (2 * np.arange(count)[:, None] + 1) * (legendre(b, count).T * w / 2)
        return np.asarray(2 / np.pi * series @ values)


_BREAK_RATIO = 4.0  # of successive distances from a target at which rules break
#: x = sqrt(1 - r^2) below the contact at which densities are output: panels graded to the edge, and the centre.
_ENDS = (0.0, 0.004, 0.012, 0.035, 0.1, 0.25, 0.55, 1.0)
WITHIN = 8  # nodes of a panel
X_WITHIN = np.append(gauss(np.array(_ENDS), WITHIN)[0], 1.0)


@dataclass(frozen=True, eq=False)
class Layout:
    """Layout of the operator matrix: outputs by row, causes and charge densities by column.

    Rows: loads, edges, exterior (u_y, phi, psi) less those at the edge, pressures at ``SAMPLES``, densities of each
    field at ``X_WITHIN``.
    """

    fields: tuple[int, ...]  # Conducted fields, 0 electric and 1 magnetic
    nodes: int  # Number of exterior nodes
    causes: int  # Number of causes, at rest u0 of every channel, then g

    @cached_property
    def channels(self) -> list[int]:
        """Indices of y and of the conducted fields' potentials among (y, phi, psi)."""
        return [0, *(1 + f for f in self.fields)]

    @cached_property
    def columns(self) -> int:
        """Number of columns: causes, then the densities of every field."""
        return self.causes + len(self.fields) * self.nodes

    def densities(self, row: int) -> slice:
        """Columns of the densities of the conducted field number ``row``."""
        return slice(self.causes + row * self.nodes, self.causes + (row + 1) * self.nodes)

    @cached_property
    def loads(self) -> slice:
        """Rows of -(P, T, J) over C a^(e+1)."""
        return slice(0, len(self.channels))

    @cached_property
    def edges(self) -> slice:
        """Rows of S just within the edge."""
        return slice(len(self.channels), 2 * len(self.channels))


@dataclass(frozen=True, eq=False)
class RingOperators:
    """Operators of contacts of one shape and conduction on one stack, or on a half-space."""

    rings: Rings
    fields: tuple[int, ...]  # Conducted fields, 0 electric and 1 magnetic
    compliance: Array  # N of the contact; (3, 3)
    shape: Shape
    layers: SurfaceKernel | None = None  # Lambda; None: a half-space
    width: float = np.inf  # Distance over which the layers' kernels vary

    @cached_property
    def layout(self) -> Layout:
        """Layout of the matrix."""
        return Layout(self.fields, self.rings.grid.count, len(self.fields) + 2)

    def matrix(self, radius: float) -> Array:
        """Outputs of every cause and density; (row, column)."""
        layout = self.layout
        below, S, by_layers = self._solved(radius, self.rings.grid.distance)
        count, profile, inverse = below.nodes.size, layout.causes - 1, self.inverse
        edge = inverse @ (self._prescribed(np.ones(1))[:, 0] - by_layers[:, count])
        loads = 4 * np.einsum("n,inc->ic", below.weights, S)
        loads[:, profile] -= 4 * inverse[:, 0] * self.shape.rise * self.shape.exponent / (self.shape.exponent + 1)
        exterior = self.rings.displacement @ self.exterior_chi(by_layers[:, count:], edge)
        coefficients = below.series @ S
        pressure = -added_forms(SAMPLES, count) @ coefficients[0]
        pressure[:, profile] += inverse[0, 0] * self._form(SAMPLES)
        parts = [loads, edge, exterior.reshape(-1, layout.columns), pressure]
        for row in range(len(self.fields)):
            loads[1 + row, layout.densities(row)] += 4 * self.rings.totals
            within = added_forms(X_WITHIN, count) @ coefficients[1 + row]
            within[:, layout.densities(row)] += _induced_within(self.rings)
            within[:, profile] -= inverse[1 + row, 0] * self._form(X_WITHIN)
            parts.append(within)
        return np.concatenate(parts)

    @cached_property
    def profile(self) -> Array:
        """Gap over C a^e between the profile and a flat exterior surface at the nodes; (n,)."""
        return self.shape.rise * self.rings.power(self.shape.exponent)

    def series(self, radius: float) -> Array:
        """Coefficients in f_n (points, 4) of the tractions without the profile's closed part; (channel, n, column)."""
        below, S, _ = self._solved(radius, np.zeros(0))
        return np.asarray(np.einsum("mn,inc->imc", below.series, S))

    def _form(self, x: Array) -> Array:
        """Pressure of a half-space of N^-1 = 1 at x; zero if it has no largest value."""
        return 2 / np.pi * halfspace_form(self.shape, x) if finite(self.shape) else np.zeros_like(x)

    def _solved(self, radius: float, exterior: Array) -> tuple[ContactRule, Array, Array]:
        """Rule below the contact, S without the profile's closed part at its nodes, and the layers' part of N S.

        (channel, s, column) each; N S at the rule's nodes, at the edge and at ``exterior``.
        """
        below = ContactRule.of(radius / self.width)
        of_halfspace = np.einsum("ij,jnc->inc", self.inverse, self._prescribed(below.nodes))
        S, by_layers = self._layered(radius, below, of_halfspace, exterior)
        # S of the profile is profile_S s^e: profile_S (1 - s^e), whose tractions are closed, less than at the edge
        of_halfspace[..., self.layout.causes - 1] = self.inverse[:, :1] * self.shape.rise
        return below, S + of_halfspace, by_layers

    def _layered(self, radius: float, below: ContactRule, closed: Array, exterior: Array) -> tuple[Array, Array]:
        """Layers' part of S at ``below``, and of N S there, at the edge and at ``exterior``; (channel, s, column)."""
        layout, count = self.layout, below.nodes.size
        by_layers = np.zeros((len(layout.channels), count + 1 + exterior.size, layout.columns))
        if self.layers is None:
            return np.zeros_like(closed), by_layers
        targets = np.concatenate([below.nodes, [1.0], exterior])
        for row, by_density in enumerate(self.from_exterior(radius, targets)):
            by_layers[..., layout.densities(row)] = by_density
        kernels = self.within(radius, targets, below)
        by_layers += summed(kernels, closed)
        if self.shape.exponent % 2:  # the profile is not even; what the layers add is
            fine = ContactRule.of(radius / self.width, even=False)
            power = self.inverse[:, :1] * self._prescribed(fine.nodes)[0, :, layout.causes - 1]
            by_layers[..., layout.causes - 1] = np.einsum("ijtn,jn->it", self.within(radius, targets, fine), power)
        return self.balanced(kernels, by_layers)

    def exterior_chi(self, by_layers: Array, edges: Array) -> Array:
        """Return chi at the exterior nodes less chi at the edge; (channel, n, column)."""
        # by_layers: (channel, 1 + n, column), the edge first; edges: (channel, column), S within; densities come last
        nodes, fields = self.layout.nodes, len(self.fields)
        S = np.repeat(-edges[:, None], nodes, axis=1)
        densities = S[..., edges.shape[1] - fields * nodes :].reshape(1 + fields, nodes, fields, nodes)
        for row in range(fields):
            densities[1 + row, :, row] += self.rings.abel
        return np.asarray(by_layers[:, 1:] - by_layers[:, :1] + np.tensordot(self.channel_compliance, S, 1))

    def balanced(self, kernels: Array, by_layers: Array) -> tuple[Array, Array]:
        """Return S below the contact that keeps chi there, (channel, n, column), and the layers' chi at the targets."""
        # kernels: (channel, channel, target, n), of which the first n targets lie below the contact; by_layers:
        # (channel, target, column), the layers' chi without that S
        size, count = len(kernels), kernels.shape[-1]
        matrix = np.einsum("ij,mn->imjn", self.channel_compliance, np.eye(count))
        matrix += np.moveaxis(kernels[:, :, :count], 1, 2)
        S = np.linalg.solve(matrix.reshape(size * count, -1), -by_layers[:, :count].reshape(size * count, -1))
        S = S.reshape(size, count, -1)
        return S, by_layers + summed(kernels, S)

    @cached_property
    def inverse(self) -> Array:
        """Inverse of N of the channels; (channel, channel)."""
        return np.asarray(np.linalg.inv(self.channel_compliance))

    @property
    def channel_compliance(self) -> Array:
        """N of the channels; (channel, channel)."""
        return self.compliance[np.ix_(self.layout.channels, self.layout.channels)]

    def _prescribed(self, nodes: Array) -> Array:
        """Return chi below the contact; (channel, node, column)."""
        layout = self.layout
        result = np.zeros((len(layout.channels), nodes.size, layout.columns))
        channel = np.arange(len(layout.channels))
        result[channel, :, channel] = 1.0
        result[0, :, layout.causes - 1] = self.shape.rise * nodes**self.shape.exponent
        return result

    @cached_property
    def _pairs(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Pairs of (y, phi, psi) that the channels use, and the pair's index for each two channels."""
        used, index = np.unique(CHANNEL[np.ix_(self.layout.channels, self.layout.channels)], return_inverse=True)
        return used, index.reshape(2 * (len(self.layout.channels),))

    @cached_property
    def _pair_kernels(self) -> SurfaceKernel:
        """Kernels of the layers for the pairs in use."""
        assert self.layers is not None
        return self.layers.of(self._pairs[0])

    def _by_channels(self, kernels: Array) -> Array:
        """Arrange kernels of pairs, (target, node, pair), as (channel, channel, target, node)."""
        return np.moveaxis(kernels[..., self._pairs[1]], (2, 3), (0, 1))

    def within(self, radius: float, targets: Array, below: ContactRule) -> Array:
        """Kernels of the layers from S below the contact to targets s (target,); (channel, channel, target, node)."""
        distances = np.stack([np.abs(targets[:, None] - below.nodes), targets[:, None] + below.nodes])
        near, far = self._pair_kernels.at(radius * distances)
        return self._by_channels(radius / np.pi * (near + self.rings.parity * far) * below.weights[:, None])

    def from_exterior(self, radius: float, targets: Array) -> list[Array]:
        """Kernel matrices of the layers from each field's exterior densities over size; (channel, target, node)."""
        # one rule per panel suffices for kernels that are smooth over it, and for the opposite side everywhere
        grid, (s, weights) = self.rings.grid, self.rings.rule
        breaks = self._breaks(radius, targets)
        ends = np.cosh(self.rings.ends)
        broken = np.diff([np.searchsorted(row, ends, side="right") for row in breaks], axis=1) > 0
        kernels = self.rings.parity * self._pair_kernels.at(radius * (targets[:, None, None] + s))
        row, panel = np.nonzero(~broken)
        kernels[row, panel] += self._pair_kernels.at(radius * np.abs(targets[row, None] - s[panel]))
        result = np.swapaxes(np.swapaxes(kernels, -1, -2) @ weights, -1, -2)  # (target, panel, node, pair)
        row, panel, start, stop = pieces(self.rings.ends, np.arccosh(breaks), broken)
        s, weights = self.rings.ruled(panel, start, stop)
        near = self._pair_kernels.at(radius * np.abs(targets[row, None] - s))
        add_pieces(result, row, panel, np.swapaxes(weights, 1, 2) @ near)
        size = self.rings.size.reshape(grid.panels, -1, 1)
        kernels = self._by_channels((radius / np.pi * result / size).reshape(targets.size, grid.count, -1))
        return [kernels[:, 1 + row] @ self.rings.abel for row in range(len(self.fields))]

    def _breaks(self, radius: float, targets: Array) -> Array:
        """Break points of the rules around targets, rising, padded with the edge; (target, break)."""
        far = float(np.cosh(self.rings.ends[-1]))
        distances = self.width / radius * _BREAK_RATIO ** np.arange(-1, 40.0)
        distances = np.concatenate([[0.0], distances[distances < far]])
        offsets = np.concatenate([-distances[1:], distances])
        s = targets[:, None] + offsets
        # farther from a target than it is from the axis, panels are short enough
        used = (np.abs(offsets) < np.maximum(targets, 1.0)[:, None]) & (s > 1) & (s < far)
        return np.sort(np.where(used, s, 1.0), 1)


def summed(kernels: Array, S: Array) -> Array:
    """Sum kernels (channel, channel, target, node) times S (channel, node, column); (channel, target, column)."""
    return np.asarray(np.tensordot(kernels, S, ((1, 3), (0, 1))))


@cached
def _induced_within(rings: Rings) -> Array:
    """Density at ``X_WITHIN`` that exterior charges induce; (x, n)."""
    return rings.poisson(X_WITHIN)


@dataclass(frozen=True, eq=False)
class RingTable:
    """Operators between two radii, interpolated by Chebyshev polynomials in log a."""

    exact: RingOperators
    interval: Interval | None = None  # Range of log a; None: a half-space, the same at every radius

    @cached_property
    def outputs(self) -> SplitOutputs:
        """Outputs at the interval's points; pressures and densities below the contact are only reported."""
        log_radii = np.zeros(1) if self.interval is None else self.interval.points
        result = np.stack([self.exact.matrix(float(np.exp(log_radius))) for log_radius in log_radii])
        layout = self.exact.layout
        return SplitOutputs.of(result, layout.edges.stop + len(layout.channels) * layout.nodes, self.interval)

    def holds(self, log_radii: Array) -> BoolArray:
        """Return True for each radius within the table; (case,)."""
        if self.interval is None:
            return np.ones(log_radii.shape, dtype=bool)
        return (self.interval.low <= log_radii) & (log_radii <= self.interval.high)


_NODES, _PART_NODES = 18, 8  # radii of half a decade and of a part of it: errors are 1e-12, and 1e-9 in derivatives
_PART, _OVERLAP = 0.11, 0.015  # length of a part in log a, and its overlap with the next: air moves a contact less
_SINGLE_PARTS = 2  # most parts of half a decade that get their own tables: three have more radii than the whole


@cached
def film_table(kind: PointKind, reach: float, ends: Interval) -> RingTable:
    """Operators on a film between two radii, with rings up to ``reach`` contact radii."""
    return RingTable(_operators(kind, reach), ends)


@cached
def _operators(kind: PointKind, reach: float) -> RingOperators:
    stack = kind.film
    fields = tuple(field for field in (0, 1) if kind.conducts[field])
    return RingOperators(rings(reach), fields, kind.compliance, kind.shape, normal_kernel(stack), strip(stack))


def _part_of(ratios: Array) -> Indices:
    """Number of the part of log a that contains each ratio of radius to thickness."""
    return np.asarray(np.floor(np.log(ratios) / _PART), dtype=np.intp)


def crowded(ratios: Array) -> set[int]:
    """Half decades of which the contacts of one call, at ratios of radius to thickness, need a whole table."""
    pairs = np.unique(np.stack([number_of(ratios), _part_of(ratios)]), axis=1)
    numbers, parts = np.unique(pairs[0], return_counts=True)
    return set(numbers[parts > _SINGLE_PARTS].tolist())


def ends_of(ratio: float, *, wide: bool) -> Interval:
    """Range of log a for the table around a ratio of radius to thickness: a half decade, or a part of it."""
    ratios = np.array([ratio])
    if wide:
        return interval(int(number_of(ratios)[0]), _NODES)
    part = int(_part_of(ratios)[0])
    return Interval(part * _PART - _OVERLAP, (part + 1) * _PART + _OVERLAP, _PART_NODES)
