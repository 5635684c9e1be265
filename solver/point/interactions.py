"""What layers and base add to the half-space of the top, between the functions of a contact's tractions (points, 4).

    K_mn(a) = int_0^inf Delta(s/a) j_2m(s) j_2n(s) ds,    Delta = Y_top - Y0 over (y, phi, psi).

Delta is the plane's: a surface wave has the same multiplier in space. On a base that insulates the magnetic field the
flux leaves sideways: psi is then a logarithm far away, and zero at the distance of all layers' thickness.
"""

import numpy as np

from solver.arrays import Array
from solver.point.bessel import even_orders
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
