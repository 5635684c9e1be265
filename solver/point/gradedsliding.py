"""What the layers below a graded film make of friction: Abel's equation of odd densities on pieces (points, 8).

With Lambda of (P4.3), Lambda_x of :mod:`solver.point.surfacekernel` and psi_0 the half-space's closed answer, what is
left of psi obeys

    N chi(b) + (a/pi) int_-1^1 Lambda(a |b - b'|) chi(b') db' = -(a/pi) int_-1^1 Lambda(a |b - b'|) psi_0(b') db'
        + (a/pi) int_-1^1 Lambda_x(a (b - b')) phi_sigma(b') db' - k H[phi_added](b),

phi_added what the layers add without friction. chi has (1 - b) log(1 - b)^2 at the edge and stands on the pieces of
:mod:`solver.point.gradedterms`, odd.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from solver.arrays import Array, BoolArray
from solver.point.density import Density
from solver.point.gradedterms import coupled, pieces
from solver.point.pieces import Pieces
from solver.point.profile import Shape
from solver.point.response import Response
from solver.point.surfacekernel import normal_kernel, shear_kernel
from solver.stack.layers import Stack

_EDGE = np.ones(1)


def odd_shares(of: Pieces, b: Array) -> Array:
    """Shares of odd coefficients, the edge's behind those of the nodes, in what they are at b; (b, n).

    b: (b,), 0 to 1.
    """
    edge = b == 1
    found = np.zeros((b.size, of.count + 1))
    found[edge, -1] = 1.0
    found[~edge, :-1] = of.shares(b[~edge])
    return found


@lru_cache
def odd_rates(of: Pieces, x: tuple[float, ...]) -> Array:
    """Shares of odd coefficients in (1/r) int_0^x psi'(sqrt(r^2 + w^2)) dw, r^2 = 1 - x^2; (x, n)."""
    at = np.array(x)
    return np.asarray(of.bounded(at, power=1) / np.sqrt((1 - at) * (1 + at))[:, None])


@lru_cache
def hilbert(*, kinked: bool) -> Array:
    """Matrix (n + 1, n) of (1/pi) PV int_-1^1 phi(s) / (b - s) ds: phi at the nodes to b at nodes and edge."""
    of = pieces(kinked=kinked)
    found, b = of.integrated(1 / of.points.distances[:, None])[..., 0], of.nodes
    there = np.arange(of.count)
    found[there, there] += np.log((1 + b) / (1 - b)) - np.sum(found[:-1], -1)  # less phi(b), whose integral is closed
    return found / np.pi


@lru_cache
def _closed(shape: Shape) -> tuple[Array, Array]:
    """What the half-space's answer consists of: H of the pressure's unit form, and a unit shift; (point,) each."""
    sources = pieces(kinked=shape.exponent % 2 != 0, odd=True).points.sources
    b, unit_form = np.abs(sources), np.ones((1, 3))
    unit = Density(shape, unit_form * shape.flat, unit_form, np.zeros((1, 3, 0)))
    moved = np.zeros_like(b) if shape.flat else b ** (shape.exponent - 1)
    return np.sign(sources) * unit.turned(b)[0, 0], np.sign(sources) * moved


@dataclass(frozen=True, eq=False)
class GradedLayers:
    """What layers and base add to the half-space of the top, over distances."""

    stack: Stack  # The film, its top layer graded and of unit thickness
    conducts: BoolArray  # Of the electric and the magnetic field; (2,)
    shape: Shape  # The punch
    reach: float  # The largest distance that is asked for

    @property
    def _kinked(self) -> bool:
        return self.shape.exponent % 2 != 0

    def solved(self, response: Response, causes: Density, radius: float) -> Array:
        """c/a and coefficients of psi without the half-space's, per eta; (cause, 1 + 3 n)."""
        even, odd = (pieces(kinked=self._kinked, odd=parity) for parity in (False, True))
        count, points = even.count, odd.points
        away, sign = radius * np.abs(points.distances), np.sign(points.distances)[:, None]
        normal = radius / np.pi * normal_kernel(self.stack, self.reach).at(away)
        along_x = radius / np.pi * sign * shear_kernel(self.stack, self.reach).at(away)
        layers = coupled(odd.integrated(normal), self.conducts)  # (3, place, 3, node)
        own = np.einsum("ij,mn->imjn", response.compliance, np.eye(count))
        system = (own + layers[:, :count]).reshape(3 * count, 3 * count)

        turned, moved = (coupled(odd.summed(normal * values[:, None]), self.conducts) for values in _closed(self.shape))
        along, unit = response.answers
        size = (causes.strengths if self.shape.flat else causes.form)[:, 0]
        pushed = np.einsum("mni,cn->imc", even.integrated(along_x), causes.at(even.nodes)[:, 0])
        bent = hilbert(kinked=self._kinked) @ (causes.series[:, 0, :-1] - causes.series[:, 0, -1:]).T
        right = np.where(np.array([True, *self.conducts])[:, None, None], pushed, 0.0)
        right += (turned @ along)[..., None] * size - response.coupling[:, None, None] * bent
        right = np.concatenate([right, -(moved @ unit)[..., None]], -1)  # (3, place, cause and shift)

        inside = np.linalg.solve(system, right[:, :count].reshape(3 * count, -1)).reshape(3, count, -1)
        edge = right[:, count] - np.einsum("ijn,jnc->ic", layers[:, count], inside)
        edge = np.linalg.solve(response.compliance, edge)
        return response.settled(causes.turned(_EDGE)[:, 0, 0], np.concatenate([inside, edge[:, None]], 1), edge[0])
