"""A sliding point contact with air beside it: the change of its state at rest to first order in friction.

The gap's law of points, 6, about the state at rest: with D = D_0 + D_1 cos(angle) and the gap g_0 + g_1 cos(angle),
lengths in contact radii, end the punch's radius, c the shift,

    D_1 g_0 + D_0 [g_1 + g_0 2 c r / (end^2 + r^2)] = eps0 end^2 / (end^2 + r^2) phi_1,

and the same with B, mu0 and psi. Linear in c and D_1, with a smooth edge of the pressure.
"""

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
from solver.gap.ringoperators import ContactRule, RingOperators, Rows, summed
from solver.gap.rings import Rings
from solver.point import hankel
from solver.point.body import Film, HalfSpace
from solver.point.friction import Response, Rim, added_tension, edge_sums, legendre
from solver.point.kernel import SurfaceKernel
from solver.point.profile import Shape
from solver.point.sliding import FirstOrderWarning
from solver.point.slidingpressure import ray_of, turned_pressures
from solver.point.tractions import Density

SHIFT, RUBBED, CAUSES = 0, 1, 2  # columns before the densities
_EDGE = np.ones(1)
_NEAREST = 1e-13  # to the edge that the integral over the fall of the pressure looks
_RATIO = 0.35  # of its pieces, and their nodes


def _left(pressed: Density, theta: Array) -> Array:
    """H[phi_sigma] at cosh(theta) less that at the edge, by the fall of phi: no difference of near numbers; (n,)."""
    count = int(np.log(_NEAREST) / np.log(_RATIO))
    near, weights = gauss(np.append(0.0, _RATIO ** np.arange(count, -1, -1.0) / 2), _RULE)  # from the edge, or the apex
    from_edge = np.concatenate([near, 1 - near])
    two_weights = np.concatenate([weights, weights])
    beyond = 2 * np.sinh(theta[:, None] / 2) ** 2
    kernel = np.log1p(beyond / from_edge) - np.log1p(beyond / (2 - from_edge))
    return np.asarray(-(kernel @ (two_weights * pressed.falling(1 - from_edge)[0, 0])) / np.pi)


_PART = 2 / np.pi  # a density per S
_PARTS = 6.0  # panels in b per radius over the distance that layers vary over
_ENDS, _RULE = np.append(0.0, 0.4 ** np.arange(9, -1, -1.0)), 12  # of pieces in x below the contact, and their nodes


@dataclass(frozen=True, eq=False)
class SlidingPoint:
    """The first order of one contact in friction, in the units of the body.

    Columns are a unit shift c/a, friction eta = 1 below the contact at rest, and the densities of cos(angle) at the
    exterior nodes. Below the contact chi is that of the shifted profile, s^(e-1), or none. Friction adds
    k (pi/2) H[phi_sigma], which is steep on both sides of the edge: the part of it without layers stays in closed form.
    """

    at_rest: SolvedPoint
    friction: float
    coupling: Array
    sheared: SurfaceKernel | None = None

    @cached_property
    def response(self) -> Response:
        """Response of the top half-space."""
        return Response(self._operators.compliance, self.coupling, self._operators.shape)

    @cached_property
    def _operators(self) -> RingOperators:
        """Operators of what varies as cos(angle)."""
        return replace(self.at_rest.operators, rings=self.at_rest.operators.rings.turned)

    @property
    def _rows(self) -> Rows:
        return self._operators.rows

    @property
    def _carried(self) -> list[int]:
        """Conducted fields among the channels (sigma_yy, D_y, B_y)."""
        return self._rows.channels[1:]

    @property
    def rings(self) -> Rings:
        """Rings of the part that varies as cos(angle)."""
        return self._operators.rings

    # -- columns -------------------------------------------------------------------------------------------------------
    @property
    def _columns(self) -> int:
        return CAUSES + len(self._rows.fields) * self._rows.nodes

    def _of_field(self, place: int) -> slice:
        """Columns of the densities of a field, by its place."""
        return slice(CAUSES + place * self._rows.nodes, CAUSES + (place + 1) * self._rows.nodes)

    @cached_property
    def _below(self) -> ContactRule:
        """Nodes below the contact."""
        return ContactRule.of(self.at_rest.radius / self._operators.width)

    @cached_property
    def _exterior(self) -> tuple[Array, Array]:
        """S just within the edge, and beside the contact u_y less the shifted profile and the potentials.

        (channel, column) and (channel, n, column).
        """
        count, rings, pressed = self._below.nodes.size, self.rings, self.at_rest.density
        coupling, exponent = self.response.coupling[self._rows.channels] * np.pi / 2, self.response.shape.exponent
        edge_chi = exponent * self.response.shape.rise  # of the shifted profile
        added = self._layered[1]
        chi = np.zeros((len(self._rows.channels), self._columns))
        chi[0, SHIFT] = edge_chi
        chi[:, RUBBED] = -coupling * pressed.turned(_EDGE)[0, 0, 0]
        edges = self._operators.inverse @ (chi - added[:, count])
        beside_it = self._operators.chi_beside(added[:, count:], edges)
        beside_it[..., RUBBED] += coupling[:, None] * _left(pressed, rings.grid.theta)
        raised = rings.raised @ beside_it
        raised[0, :, SHIFT] -= edge_chi * rings.power(exponent - 1)
        return edges, raised

    @cached_property
    def _layered(self) -> tuple[Array, Array]:
        """Contribution of the layers to S below the contact, and to N S there, at the edge and outside.

        S at the nodes of ``_below``, without its closed part; (channel, node, column) each.
        """
        radius, below, operators = self.at_rest.radius, self._below, self._operators
        targets = np.concatenate([below.nodes, _EDGE, self.rings.grid.distance])
        added = np.zeros((len(self._rows.channels), targets.size, self._columns))
        if self.sheared is None:
            return added[:, : below.nodes.size], added
        for place, by_density in enumerate(operators.from_exterior(radius, targets)):
            added[..., self._of_field(place)] = by_density
        graded = below.graded
        added[..., :CAUSES] = summed(operators.within(radius, targets, graded), self._closed(graded.nodes))
        added[..., RUBBED] += self._pulled(radius, targets, graded)
        return operators.settled(operators.within(radius, targets, below), added)

    def _closed(self, s: Array) -> Array:
        """S of a half-space below the contact, of shift and friction, at s (s,) from 0 to 1; (channel, s, 2)."""
        along, moved = self.response.answers
        rubbed = -along[:, None] * self.at_rest.density.turned(s)[0, 0]
        columns = [moved[:, None] * s ** (self.response.shape.exponent - 1), rubbed]
        return np.asarray(np.pi / 2 * np.stack(columns, -1)[self._rows.channels])

    def _pulled(self, radius: float, targets: Array, rule: ContactRule) -> Array:
        """Contribution of the layers to the channels by the shear traction; (channel, target)."""
        assert self.sheared is not None
        weights = -radius / 2 * self.at_rest.density.at(rule.nodes)[0, 0] * rule.weights
        distance = targets[:, None] - rule.nodes
        kernels = np.sign(distance)[..., None] * self.sheared.at(radius * np.abs(distance))
        kernels += self.sheared.at(radius * (targets[:, None] + rule.nodes))
        return np.asarray(np.einsum("tbi,b->it", kernels, weights)[self._rows.channels])

    # -- solution ------------------------------------------------------------------------------------------------------
    @cached_property
    def _weights(self) -> Array:
        """Sizes of the columns per unit of friction; (column,)."""
        state, rows, profile, (edges, raised) = self.at_rest, self._rows, self.at_rest.operators.profile, self._exterior
        law = np.empty((1 + len(rows.fields) * rows.nodes, self._columns))
        law[0] = edges[0]
        for place, at_rest in enumerate(state.over_size):
            rows_of_field = law[1 + place * rows.nodes : 1 + (place + 1) * rows.nodes]
            rows_of_field[:] = (
                -(at_rest / profile)[:, None] * raised[0] - state.conductance[place, :, None] * raised[1 + place]
            )
            rows_of_field[:, SHIFT] += at_rest * state.gap / profile * self._widened
            rows_of_field[:, self._of_field(place)][np.diag_indices(rows.nodes)] += state.gap / profile
        unknown = np.delete(np.arange(law.shape[1]), RUBBED)
        result = np.ones(law.shape[1])
        result[unknown] = solved(law[:, unknown], -law[:, RUBBED])
        return result

    @property
    def _slides(self) -> bool:
        return self.friction != 0

    @property
    def _widened(self) -> Array:
        """Relative change of the gap law's factor 1 + r^2/end^2 for a unit shift; (n,)."""
        return np.asarray(2 * (1 - self.at_rest.thinned) / self.rings.grid.distance)

    @property
    def shift(self) -> float:
        """c over the contact radius."""
        return float(self.friction * self._weights[SHIFT]) if self._slides else 0.0

    @cached_property
    def over_size(self) -> Array:
        """D_y and B_y of cos(angle) over C a^(e-1) at the nodes, over their size; (field, n)."""
        densities = self.friction * self._weights[CAUSES:] if self._slides else np.zeros(self._columns - CAUSES)
        return densities.reshape(len(self._rows.fields), self._rows.nodes)

    @cached_property
    def exterior_densities(self) -> tuple[Array, Array]:
        """Densities D_y and B_y of cos(angle) at the nodes, and the gap's field as a density, over C a^(e-1).

        (field, n) each.
        """
        densities, thinned = self.over_size * self.rings.size, self.at_rest.thinned
        return densities, densities / thinned + self.at_rest.exterior_densities / thinned * self.shift * self._widened

    @property
    def reach(self) -> float:
        """Largest field in the gap over that at which the surface gives way to its charge, 1/r of half-spaces.

        A gap's field cannot go beyond it, which the first order does not know.
        """
        N, channels, (_, turned) = self._operators.compliance, self._carried, self.exterior_densities
        at_rest = self.at_rest.exterior_densities / self.at_rest.thinned
        yielding = -self.at_rest.unit * N[0, channels] / N[channels, channels] / self.at_rest.media
        return float(max(np.max(yielding[:, None] * (at_rest + sign * turned)) for sign in (1.0, -1.0)))

    # -- tractions -----------------------------------------------------------------------------------------------------
    @cached_property
    def series(self) -> Array:
        """Coefficients of P_n(2 b - 1) in psi without its closed part, over C a^(e-1); (3, n)."""
        if not self._slides:
            return np.zeros((3, 1))
        result = np.zeros((3, 2 * self._below.nodes.size))
        S = self._layered[0] @ (self.friction * self._weights)
        result[self._rows.channels] = S @ self._below.odd_series.T
        return result

    def sines(self, b: Array) -> Array:
        """psi over C a^(e-1) below the contact at b (b,) from 0 to 1; (3, b)."""
        closed = self.response.closed(self.friction * self.at_rest.density.turned(b)[0, 0], b, np.array(self.shift))
        return np.asarray(closed + self.series @ legendre(b, self.series.shape[1]).T)

    def tractions(self, ratio: float) -> AirPointTractions:
        """On the whole surface."""
        if not self._slides:
            return self.at_rest.tractions(ratio)

        def sines(b: Array, columns: Indices) -> Array:
            return self.at_rest.unit * np.broadcast_to(self.sines(b), (columns.size, 3, b.size))

        at_rest = self.at_rest.tractions(ratio, self.over_size)
        return replace(at_rest, friction=np.array([self.friction]), sines=sines)

    # -- parts of the quantities, over C a^(e-1) -----------------------------------------------------------------------
    def along(self, field: int | None) -> Array:
        """A traction along the ray of :mod:`solver.point.slidingpressure`: at rest, and of cos(angle); (2, place).

        Without what is singular at the edge.
        """
        shape, channel = self._operators.shape, 0 if field is None else 1 + field
        ray, rubbed = ray_of(shape), self.at_rest.density.times(np.full(3, self.friction))
        shift, series = np.array([self.shift]), self.series[None, channel]
        turned = turned_pressures(self.response, rubbed, shift, series, channel)[0]
        at_rest = self.at_rest.bounded(ray.r, _drawn(self.at_rest.operators.rings, shape))[channel]
        if field is None:
            return np.stack([-at_rest, turned])
        densities = self.over_size[self._rows.fields.index(field)]
        edge = self.sines(np.ones(1))[channel, 0]
        return np.stack([at_rest, edge * ray.x / ray.r - turned + _drawn(self.rings, shape) @ densities])

    @property
    def weighted(self) -> tuple[Array, Array, Array]:
        """Nodes b, below the contact and beside it; weights times phi, and times eta phi_sigma and psi.

        (b,), (3, b) and (4, b).
        """
        reach = self.at_rest.radius / self._operators.width
        rule = hankel.nodes(parts=4 + int(_PARTS * reach), kinked=True)
        far, share = self.rings.rule
        within = np.concatenate([self.at_rest.density.at(rule.b)[0], self.sines(rule.b)])
        exterior = np.zeros((2, 3, far.size))
        at_rest, turned = (self.at_rest.operators.rings, self.at_rest.over_size), (self.rings, self.over_size)
        for number, (panels, densities) in enumerate((at_rest, turned)):
            S = (densities @ panels.gathered.T / panels.size).reshape(len(densities), panels.grid.panels, -1)
            exterior[number, self._carried] = np.einsum("psn,fpn->fps", share, S).reshape(len(densities), -1)
        weights = np.concatenate([within * rule.weights, _PART * exterior.reshape(6, -1)], 1)
        return np.append(rule.b, far), weights[:3], np.concatenate([self.friction * weights[:1], weights[3:]])

    @property
    def moments(self) -> Array:
        """int_0^1 (t s + t_1 s^2) ds of (sigma_yy, D_y, B_y) below the contact; (3,)."""
        rule = hankel.nodes(kinked=True)
        result = (self.at_rest.density.at(rule.b)[0] + 2 * rule.b * self.sines(rule.b)) @ rule.weights
        result[self._carried] += self.at_rest.over_size @ _held(self.at_rest.operators.rings)
        result[self._carried] += self.over_size @ _held(self.rings)
        return np.asarray(result)

    @property
    def just_beside(self) -> Array:
        """(0, D_y, B_y) just outside the trailing edge; (3,)."""
        result = np.zeros(3)
        result[self._carried] = (self.at_rest.over_size + self.over_size) @ self.rings.grid.edge
        return result


@cached
def _drawn(transforms: Rings, shape: Shape) -> Array:
    """Density along the ray induced by the rings; (place, n)."""
    return transforms.poisson(ray_of(shape).x)


@cached
def _held(transforms: Rings) -> Array:
    """Moment of the charge that rings induce below the contact, less the part of S within; (n,)."""
    x, weights = gauss(_ENDS, _RULE)
    r = np.sqrt((1 - x) * (1 + x))
    return np.asarray(
        (weights * x * r**transforms.order) @ transforms.poisson(x)
        - _PART * (2 / 3) ** transforms.order * transforms.at_edge
    )


_MOST_REACH = 1.1  # of the gap's field, beyond which a warning says that it is not reached


def largest_within(slid: Sequence[SlidingPoint | None], field: int | None, at_rest: Array) -> Array:
    """Largest abs(D_y) (0), abs(B_y) (1) or pressure (None) below contacts, over C a^(e-1); (case,).

    What is singular at the edge is left out, as at rest; at the apex of exponents below 2 it is that at rest.
    """
    result, signs = np.array(at_rest), (1.0,) if field is None else (1.0, -1.0)
    for case, contact in enumerate(slid):
        if contact is not None and contact.friction:
            along, ray = contact.along(field), ray_of(contact.at_rest.operators.shape)
            tops = (float(ray.top(*(sign * along[:, None]))[0]) for sign in signs)
            result[case] = max(result[case], *tops)
    return result


def largest_beside(states: PointStates, slid: Sequence[SlidingPoint | None], place: int, *, gap: bool) -> Array:
    """Largest density beside contacts, over C a^(e-1), or that which the gap's field would have at a plate; (case,).

    On the finite panels, along the sliding direction.
    """
    rings = states.rings
    at_rest = states.over_size[:, place] * rings.size / (states.thinned if gap else 1.0)
    turned = np.stack(
        [
            np.zeros(states.layout.nodes) if contact is None else contact.exterior_densities[gap][place]
            for contact in slid
        ]
    )
    sides = [(at_rest + sign * turned).reshape(len(slid), rings.grid.panels, -1)[:, :-1] for sign in (1.0, -1.0)]
    return np.maximum(*(peak_of_panels(side) for side in sides))


def trailing_tension(slid: SlidingPoint, rim: Rim, body: HalfSpace | Film, units: Array) -> float:
    """sigma_xx [Pa] just outside the trailing edge, with the surface's charges; units (3,) are those of the body."""
    unit = slid.at_rest.unit / units
    first, third = (float(part[0] * slid.friction * unit[0]) for part in edge_sums(slid.at_rest.density))
    result = rim.tension(slid.moments * unit, (np.array(first), np.array(third))) + rim.charged(slid.just_beside * unit)
    if isinstance(body, Film):
        b, plain, turned = slid.weighted
        added = added_tension(body.kind.film, rim, slid.at_rest.radius, b, plain, turned)
        result = result + slid.at_rest.unit * added
    return float(result)


def warn_of_charges(reach: float) -> None:
    """Warn by :class:`FirstOrderWarning` if the gap's field exceeds the field that a surface carries."""
    if reach > _MOST_REACH:
        warnings.warn(
            f"friction: to its first order the field in the gap beside the edge is {reach:.2g} times that at which the "
            "surface gives way to charges: gap_field and peak_displacement are too large, trailing_tension errs by a "
            "part of what air adds to it",
            FirstOrderWarning,
            stacklevel=2,
        )
