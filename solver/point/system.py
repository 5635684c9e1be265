"""Galerkin's equations for the tractions of a contact of known radius on a layered body (points, 4).

With x = sqrt(1 - s^2/a^2) a traction is sum_n c_n P_2n(x) / (abs(P_2n(0)) x), whose transform is a^2 c_n j_2n(ka).
Tested with these functions, the displacements below the punch give

    a sum_n A_mn c_n = u0 delta_m0 + <g>_m,    A_mn = N pi / (2 (4 n + 1)) delta_mn + K_mn,
    K_mn(a) = int_0^inf Delta(s/a) j_2m(s) j_2n(s) ds,    Delta = Y_top - Y0 over (y, phi, psi).

Delta is the plane's: a surface wave has the same multiplier in space. The half-space's coefficients, known in closed
form, are kept apart: the layers' contribution has few terms, whatever the profile. On a base that insulates the
magnetic field the flux leaves sideways: psi is then a logarithm far away, and zero at the distance of all layers'
thickness.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.point.hankel import even_orders
from solver.point.profile import Shape
from solver.stack.electroded import difference
from solver.stack.layers import Stack
from solver.stack.reflection import sideways
from solver.stack.wavenumbers import DECAYED, strip, wavenumbers

_BLOCK = 2_000_000  # values of the Bessel functions held at once
_SIZES, _ROWS = 2, 36  # groups of radii an octave, and rows of symmetric products at a time
_LEAST, _STEPS = 44.0, 6  # exponent of what is below rounding, and steps of the iteration that finds where


def interactions(stack: Stack, radii: Array, count: int, odd: int = 0) -> Array:
    """K of a stack at radii [m] in the units of the stack; (radius, 3, 3, count, count)."""
    found: Array = np.zeros((radii.size, 3, 3, count, count))
    width = strip(stack)
    sizes = np.floor(_SIZES * np.log2(1 + radii / width))
    for size in np.unique(sizes):  # a narrow contact needs fewer wavenumbers
        alike = np.flatnonzero(sizes == size)
        reach = float(np.max(radii[alike]))
        k, weights = wavenumbers(stack, 2 * reach, width * DECAYED / _decayed(reach / width))
        added = weights * np.moveaxis(difference(stack, k)[:, 1:, 1:], 0, -1)
        step = max(_BLOCK // (count * k.size), 1)
        for start in range(0, alike.size, step):
            some = alike[start : start + step]
            orders = np.moveaxis(even_orders(radii[some, None] * k, count, odd), 0, 1)  # (radius, n, k)
            for i, j in _coupled(added):
                found[some, i, j] = found[some, j, i] = _products(orders, added[i, j])
        if not odd and (spread := sideways(stack)):
            found[alike, 2, 2, 0, 0] -= np.sum(weights * spread / k * np.exp(-k * stack.thickness / 2))
    return np.asarray(found * radii[:, None, None, None, None])


def _decayed(ratio: float) -> float:
    """Exponent s at the largest wavenumber, where e^-s / (s ratio)^2 is below rounding: j_2m j_2n falls like k^-2."""
    exponent = DECAYED
    for _ in range(_STEPS):
        exponent = min(DECAYED, max(_LEAST - 2 * np.log(max(exponent * ratio, 1.0)), 1.0))
    return float(exponent)


def _products(orders: Array, weights: Array) -> Array:
    """Sums of products of the functions (radius, n, k), symmetric: from the diagonal on; (radius, n, n)."""
    count = orders.shape[1]
    found, weighted = np.empty((len(orders), count, count)), orders * weights
    for first in range(0, count, _ROWS):
        rows = slice(first, first + _ROWS)
        found[:, rows, first:] = weighted[:, rows] @ np.swapaxes(orders[:, first:], -1, -2)
        found[:, first:, rows] = np.swapaxes(found[:, rows, first:], -1, -2)
    return found


def _coupled(added: Array) -> list[tuple[int, int]]:
    """Pairs of channels that a stack couples."""
    return [(i, j) for i in range(3) for j in range(i, 3) if np.any(added[i, j])]


def added_forms(x: Array, count: int) -> Array:
    """(P_2n(x) - P_2n(0)) / (abs(P_2n(0)) x) at x > 0; (..., n).

    x: (...), sqrt(1 - r^2/a^2) > 0.
    """
    values = np.polynomial.legendre.legvander(x, 2 * count - 2)[..., ::2]
    middle = np.polynomial.legendre.legvander(np.zeros(1), 2 * count - 2)[0, ::2]
    return np.asarray((values - middle) / (np.abs(middle) * x[..., None]))


def added_means(x: Array, count: int) -> Array:
    """int_0^r of ``added_forms`` times s ds over r^2 at r = sqrt(1 - x^2) <= 1; (..., n).

    As int_x^1 P_m(v) dv = (1 - x^2) P_m'(x) / (m (m + 1)).

    x: (...), sqrt(1 - r^2/a^2).
    """
    m = 2 * np.arange(count)
    whole = np.eye(2 * count - 1)[::2] / np.maximum(m * (m + 1), 1)[:, None]
    own = np.polynomial.legendre.legval(x, np.polynomial.legendre.legder(whole, axis=1).T) if count > 1 else 0 * x[None]
    middle = np.polynomial.legendre.legvander(np.zeros(1), 2 * count - 2)[0, ::2]
    found = np.moveaxis(own, 0, -1) - middle / (1 + x[..., None])
    return np.asarray(np.where(m > 0, found / np.abs(middle), 0.0))


def halfspace_terms(compliance: Array, shape: Shape, count: int) -> Array:
    """a c of the half-space of N (3, 3), of u0 in each channel and of g = (r/a)^exponent; (3, n, 4).

    compliance: (3, 3), N of the contact.
    """
    inverse = np.linalg.inv(compliance)
    found = np.zeros((3, count, 4))
    found[:, 0, :3] = 2 / np.pi * inverse
    moments = 2 / np.pi * (4 * np.arange(count) + 1) * shape.moments(count)
    found[:, :, 3] = inverse[:, :1] * moments
    return found


@dataclass(frozen=True, eq=False)
class Added:
    """What layers and base add to the coefficients of the half-space."""

    compliance: Array
    interactions: Array
    shape: Shape

    @cached_property
    def halfspace(self) -> Array:
        """a c of the half-space, of u0 in each channel and of g = (r/a)^exponent; (3, n, 4)."""
        return halfspace_terms(self.compliance, self.shape, self.interactions.shape[-1])

    @property
    def loads(self) -> Array:
        """Shares of the coefficients in a load over 2 pi; (n,)."""
        return np.asarray(np.eye(self.interactions.shape[-1])[0])

    @property
    def edges(self) -> Array:
        """Shares of them in the strength at the edge; (n,)."""
        return np.asarray((-1.0) ** np.arange(self.interactions.shape[-1]))

    def forms(self, x: Array) -> Array:
        """Shares of them in a traction less its strength over x = sqrt(1 - r^2/a^2) > 0; (..., n)."""
        return added_forms(x, self.interactions.shape[-1])

    def between(self, series: Array, low: Array, high: Array) -> Callable[[Array], Array]:
        """A traction less its strength over x at x within limits (case,), of coefficients (case, n).

        series: (case, n), coefficients; low, high: (case,), limits of x.
        """
        return lambda x: np.asarray(np.sum(series * self.forms(x), -1))

    @cached_property
    def coefficients(self) -> Array:
        """a c without the half-space's; (radius, 3, n, 4)."""
        count = self.interactions.shape[-1]
        own = np.einsum("ij,mn->imjn", self.compliance, np.diag(np.pi / 2 / (4 * np.arange(count) + 1)))
        layers = np.moveaxis(self.interactions, 2, 3).reshape(-1, 3 * count, 3 * count)
        right = -layers @ self.halfspace.reshape(3 * count, 4)
        solved = np.linalg.solve(own.reshape(3 * count, 3 * count) + layers, right)
        return np.asarray(solved.reshape(-1, 3, count, 4))
