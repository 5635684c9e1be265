"""Galerkin's equations for the tractions of a contact of known radius on a layered body (points, 4).

K is the integral of Delta j_2m j_2n in (P4.2). The half-space's coefficients have a closed form and stay apart.
"""

from itertools import combinations_with_replacement

import numpy as np

from solver.arrays import Array
from solver.point.hankel import even_orders
from solver.point.profile import Shape
from solver.stack.electroded import difference
from solver.stack.layers import Stack
from solver.stack.reflection import sideways
from solver.stack.wavenumbers import DECAYED, strip, wavenumbers

_VALUES_AT_ONCE = 2_000_000  # values of the Bessel functions held at once
_SIZES, _ROWS = 2, 36  # groups of radii per octave; rows of symmetric products at a time
_ROUNDING, _DECAY_STEPS = 44.0, 6  # exponent of a value below rounding; steps of the fixed-point iteration for it


def interactions(stack: Stack, radii: Array, count: int) -> Array:
    """Return K of a stack at radii [m] in the units of the stack; (radius, 3, 3, count, count)."""
    K: Array = np.zeros((radii.size, 3, 3, count, count))
    width = strip(stack)
    sizes = np.floor(_SIZES * np.log2(1 + radii / width))
    for size in np.unique(sizes):  # a narrow contact needs fewer wavenumbers
        same_size = np.flatnonzero(sizes == size)
        reach = float(np.max(radii[same_size]))
        k, weights = wavenumbers(stack, 2 * reach, width * DECAYED / _decayed(reach / width))
        added = weights * np.moveaxis(difference(stack, k)[:, 1:, 1:], 0, -1)
        step = max(_VALUES_AT_ONCE // (count * k.size), 1)
        for start in range(0, same_size.size, step):
            block = same_size[start : start + step]
            orders = np.moveaxis(even_orders(radii[block, None] * k, count), 0, 1)  # (radius, n, k)
            for i, j in combinations_with_replacement(range(3), 2):
                if np.any(added[i, j]):  # channels that the stack couples
                    K[block, i, j] = K[block, j, i] = _products(orders, added[i, j])
        if spread := sideways(stack):  # psi is a logarithm far away, zero at the distance of all layers' thickness
            K[same_size, 2, 2, 0, 0] -= np.sum(weights * spread / k * np.exp(-k * stack.thickness / 2))
    return np.asarray(K * radii[:, None, None, None, None])


def _decayed(ratio: float) -> float:
    """Exponent s at the largest wavenumber, where e^-s / (s ratio)^2 is below rounding: j_2m j_2n falls like k^-2."""
    exponent = DECAYED
    for _ in range(_DECAY_STEPS):
        exponent = min(DECAYED, max(_ROUNDING - 2 * np.log(max(exponent * ratio, 1.0)), 1.0))
    return float(exponent)


def _products(orders: Array, weights: Array) -> Array:
    """Sums of products of the functions (radius, n, k), filled from the diagonal by symmetry; (radius, n, n)."""
    count = orders.shape[1]
    products, weighted = np.empty((len(orders), count, count)), orders * weights
    for first in range(0, count, _ROWS):
        rows = slice(first, first + _ROWS)
        products[:, rows, first:] = weighted[:, rows] @ np.swapaxes(orders[:, first:], -1, -2)
        products[:, first:, rows] = np.swapaxes(products[:, rows, first:], -1, -2)
    return products


def added_forms(x: Array, count: int) -> Array:
    """Return (P_2n(x) - P_2n(0)) / (abs(P_2n(0)) x) at x = sqrt(1 - r^2/a^2) > 0; (..., n)."""
    values = np.polynomial.legendre.legvander(x, 2 * count - 2)[..., ::2]
    at_zero = np.polynomial.legendre.legvander(np.zeros(1), 2 * count - 2)[0, ::2]
    return np.asarray((values - at_zero) / (np.abs(at_zero) * x[..., None]))


def added_means(x: Array, count: int) -> Array:
    """Return int_0^r of ``added_forms`` times s ds over r^2 at r = sqrt(1 - x^2) <= 1; (..., n)."""
    m = 2 * np.arange(count)
    # int_x^1 P_m(v) dv = (1 - x^2) P_m'(x) / (m (m + 1))
    antiderivatives = np.eye(2 * count - 1)[::2] / np.maximum(m * (m + 1), 1)[:, None]
    derived = np.polynomial.legendre.legval(x, np.polynomial.legendre.legder(antiderivatives, axis=1).T)
    at_zero = np.polynomial.legendre.legvander(np.zeros(1), 2 * count - 2)[0, ::2]
    means = np.moveaxis(derived, 0, -1) - at_zero / (1 + x[..., None])
    return np.asarray(np.where(m > 0, means / np.abs(at_zero), 0.0))


def halfspace_terms(compliance: Array, shape: Shape, count: int) -> Array:
    """Coefficients a c of the half-space of N (3, 3), for u0 in each channel and g = (r/a)^exponent; (3, n, 4)."""
    inverse = np.linalg.inv(compliance)
    terms = np.zeros((3, count, 4))
    terms[:, 0, :3] = 2 / np.pi * inverse
    moments = 2 / np.pi * (4 * np.arange(count) + 1) * shape.moments(count)
    terms[:, :, 3] = inverse[:, :1] * moments
    return terms


def added_terms(compliance: Array, interactions: Array, shape: Shape) -> Array:
    """Coefficients a c that layers with K, (radius, 3, 3, n, n), add to a half-space of N (3, 3); (radius, 3, n, 4)."""
    count = interactions.shape[-1]
    local = np.einsum("ij,mn->imjn", compliance, np.diag(np.pi / 2 / (4 * np.arange(count) + 1)))
    coupling = np.moveaxis(interactions, 2, 3).reshape(-1, 3 * count, 3 * count)
    right = -coupling @ halfspace_terms(compliance, shape, count).reshape(3 * count, 4)
    solved = np.linalg.solve(local.reshape(3 * count, 3 * count) + coupling, right)
    return np.asarray(solved.reshape(-1, 3, count, 4))
