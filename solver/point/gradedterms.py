"""What a graded film adds to the half-space's tractions at given radii: Abel's equation on pieces (points, 4).

With t(k) = int_0^1 phi(b) cos(kab) db, as in (P7.1), phi over C a^(e-1),

    (pi/2) N phi(b) + (a/2) int_-1^1 Lambda(a |b - b'|) phi(b') db' = (u0, rise b^e),

whose kernel is singular at 0 where the material changes with depth. What stands at the pieces' nodes, and phi at the
edge, are the coefficients here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

import numpy as np
from numpy.polynomial.chebyshev import chebval

from approximation.chebyshev import coefficients, mapped_points
from solver.arrays import Array, BoolArray
from solver.point.halfspace import conducted
from solver.point.pieces import Pieces
from solver.point.profile import Shape
from solver.point.surfacekernel import PAIRS, normal_kernel
from solver.stack.layers import Stack

_BETWEEN = 12  # Chebyshev points between two samples of the pressure
_KEPT = 256  # sets of places


@cache
def pieces(*, kinked: bool, odd: bool = False) -> Pieces:
    """Made once: what kernels are integrated by is the same of every film."""
    return Pieces(kinked, odd)


def pieces_below(stack: Stack, shape: Shape, *, odd: bool = False) -> Pieces | None:
    """On which densities of a film stand where its top is graded; None: they are of Legendre functions."""
    return pieces(kinked=shape.exponent % 2 != 0, odd=odd) if stack.top.graded else None


def coupled(pairs: Array, conducts: BoolArray) -> Array:
    """Of the pairs (place, ..., 6), without what couples fields that the punch does not conduct; (3, place, 3, ...).

    pairs: (place, ..., 6), of ``solver.point.surfacekernel.PAIRS``; conducts: (2,), of the electric and the magnetic
    field.
    """
    whole = np.empty((*pairs.shape[:-1], 3, 3))
    for pair, (i, j) in enumerate(PAIRS):
        whole[..., i - 1, j - 1] = whole[..., j - 1, i - 1] = pairs[..., pair]
    return np.moveaxis(conducted(whole, conducts), (-2, -1), (0, 2))


@lru_cache(_KEPT)
def _forms(of: Pieces, x: tuple[float, ...]) -> Array:
    return -of.bounded(np.array(x))


@dataclass(frozen=True, eq=False)
class GradedTerms:
    """Densities at nodes of pieces, and at the edge behind them."""

    stack: Stack
    conducts: BoolArray
    compliance: Array
    shape: Shape
    radii: Array

    @property
    def _pieces(self) -> Pieces:
        return pieces(kinked=self.shape.exponent % 2 != 0)

    @property
    def loads(self) -> Array:
        """Shares of the coefficients in a load over 2 pi; (n,)."""
        return np.append(self._pieces.weights, 0.0)

    @property
    def edges(self) -> Array:
        """Shares of them in the strength at the edge; (n,)."""
        return np.append(np.zeros(self._pieces.count), 1.0)

    def forms(self, x: Array) -> Array:
        """Shares of them in a traction less its strength over x; (x, n)."""
        return _forms(self._pieces, tuple(x.tolist()))

    def between(self, series: Array, low: Array, high: Array) -> Callable[[Array], Array]:
        """A traction less its strength over x at x within limits (case,), of coefficients (case, n).

        series: (case, n), coefficients; low, high: (case,), limits of x.
        """
        x = np.stack([mapped_points(_BETWEEN, *pair) for pair in zip(low.tolist(), high.tolist(), strict=True)])
        values = np.stack([self.forms(own) @ row for own, row in zip(x, series, strict=True)], 1)
        polynomials = coefficients(values)

        def read(at: Array) -> Array:
            values = chebval((2 * at - low - high) / (high - low), polynomials, tensor=False)
            return np.asarray(values, dtype=np.float64)

        return read

    @cached_property
    def coefficients(self) -> Array:
        """Coefficients of u0 in each channel and of g = (r/a)^e, without the half-space's; (radius, 3, n, 4)."""
        return np.array([self._at(radius) for radius in self.radii.tolist()])

    @cached_property
    def _halfspace(self) -> Array:
        """phi of the half-space at the nodes; (3, node, 4)."""
        inverse = 2 / np.pi * np.linalg.inv(self.compliance)
        found = np.zeros((3, self._pieces.count, 4))
        found[:, :, :3] = inverse[:, None]
        found[:, :, 3] = inverse[:, :1] * self.shape.rise * self._pieces.nodes**self.shape.exponent
        return found

    def _at(self, radius: float) -> Array:
        """At one radius; (3, n, 4)."""
        count, reach = self._pieces.count, 2 * float(np.max(self.radii))
        kernels = normal_kernel(self.stack, reach).at(radius * np.abs(self._pieces.points.distances))
        layers = coupled(radius / 2 * self._pieces.integrated(kernels), self.conducts)  # (3, place, 3, node)
        own = np.einsum("ij,mn->imjn", np.pi / 2 * self.compliance, np.eye(count))
        system = (own + layers[:, :count]).reshape(3 * count, 3 * count)
        right = -np.einsum("imjn,jnd->imd", layers, self._halfspace, optimize=True)
        inside = np.linalg.solve(system, right[:, :count].reshape(3 * count, 4)).reshape(3, count, 4)
        edge = right[:, count] - np.einsum("ijn,jnd->id", layers[:, count], inside)
        edge = np.linalg.solve(np.pi / 2 * self.compliance, edge)
        return np.concatenate([inside, edge[:, None]], 1)
