"""Bessel functions of many orders at once.

Spherical ones by recurrence up to the order z, by falling ratios beyond it; J_2 and J_3 from J_0 and J_1.
"""

import numpy as np
from scipy.special import j0, j1

from solver.arrays import Array

_BEYOND = 24  # orders above the highest one, from which the ratios begin: they forget their beginning
_SMALL = 0.1  # where series are used
_MOST = 400_000  # values of all orders held at once


def even_orders(z: Array, count: int, odd: int = 0) -> Array:
    """j_2n(z), or j_(2n+1)(z) with ``odd`` = 1, of n = 0 .. count - 1 at z > 0; (count, ...).

    z: (...), > 0.
    """
    flat = z.ravel()
    found: Array = np.empty((count, flat.size))
    step = max(_MOST // (2 * count), 1)
    for start in range(0, flat.size, step):
        some = slice(start, start + step)
        found[:, some] = _orders(flat[some], 2 * count - 2 + odd)[odd::2]
    return found.reshape(count, *z.shape)


def bessel_orders(k: Array, x: Array, count: int) -> Array:
    """J_n(kx), n = 0 .. count - 1 of 3 or 4, to rounding of their largest values; (count, k, x)."""
    away, which = np.unique(np.abs(x), return_inverse=True)
    z = k[:, None] * away
    small, apart = z < _SMALL, np.maximum(z, _SMALL)
    found = [j0(z), j1(z)]
    found.append(np.where(small, z**2 / 8 * (1 - z**2 / 12 + z**4 / 384), 2 / apart * found[1] - found[0]))
    if count > 3:
        found.append(np.where(small, z**3 / 48 * (1 - z**2 / 16 + z**4 / 640), 4 / apart * found[2] - found[1]))
    whole = np.stack(found)[:, :, which]
    whole[1::2] *= np.sign(x)
    return np.asarray(whole)


def _orders(z: Array, highest: int) -> Array:
    """j_0 .. j_highest; (highest + 1, z)."""
    ratios = _ratios(z, highest)
    orders: Array = np.empty((highest + 1, z.size))
    before, orders[0] = np.cos(z) / z, np.sinc(z / np.pi)
    for n in range(highest):
        ahead = (2 * n + 1) / z * orders[n] - before
        before = orders[n]
        orders[n + 1] = np.where(z > n + 1, ahead, orders[n] * ratios[n + 1])
    return orders


def _ratios(z: Array, highest: int) -> Array:
    """j_n / j_(n-1), which is meant where n > z; (highest + 1, z)."""
    ratios: Array = np.zeros((highest + 1, z.size))
    if np.min(z, initial=np.inf) >= highest:
        return ratios
    ratio = np.zeros_like(z)
    for n in range(highest + _BEYOND + int(2 * highest ** (1 / 3)), 0, -1):
        # j_(n-1) + j_(n+1) = (2 n + 1) / z j_n; what the waves below the order z do to it is not used
        ratio = np.minimum(z / np.maximum(2 * n + 1 - z * ratio, 1.0), 1.0)
        if n <= highest:
            ratios[n] = ratio
    return ratios
