"""Sliding point contacts in air: the change of the state at rest to first order in friction (points, 8)."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.cache import cached
from solver.gap.airpoint import PointStates
from solver.gap.grid import gauss, peak_of_panels
from solver.gap.newton import solved
from solver.gap.pointtractions import AirPointTractions, SolvedPoint
from solver.gap.ringoperators import ContactRule, Layout, RingOperators, summed
from solver.gap.rings import Rings
from solver.point import hankel
from solver.point.body import Film, HalfSpace
from solver.point.friction import Response, Rim, added_tension, edge_sums, legendre
from solver.point.kernel import SurfaceKernel
from solver.point.profile import Shape
from solver.point.sliding import FirstOrderWarning
from solver.point.slidingpressure import ray_of, turned_pressures
from solver.point.tractions import Density

SHIFT, FRICTION, CAUSES = 0, 1, 2  # columns before the densities
_EDGE = np.ones(1)
_NEAREST, _RATIO = 1e-13, 0.35  # smallest distance from edge or apex of the panels of H, and ratio of their lengths
_RULE = 12  # nodes of a panel
_DENSITY_PER_S = 2 / np.pi
_PANELS_IN_B = 6.0  # per contact radius over the strip's width
_ENDS_IN_X = np.append(0.0, 0.4 ** np.arange(9, -1, -1.0))  # of panels in x = sqrt(1 - r^2) below the contact


def _hilbert_beyond(pressed: Density, theta: Array) -> Array:
    """Return H[phi_sigma] at cosh(theta) less its value at the edge, (n,), by phi' to avoid cancellation."""
    count = int(np.log(_NEAREST) / np.log(_RATIO))
    near, weights = gauss(np.append(0.0, _RATIO ** np.arange(count, -1, -1.0) / 2), _RULE)  # from the edge, or the apex
    from_edge = np.concatenate([near, 1 - near])
    two_weights = np.concatenate([weights, weights])
    beyond = 2 * np.sinh(theta[:, None] / 2) ** 2
    kernel = np.log1p(beyond / from_edge) - np.log1p(beyond / (2 - from_edge))
    return np.asarray(-(kernel @ (two_weights * pressed.falling(1 - from_edge)[0, 0])) / np.pi)


@dataclass(frozen=True, eq=False)
class SlidingPoint:
    """First-order change of one contact by friction, in the units of the body.

    Columns are a unit shift c/a, friction eta = 1 on the pressure at rest, and the exterior densities of cos(angle).
    The half-space's part of friction stays in closed form, since H[phi_sigma] is steep on both sides of the edge.
    """

    at_rest: SolvedPoint
    friction: float  # eta
    coupling: Array  # k of the contact; (3,)
    shear_layers: SurfaceKernel | None = None  # Lambda_x; None: a half-space

    @cached_property
    def response(self) -> Response:
        """Response of the top half-space."""
        return Response(self._operators.compliance, self.coupling, self._operators.shape)

    @cached_property
    def _operators(self) -> RingOperators:
        """Operators of fields that vary as cos(angle)."""
        return replace(self.at_rest.operators, rings=self.at_rest.operators.rings.turned)

    @cached_property
    def _layout(self) -> Layout:
        """Layout of the columns: shift and friction, then the densities."""
        return replace(self._operators.layout, causes=CAUSES)

    @property
    def _conducted(self) -> list[int]:
        """Indices of the conducted fields among (sigma_yy, D_y, B_y)."""
        return self._layout.channels[1:]

    @property
    def rings(self) -> Rings:
        """Rings whose densities vary as cos(angle)."""
        return self._operators.rings

    # -- columns -------------------------------------------------------------------------------------------------------
    @cached_property
    def _below(self) -> ContactRule:
        """Quadrature below the contact."""
        return ContactRule.of(self.at_rest.radius / self._operators.width)

    @cached_property
    def _exterior(self) -> tuple[Array, Array]:
        """S just within the edge, (channel, column), and exterior u_y less profile, phi, psi, (channel, n, column)."""
        count, rings, pressed = self._below.nodes.size, self.rings, self.at_rest.density
        coupling, exponent = self.response.coupling[self._layout.channels] * np.pi / 2, self.response.shape.exponent
        edge_chi = exponent * self.response.shape.rise  # of the shifted profile
        by_layers = self._layered[1]
        chi = np.zeros((len(self._layout.channels), self._layout.columns))
        chi[0, SHIFT] = edge_chi
        chi[:, FRICTION] = -coupling * pressed.hilbert(_EDGE)[0, 0, 0]
        edges = self._operators.inverse @ (chi - by_layers[:, count])
        exterior_chi = self._operators.exterior_chi(by_layers[:, count:], edges)
        exterior_chi[..., FRICTION] += coupling[:, None] * _hilbert_beyond(pressed, rings.grid.theta)
        displaced = rings.displacement @ exterior_chi
        displaced[0, :, SHIFT] -= edge_chi * rings.power(exponent - 1)
        return edges, displaced

    @cached_property
    def _layered(self) -> tuple[Array, Array]:
        """Layers' part of S at ``_below`` and of N S there, at the edge and exterior nodes; (channel, node, column)."""
        radius, below, operators = self.at_rest.radius, self._below, self._operators
        targets = np.concatenate([below.nodes, _EDGE, self.rings.grid.distance])
        by_layers = np.zeros((len(self._layout.channels), targets.size, self._layout.columns))
        if self.shear_layers is None:
            return by_layers[:, : below.nodes.size], by_layers
        for row, by_density in enumerate(operators.from_exterior(radius, targets)):
            by_layers[..., self._layout.densities(row)] = by_density
        graded = below.graded
        by_layers[..., :CAUSES] = summed(operators.within(radius, targets, graded), self._closed(graded.nodes))
        by_layers[..., FRICTION] += self._by_shear(radius, targets, graded)
        return operators.balanced(operators.within(radius, targets, below), by_layers)

    def _closed(self, s: Array) -> Array:
        """S of a half-space below the contact at s (s,) from 0 to 1, by shift and friction; (channel, s, 2)."""
        by_friction, by_shift = self.response.factors
        columns = [
            by_shift[:, None] * s ** (self.response.shape.exponent - 1),
            -by_friction[:, None] * self.at_rest.density.hilbert(s)[0, 0],
        ]
        return np.asarray(np.pi / 2 * np.stack(columns, -1)[self._layout.channels])

    def _by_shear(self, radius: float, targets: Array, rule: ContactRule) -> Array:
        """Layers' part of chi at ``targets`` that the shear traction causes; (channel, target)."""
        assert self.shear_layers is not None
        weights = -radius / 2 * self.at_rest.density.at(rule.nodes)[0, 0] * rule.weights
        distance = targets[:, None] - rule.nodes
        kernels = np.sign(distance)[..., None] * self.shear_layers.at(radius * np.abs(distance))
        kernels += self.shear_layers.at(radius * (targets[:, None] + rule.nodes))
        return np.asarray(np.einsum("tbi,b->it", kernels, weights)[self._layout.channels])

    # -- solution ------------------------------------------------------------------------------------------------------
    @cached_property
    def _weights(self) -> Array:
        """Sizes of the columns, from the smooth edge and the gap's law (P8.5), zero without friction; (column,)."""
        if not self.friction:
            return np.zeros(self._layout.columns)
        state, layout, profile = self.at_rest, self._layout, self.at_rest.operators.profile
        edges, displaced = self._exterior
        law = np.empty((layout.columns - 1, layout.columns))  # friction is given
        law[0] = edges[0]
        for row, at_rest in enumerate(state.over_size):
            field_law = law[1 + row * layout.nodes : 1 + (row + 1) * layout.nodes]
            field_law[:] = -(at_rest / profile)[:, None] * displaced[0]
            field_law -= state.conductance[row, :, None] * displaced[1 + row]
            field_law[:, SHIFT] += at_rest * state.gap / profile * self._end_factor_rate
            field_law[:, layout.densities(row)][np.diag_indices(layout.nodes)] += state.gap / profile
        unknown = np.delete(np.arange(layout.columns), FRICTION)
        per_friction = np.ones(layout.columns)
        per_friction[unknown] = solved(law[:, unknown], -law[:, FRICTION])
        return self.friction * per_friction

    @property
    def _end_factor_rate(self) -> Array:
        """Relative change of the gap law's factor 1 + r^2/end^2 for a unit shift; (n,)."""
        return np.asarray(2 * (1 - self.at_rest.end_factor) / self.rings.grid.distance)

    @property
    def shift(self) -> float:
        """Shift c of the contact over its radius."""
        return float(self._weights[SHIFT])

    @cached_property
    def over_size(self) -> Array:
        """D_y and B_y of cos(angle) at the nodes, over C a^(e-1) and over ``size``; (field, n)."""
        return self._weights[CAUSES:].reshape(len(self._layout.fields), self._layout.nodes)

    @cached_property
    def exterior_densities(self) -> tuple[Array, Array]:
        """D_y and B_y of cos(angle) at the nodes, and eps0 E and mu0 H of the gap, over C a^(e-1); (field, n) each."""
        densities, end_factor = self.over_size * self.rings.size, self.at_rest.end_factor
        by_shift = self.at_rest.exterior_densities / end_factor * self.shift * self._end_factor_rate
        return densities, densities / end_factor + by_shift

    @property
    def reach(self) -> float:
        """Largest field in the gap over its limit 1/r_1 (points, 6), which the first order can exceed."""
        N, channels, (_, turned) = self._operators.compliance, self._conducted, self.exterior_densities
        at_rest = self.at_rest.exterior_densities / self.at_rest.end_factor
        over_limit = -self.at_rest.unit * N[0, channels] / N[channels, channels] / self.at_rest.media
        return float(max(np.max(over_limit[:, None] * (at_rest + sign * turned)) for sign in (1.0, -1.0)))

    # -- tractions -----------------------------------------------------------------------------------------------------
    @cached_property
    def series(self) -> Array:
        """Coefficients of P_n(2 b - 1) in psi without its closed part, over C a^(e-1); (3, n)."""
        if not self.friction:
            return np.zeros((3, 1))
        result = np.zeros((3, 2 * self._below.nodes.size))
        S = self._layered[0] @ self._weights
        result[self._layout.channels] = S @ self._below.odd_series.T
        return result

    def sines(self, b: Array) -> Array:
        """Density psi over C a^(e-1) below the contact at b (b,) from 0 to 1; (3, b)."""
        closed = self.response.closed(self.friction * self.at_rest.density.hilbert(b)[0, 0], b, np.array(self.shift))
        return np.asarray(closed + self.series @ legendre(b, self.series.shape[1]).T)

    def tractions(self, ratio: float) -> AirPointTractions:
        """Tractions on the whole surface; ``ratio`` is the radius over the unit of the body's lengths."""
        if not self.friction:
            return self.at_rest.tractions(ratio)

        def sines(b: Array, columns: Indices) -> Array:
            return self.at_rest.unit * np.broadcast_to(self.sines(b), (columns.size, 3, b.size))

        at_rest = self.at_rest.tractions(ratio, self.over_size)
        return replace(at_rest, friction=np.array([self.friction]), sines=sines)

    # -- parts of the quantities, over C a^(e-1) -----------------------------------------------------------------------
    def along(self, field: int | None) -> Array:
        """Bounded part of D, B or pressure (None) on the ray of ``ray_of``, at rest and of cos(angle); (2, point)."""
        shape, channel = self._operators.shape, 0 if field is None else 1 + field
        ray, sheared = ray_of(shape), self.at_rest.density.times(np.full(3, self.friction))
        shift, series = np.array([self.shift]), self.series[None, channel]
        turned = turned_pressures(self.response, sheared, shift, series, channel)[0]
        at_rest = self.at_rest.bounded(ray.r, _induced_on_ray(self.at_rest.operators.rings, shape))[channel]
        if field is None:
            return np.stack([-at_rest, turned])
        densities = self.over_size[self._layout.fields.index(field)]
        edge = self.sines(_EDGE)[channel, 0]
        return np.stack([at_rest, edge * ray.x / ray.r - turned + _induced_on_ray(self.rings, shape) @ densities])

    @property
    def weighted(self) -> tuple[Array, Array, Array]:
        """Nodes b below and outside the contact, (b,), weights times phi, (3, b), and (eta phi_sigma, psi), (4, b)."""
        reach = self.at_rest.radius / self._operators.width
        rule = hankel.nodes(parts=4 + int(_PANELS_IN_B * reach), kinked=True)
        exterior_b, rule_weights = self.rings.rule
        within = np.concatenate([self.at_rest.density.at(rule.b)[0], self.sines(rule.b)])
        exterior = np.zeros((2, 3, exterior_b.size))
        at_rest, turned = (self.at_rest.operators.rings, self.at_rest.over_size), (self.rings, self.over_size)
        for number, (rings, densities) in enumerate((at_rest, turned)):
            S = (densities @ rings.abel.T / rings.size).reshape(len(densities), rings.grid.panels, -1)
            exterior[number, self._conducted] = np.einsum("psn,fpn->fps", rule_weights, S).reshape(len(densities), -1)
        weights = np.concatenate([within * rule.weights, _DENSITY_PER_S * exterior.reshape(6, -1)], 1)
        return np.append(rule.b, exterior_b), weights[:3], np.concatenate([self.friction * weights[:1], weights[3:]])

    @property
    def moments(self) -> Array:
        """Return int_0^1 (t s + t_1 s^2) ds of (sigma_yy, D_y, B_y) below the contact; (3,)."""
        rule = hankel.nodes(kinked=True)
        result = (self.at_rest.density.at(rule.b)[0] + 2 * rule.b * self.sines(rule.b)) @ rule.weights
        result[self._conducted] += self.at_rest.over_size @ _induced_moment(self.at_rest.operators.rings)
        result[self._conducted] += self.over_size @ _induced_moment(self.rings)
        return np.asarray(result)

    @property
    def trailing_charges(self) -> Array:
        """Charges (0, D_y, B_y) of the surface just outside the trailing edge; (3,)."""
        result = np.zeros(3)
        result[self._conducted] = (self.at_rest.over_size + self.over_size) @ self.rings.grid.edge
        return result


@cached
def _induced_on_ray(rings: Rings, shape: Shape) -> Array:
    """Density on the ray of ``ray_of`` that exterior charges induce; (point, n)."""
    return rings.poisson(ray_of(shape).x)


@cached
def _induced_moment(rings: Rings) -> Array:
    """Moment of the charge that rings induce below the contact, less the part of S within; (n,)."""
    x, weights = gauss(_ENDS_IN_X, _RULE)
    r = np.sqrt((1 - x) * (1 + x))
    of_edge = _DENSITY_PER_S * (2 / 3) ** rings.order * rings.at_edge
    return np.asarray((weights * x * r**rings.order) @ rings.poisson(x) - of_edge)


def largest_within(slid: Sequence[SlidingPoint], field: int | None, at_rest: Array) -> Array:
    """Largest bounded abs(D_y) (0), abs(B_y) (1) or pressure (None) below contacts, over C a^(e-1); (case,)."""
    result, signs = np.array(at_rest), (1.0,) if field is None else (1.0, -1.0)
    for case, contact in enumerate(slid):
        if contact.friction:
            along, ray = contact.along(field), ray_of(contact.at_rest.operators.shape)
            tops = (float(ray.top(*(sign * along[:, None]))[0]) for sign in signs)
            result[case] = max(result[case], *tops)  # the ray leaves out the apex of exponents below 2
    return result


def largest_exterior(states: PointStates, slid: Sequence[SlidingPoint], row: int, *, gap: bool) -> Array:
    """Largest exterior density along the sliding direction, or eps0 E of the gap, over C a^(e-1); (case,)."""
    rings = states.rings
    at_rest = states.over_size[:, row] * rings.size / (states.end_factor if gap else 1.0)
    turned = np.stack([contact.exterior_densities[gap][row] for contact in slid]) if slid else 0.0
    sides = (side.reshape(len(at_rest), rings.grid.panels, -1) for side in (at_rest + turned, at_rest - turned))
    return np.maximum(*(peak_of_panels(side[:, :-1]) for side in sides))


def trailing_tension(slid: SlidingPoint, rim: Rim, body: HalfSpace | Film, units: Array) -> float:
    """Return sigma_xx [Pa] just outside the trailing edge, with the surface's charges; ``units`` (3,) of the body."""
    unit = slid.at_rest.unit / units
    first, third = (float(part[0] * slid.friction * unit[0]) for part in edge_sums(slid.at_rest.density))
    result = rim.tension(slid.moments * unit, (np.array(first), np.array(third)))
    result = result + rim.charged(slid.trailing_charges * unit)
    if isinstance(body, Film):
        b, plain, turned = slid.weighted
        added = added_tension(body.kind.film, rim, slid.at_rest.radius, b, plain, turned)
        result = result + slid.at_rest.unit * added
    return float(result)


_MOST_REACH = 1.1  # largest ratio of the gap's field to its limit without a warning


def warn_of_charges(reach: float) -> None:
    """Warn by :class:`FirstOrderWarning` if the gap's field exceeds the limit of ``SlidingPoint.reach``."""
    if reach > _MOST_REACH:
        warnings.warn(
            f"friction: to its first order the field in the gap beside the edge is {reach:.2g} times that at which the "
            "surface gives way to charges: gap_field and peak_displacement are too large, trailing_tension errs by a "
            "part of what air adds to it",
            FirstOrderWarning,
            stacklevel=2,
        )
