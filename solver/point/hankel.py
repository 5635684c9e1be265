"""Hankel integrals of half-spaces in closed form below a density, up to the surface (points, 7).

What a contact's tractions are in Fourier space is a density on 0 <= b <= 1, lengths over a, as of a line contact:

    t(k) = int_0^1 phi(b) cos(kb) db  without friction,    t_1(k) = int_0^1 psi(b) sin(kb) db  of its cos(angle) part.

A wave of the rate m then needs int t(k) exp(-k m z) J_n(kr) k dk: a sum over b of a closed function of m z -+ ib. It is
sharp beside b = r near the surface, where panels in b shrink with the depth.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from solver.arrays import Array, ComplexArray

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
