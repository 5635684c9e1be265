"""Bessel functions of many orders, and Hankel integrals of half-spaces in closed form below a density (points, 7)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import j0, j1

from approximation.arrays import blocks
from approximation.chebyshev import legendre_rule
from solver.arrays import Array, ComplexArray

_ORDERS_ABOVE = 24  # orders above the highest one at which the ratios begin: their error dies out on the way down
_SMALL = 0.1  # argument below which series avoid cancellation
_VALUES_AT_ONCE = 400_000  # values of all orders held at once


def even_orders(z: Array, count: int) -> Array:
    """Return j_2n(z) for n = 0 .. count - 1 at z > 0; (count, ...)."""
    flat = z.ravel()
    orders: Array = np.empty((count, flat.size))
    step = max(_VALUES_AT_ONCE // (2 * count), 1)
    for block in blocks(flat.size, step):
        orders[:, block] = _orders(flat[block], 2 * count - 2)[::2]
    return orders.reshape(count, *z.shape)


def bessel_orders(k: Array, x: Array, count: int) -> Array:
    """Return J_n(kx), n = 0 .. count - 1 of 3 or 4, to rounding of their largest values; (count, k, x)."""
    distance, inverse = np.unique(np.abs(x), return_inverse=True)
    z = k[:, None] * distance
    is_small, divisor = z < _SMALL, np.maximum(z, _SMALL)
    orders = [j0(z), j1(z)]
    orders.append(np.where(is_small, z**2 / 8 * (1 - z**2 / 12 + z**4 / 384), 2 / divisor * orders[1] - orders[0]))
    if count > 3:
        orders.append(np.where(is_small, z**3 / 48 * (1 - z**2 / 16 + z**4 / 640), 4 / divisor * orders[2] - orders[1]))
    at_places = np.stack(orders)[:, :, inverse]
    at_places[1::2] *= np.sign(x)
    return np.asarray(at_places)


def _orders(z: Array, highest: int) -> Array:
    """Spherical Bessel functions j_0 .. j_highest by recurrence up to n = z, by ratios beyond; (highest + 1, z)."""
    ratios = _ratios(z, highest)
    orders: Array = np.empty((highest + 1, z.size))
    previous, orders[0] = np.cos(z) / z, np.sinc(z / np.pi)
    for n in range(highest):
        upward = (2 * n + 1) / z * orders[n] - previous
        previous = orders[n]
        orders[n + 1] = np.where(z > n + 1, upward, orders[n] * ratios[n + 1])
    return orders


def _ratios(z: Array, highest: int) -> Array:
    """Ratios j_n / j_(n-1), valid where n > z; (highest + 1, z)."""
    ratios: Array = np.zeros((highest + 1, z.size))
    if np.min(z, initial=np.inf) >= highest:
        return ratios
    ratio = np.zeros_like(z)
    for n in range(highest + _ORDERS_ABOVE + int(2 * highest ** (1 / 3)), 0, -1):
        # j_(n-1) + j_(n+1) = (2 n + 1) / z j_n; ratios below the order z are not used
        ratio = np.minimum(z / np.maximum(2 * n + 1 - z * ratio, 1.0), 1.0)
        if n <= highest:
            ratios[n] = ratio
    return ratios


_PANEL_COUNT = 14  # per panel; a panel is as long as its distance from the nearest singularity
_KINKS = 14  # halvings of panels towards the kink of a cone's density at b = 0 and friction's steep end at b = 1
_PANEL = 8.0  # phase of a panel in b
#: Largest depth over a from which fields are extrapolated to the surface, and its share of the distance to the nearest
#: singular place: sums over b cancel to their depth, so that rounding grows as its inverse.
LEAST, _SHARE = 1e-3, 0.003
_FLOOR = 1e-12  # depth over a at the edge itself


def least_depth(distance: float) -> float:
    """Return the depth over a from which fields at a distance over a from the nearest singular place are summed."""
    return max(min(LEAST, _SHARE * distance), _FLOOR)


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes of panels in b, on 0 to 1 or beyond; (node,) each."""

    b: Array
    weights: Array
    offset: Array  # b - r, to its own digits near the sharp place


def nodes(
    radius: float = np.inf, near: float = 1.0, *, parts: int = 4, kinked: bool = False, beyond: Sequence[float] = ()
) -> Nodes:
    """Return nodes in b for a field point at ``radius`` and depth ``near``, or for waves."""
    last = beyond[-1] if beyond else 1.0
    breaks = [np.asarray(np.linspace(0.0, 1.0, parts + 1), dtype=np.float64)]
    if kinked:
        kinks = np.asarray(0.5 ** np.arange(2, _KINKS), dtype=np.float64)
        breaks += [kinks, 1 - kinks]
    sharp = min(radius, last)
    offsets = np.concatenate([*breaks, beyond]) - sharp
    if radius < 2 * last:  # integrands are sharp near b = r, where panels shrink with the depth
        least = max(near, radius - last) / 2
        steps = least * 2.0 ** np.arange(int(np.ceil(np.log2(max(1.0, sharp) / least))) + 1)
        offsets = np.concatenate([offsets, [0.0], steps, -steps])
    ends = np.unique(offsets)
    ends = ends[(ends >= -sharp) & (ends <= last - sharp)]
    gauss, gauss_weights = legendre_rule(_PANEL_COUNT)
    half = np.diff(ends)[:, None] / 2
    offset = (ends[:-1, None] + half * (1 + gauss)).ravel()
    return Nodes(sharp + offset, (half * gauss_weights).ravel(), offset + (sharp - radius))


def parts(phases: Array) -> int:
    """Number of panels for waves of phases up to the largest of these."""
    return int(np.max(phases) / _PANEL) + 4


def waves(
    rates: ComplexArray, depth: Array, radius: float, nodes_in_b: Nodes, orders: int, *, potentials: bool = False
) -> tuple[ComplexArray, ComplexArray]:
    """Return int exp(-k m z) J_n(kr) k cos(kb) dk, and with sin(kb), n < orders; (n, rate, depth, b) each."""
    b, offset, decay = nodes_in_b.b, nodes_in_b.offset, (rates[:, None] * depth)[..., None]
    before, after = (
        _integrals(decay + i * b, (decay + i * offset) * (decay + i * (radius + b)), radius, orders, potentials)
        for i in (-1j, 1j)
    )
    return (before + after) / 2, (before - after) / 2j


def _integrals(s: ComplexArray, square: ComplexArray, r: float, orders: int, potentials: bool) -> ComplexArray:
    """Return int exp(-k s) J_n(kr) k dk (P7.3) from s and R^2 = s^2 + r^2, for potentials without k; (n, ...)."""
    R = np.sqrt(square)
    u, inverse = r / (R + s), 1 / R
    out: ComplexArray = np.empty((orders, *s.shape), np.complex128)
    power: ComplexArray = np.array(inverse) if potentials else np.square(inverse, dtype=np.complex128)
    for n in range(orders):
        out[n] = power if potentials else power * (n + s * inverse)
        power = power * u
    return out
