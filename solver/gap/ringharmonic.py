"""First-order effect of friction on a point contact and on the charges in rings around it (points, 8).

Columns are a unit shift c/a, friction eta = 1 below the contact at rest, and the densities of cos(angle) at the nodes
beside it. Below the contact chi is that of the shifted profile, s^(e-1), or none; friction makes k (pi/2) H[phi_sigma],
which is steep beside the edge on both sides, so that what follows from it without layers is kept in closed form. Units
are those of :mod:`solver.gap.ringoperators`.
"""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.gap.ringoperators import ContactRule, RingOperators, Rows, summed
from solver.gap.rules import gauss
from solver.point.friction import Response
from solver.point.kernel import SurfaceKernel
from solver.point.tractions import Density

SHIFT, RUBBED, CAUSES = 0, 1, 2  # columns before the densities
_EDGE = np.ones(1)
_NEAREST = 1e-13  # to the edge that the integral over the fall of the pressure looks
_RATIO, _RULE = 0.35, 12  # of its pieces, and their nodes


@dataclass(frozen=True, eq=False)
class HarmonicOutputs:
    """Outputs of every column at one radius."""

    edges: Array  # S of the channels just within the edge; (channel, column)
    raised: Array  # u_y less the shifted profile, and the potentials, beside the contact; (channel, n, column)
    smooth: Array  # S below the contact but for what is closed, at the nodes of ``below``; (channel, node, column)
    below: ContactRule  # Gauss's nodes


@dataclass(frozen=True, eq=False)
class RingHarmonic:
    """Contacts that slide, of one shape and conduction on one stack, or on a half-space."""

    operators: RingOperators
    response: Response
    sheared: SurfaceKernel | None = None

    @property
    def _rows(self) -> Rows:
        return self.operators.rows

    @property
    def _columns(self) -> int:
        return CAUSES + len(self._rows.fields) * self._rows.nodes

    @property
    def _coupling(self) -> Array:
        return np.asarray(self.response.coupling[self._rows.channels] * np.pi / 2)

    @property
    def _given(self) -> float:
        """chi of the shifted profile at the edge."""
        return self.response.shape.exponent * self.response.shape.rise

    def densities(self, place: int) -> slice:
        """Columns of the densities of a field, by its place."""
        return slice(CAUSES + place * self._rows.nodes, CAUSES + (place + 1) * self._rows.nodes)

    def outputs(self, radius: float, pressed: Density) -> HarmonicOutputs:
        """Outputs for a contact at rest."""
        below = ContactRule.of(radius / self.operators.width)
        count, rows, rings = below.nodes.size, self._rows, self.operators.rings
        smooth, added = self._layered(radius, below, pressed)
        chi = np.zeros((len(rows.channels), self._columns))
        chi[0, SHIFT] = self._given
        chi[:, RUBBED] = -self._coupling * pressed.turned(_EDGE)[0, 0, 0]
        edges = self.operators.inverse @ (chi - added[:, count])
        beside_it = self.operators.chi_beside(added[:, count:], edges)
        beside_it[..., RUBBED] += self._coupling[:, None] * _left(pressed, rings.grid.theta)
        raised = rings.raised @ beside_it
        raised[0, :, SHIFT] -= self._given * rings.power(self.response.shape.exponent - 1)
        return HarmonicOutputs(edges, raised, smooth, below)

    def _layered(self, radius: float, below: ContactRule, pressed: Density) -> tuple[Array, Array]:
        """Contribution of the layers to S below the contact, and to N S there, at the edge and outside."""
        rows = self._rows
        targets = np.concatenate([below.nodes, _EDGE, self.operators.rings.grid.distance])
        added = np.zeros((len(rows.channels), targets.size, self._columns))
        if self.sheared is None:
            return np.zeros((len(rows.channels), below.nodes.size, self._columns)), added
        for place, by_density in enumerate(self.operators.from_exterior(radius, targets)):
            added[..., self.densities(place)] = by_density
        graded = below.graded
        closed = self.closed(graded.nodes, pressed)
        added[..., :CAUSES] = summed(self.operators.within(radius, targets, graded), closed)
        added[..., RUBBED] += self._pulled(radius, targets, graded, pressed)
        return self.operators.settled(self.operators.within(radius, targets, below), added)

    def closed(self, s: Array, pressed: Density) -> Array:
        """S of a half-space below the contact, of shift and friction; (channel, s, 2).

        s: (s,), 0 to 1.
        """
        along, moved = self.response.answers
        columns = [moved[:, None] * s ** (self.response.shape.exponent - 1), -along[:, None] * pressed.turned(s)[0, 0]]
        return np.asarray(np.pi / 2 * np.stack(columns, -1)[self._rows.channels])

    def _pulled(self, radius: float, targets: Array, rule: ContactRule, pressed: Density) -> Array:
        """Contribution of the layers to the channels by the shear traction; (channel, target)."""
        assert self.sheared is not None
        weights = -radius / 2 * pressed.at(rule.nodes)[0, 0] * rule.weights
        distance = targets[:, None] - rule.nodes
        kernels = np.sign(distance)[..., None] * self.sheared.at(radius * np.abs(distance))
        kernels += self.sheared.at(radius * (targets[:, None] + rule.nodes))
        return np.asarray(np.einsum("tbi,b->it", kernels, weights)[self._rows.channels])


def _left(pressed: Density, theta: Array) -> Array:
    """H[phi_sigma] at cosh(theta) less that at the edge, by the fall of phi: no difference of near numbers; (n,)."""
    count = int(np.log(_NEAREST) / np.log(_RATIO))
    near, weights = gauss(np.append(0.0, _RATIO ** np.arange(count, -1, -1.0) / 2), _RULE)  # from the edge, or the apex
    from_edge = np.concatenate([near, 1 - near])
    two_weights = np.concatenate([weights, weights])
    beyond = 2 * np.sinh(theta[:, None] / 2) ** 2
    kernel = np.log1p(beyond / from_edge) - np.log1p(beyond / (2 - from_edge))
    return np.asarray(-(kernel @ (two_weights * pressed.falling(1 - from_edge)[0, 0])) / np.pi)
