"""Bessel functions of many orders, and Hankel integrals of half-spaces in closed form below a density (points, 7).

The transform of a contact's tractions is a density on 0 <= b <= 1, lengths over a, as of a line contact:

    t(k) = int_0^1 phi(b) cos(kb) db  without friction,    t_1(k) = int_0^1 psi(b) sin(kb) db  of its cos(angle) part.

A wave of the rate m then needs int t(k) exp(-k m z) J_n(kr) k dk: a sum over b of a closed function of m z -+ ib. It is
sharp near b = r close to the surface, where panels in b shrink with the depth.

Spherical Bessel functions follow by recurrence up to the order z, by falling ratios beyond it; J_2 and J_3 follow from
J_0 and J_1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import j0, j1

from solver.arrays import Array, ComplexArray

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


_NODES = 14  # a panel: panels as long as they are away from what is singular beside them
_KINKS = 14  # halvings of panels towards b = 0, where a cone's density is kinked, and b = 1, where friction's is steep
_PANEL = 8.0  # phase of a panel in b
#: The shallowest depth that rounding spares: what is above it is continued from below.
LEAST = 1e-5


@lru_cache
def _gauss() -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(_NODES)


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes of panels on 0 to 1, or beyond."""

    # (node,)
    b: Array
    weights: Array
    beside: Array  # b - r, which b does not tell near the sharp place; (node,)


def nodes(
    radius: float = np.inf, near: float = 1.0, *, parts: int = 4, kinked: bool = False, beyond: Sequence[float] = ()
) -> Nodes:
    """Nodes for a field point, or for waves."""
    last = beyond[-1] if beyond else 1.0
    places = [np.asarray(np.linspace(0.0, 1.0, parts + 1), dtype=np.float64)]
    if kinked:
        away = np.asarray(0.5 ** np.arange(2, _KINKS), dtype=np.float64)
        places += [away, 1 - away]
    sharp = min(radius, last)
    offsets = np.concatenate([*places, beyond]) - sharp
    if radius < 2 * last:
        least = max(near, radius - last, LEAST) / 2
        steps = least * 2.0 ** np.arange(int(np.ceil(np.log2(max(1.0, sharp) / least))) + 1)
        offsets = np.concatenate([offsets, [0.0], steps, -steps])
    ends = np.unique(offsets)
    ends = ends[(ends >= -sharp) & (ends <= last - sharp)]
    x, w = _gauss()
    half = np.diff(ends)[:, None] / 2
    offset = (ends[:-1, None] + half * (1 + x)).ravel()
    return Nodes(sharp + offset, (half * w).ravel(), offset + (sharp - radius))


def parts(phases: Array) -> int:
    """Number of panels for waves of phases up to the largest of these."""
    return int(np.max(phases) / _PANEL) + 4


def waves(
    rates: ComplexArray, depth: Array, radius: float, at: Nodes, orders: int, *, potentials: bool = False
) -> tuple[ComplexArray, ComplexArray]:
    """int exp(-k m z) J_n(kr) k cos(kb) dk and the same of sin(kb), n = 0 .. orders - 1; (n, rate, depth, b) each."""
    fall = (rates[:, None] * depth)[..., None]
    far = radius + at.b
    before = _powers(fall - 1j * at.b, (fall - 1j * at.beside) * (fall - 1j * far), radius, orders, potentials)
    after = _powers(fall + 1j * at.b, (fall + 1j * at.beside) * (fall + 1j * far), radius, orders, potentials)
    return (before + after) / 2, (before - after) / 2j


def _powers(s: ComplexArray, square: ComplexArray, r: float, orders: int, potentials: bool) -> ComplexArray:
    """int exp(-k s) J_n(kr) k dk = u^n (n R + s) / R^3, R^2 = s^2 + r^2, u = r / (R + s); (n, ...).

    Of potentials int exp(-k s) J_n(kr) dk = u^n / R.
    """
    R = np.sqrt(square)
    u, inverse = r / (R + s), 1 / R
    out: ComplexArray = np.empty((orders, *s.shape), np.complex128)
    power: ComplexArray = np.array(inverse) if potentials else np.square(inverse, dtype=np.complex128)
    for n in range(orders):
        out[n] = power if potentials else power * (n + s * inverse)
        power = power * u
    return out
