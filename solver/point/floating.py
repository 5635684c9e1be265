"""Discs on a bare level within a stack, read one by one while their neighbours float (films, section 11).

At the level q = q0 + K phi: q0 of the contact where it is all at zero volts, K(k) > 0 of the layers. Beside the discs
there is no charge, so that phi = K^-1 (q - q0) of what is on them. With charges whose transforms are j_l(kb) cos(m a)
and sin(m a), l = m + 2n, as a disc's own edges ask for,

    sum_b (K^-1 f_a, f_b) c_b = V of its disc for a charge in all, else 0,    C_ij = charge of i per volt of j,

and the disc that is read collects int q0 phi d2x, phi the potential of a volt on it while the others have no charge.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import erfc, jv, spherical_jn

from approximation.arrays import Indices
from solver.arrays import Array, ComplexArray
from solver.stack.floating import Patches, stiffness
from solver.stack.layers import Stack, StackError
from solver.stack.wavenumbers import wavenumbers

_MOST = 2  # discs that float on each side: 25 in all
_NEAR, _SMALL, _LARGE = 0.25, 0.02, 30.0  # gap over disc; disc over what is beside it
_ORDERS, _APART = 8, 6.0  # m at most, and what of it falls off with the distance of discs
_DEGREES, _WIDE = 8, 3.0  # l beyond m, and what the size of discs over what is beside adds
_END, _SLOPE = 72.0, 12.0  # k times the gap where waves end, and the width of that: e^-36 of it is left
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_TURN, _FIRST, _GROWTH = 12.0, 0.5, 0.3  # phase and length of panels, and their growth
_KEPT = 64


@dataclass(frozen=True, eq=False)
class Discs(Patches):
    """(2 n + 1)^2 discs in a square: n float on each side of the one that is read, along x and across it."""

    def __post_init__(self) -> None:
        if self.floating > _MOST:
            raise StackError(f"floating_neighbours: {self.floating} of discs; must be at most {_MOST}, 25 discs in all")
        if self.floating and self.pitch < (1 + _NEAR) * self.size:
            raise StackError(
                f"patch_pitch: {self.pitch / self.size:.3g} times patch_size; of discs that float it must be at least "
                f"{1 + _NEAR:g} times"
            )
        if not _SMALL <= self.size / self._width <= _LARGE:
            raise StackError(
                f"patch_size: {self.size / self._width:.3g} times what is beside the electrode; "
                f"of discs that float it must be {_SMALL:g} to {_LARGE:g} times"
            )

    @cached_property
    def places(self) -> Array:
        """Middles of the discs, that which is read at zero; (disc, 2)."""
        line = self.pitch * np.arange(-self.floating, self.floating + 1)
        return np.stack(np.meshgrid(line, line, indexing="ij"), -1).reshape(-1, 2)

    @property
    def _orders(self) -> int:
        """Largest m: what discs do to each other falls off with their distance."""
        if not self.floating:
            return 0
        apart = np.log(2 * self.pitch / self.size - 1) + (self.pitch - self.size) / self._width
        return min(_ORDERS, 1 + int(_APART / apart))

    @property
    def _degree(self) -> int:
        """Largest l."""
        return self._orders + _DEGREES + int(_WIDE * self.size / self._width)

    @cached_property
    def terms(self) -> tuple[Indices, Indices, Indices]:
        """l, m, and 0 of a cosine or 1 of a sine, of a disc's charges; the first is the one with a charge in all."""
        found = [
            (degree, m, sine)
            for m in range(self._orders + 1)
            for degree in range(m, self._degree + 1, 2)
            for sine in range(1 + (m > 0))
        ]
        degree, m, sine = np.array(found).T
        return degree, m, sine

    def _compliance(self, k: Array) -> tuple[Array, float]:
        """k over K, and its limit at large k."""
        over_k, limit = stiffness(self.stack, self.number, k)
        return 1 / over_k, 1 / limit

    def _own(self) -> Array:
        """Of one disc: int j_l j_l' k/K dk for l, l' of like parity; (l, l')."""
        b = self.size / 2
        k, weights = wavenumbers(self.stack, self.size, self._width)
        R, limit = self._compliance(k)
        j = _bessel(k * b, self._degree)
        return (j * (weights * (R - limit))) @ j.T + np.diag(limit * np.pi / 2 / b / (2 * np.arange(len(j)) + 1))

    @cached_property
    def _energy(self) -> Array:
        """(K^-1 f_a, f_b) times 2 pi, symmetric and positive; (disc, term, disc, term)."""
        degree, m, sine = self.terms
        count, own = len(self.places), self._own()
        whole = np.zeros((count, degree.size, count, degree.size))
        alike = (m[:, None] == m) & (sine[:, None] == sine)
        single = np.where(alike, own[degree[:, None], degree] * np.where(m > 0, 0.5, 1.0), 0.0)
        whole[np.arange(count), :, np.arange(count)] = single
        if count == 1:
            return whole
        k, weights = _panels(self.pitch - self.size, self.size + 2 * np.sqrt(2) * self.floating * self.pitch)
        j = _bessel(k * self.size / 2, self._degree)
        R = self._compliance(k)[0] * weights
        orders, pairs = np.arange(2 * self._orders + 1), np.einsum("ak,bk->abk", j, j).reshape(-1, k.size)
        for step in np.unique(np.round((self.places[:, None] - self.places).reshape(-1, 2) / self.pitch), axis=0):
            distance, angle = float(np.hypot(*step)) * self.pitch, float(np.arctan2(step[1], step[0]))
            if distance == 0:
                continue
            waves = jv(orders[:, None], k * distance) * R
            table = (pairs @ waves.T).reshape(len(j), len(j), orders.size)
            block = _coupled(table, degree, m, sine, angle)
            away = np.round((self.places - self.places[:, None]) / self.pitch)
            for a, b in np.argwhere((away == step).all(-1)):
                whole[a, :, b] = block
        return whole

    @cached_property
    def charges(self) -> Array:
        """Sizes of the charges per voltage of each disc; (disc . term, disc)."""
        count, size = len(self.places), self.terms[0].size
        whole = self._energy.reshape(count * size, -1) / (2 * np.pi)
        unit = np.zeros((count * size, count))
        unit[size * np.arange(count), np.arange(count)] = 1.0
        return np.asarray(cho_solve(cho_factor((whole + whole.T) / 2), unit))

    @cached_property
    def matrix(self) -> Array:
        """Charges per voltages of the discs [F / stack units], symmetric and positive definite; (disc, disc)."""
        found = self.charges[:: self.terms[0].size]
        return np.asarray(found + found.T) / 2

    def wave(self, k: Array, distance: Array, *, slope: bool) -> Array:
        """What reads charges q0(k) that are even about a point, or its derivative by the distance; (case, k)."""
        degree, m, sine = self.terms
        sizes = (self.charges @ self.voltages).reshape(len(self.places), -1)
        j, out = _bessel(k * self.size / 2, self._degree), np.zeros((distance.size, k.size))
        for place, own in zip(self.places, sizes, strict=True):
            sums: ComplexArray = np.zeros((self._orders + 1, k.size), np.complex128)
            np.add.at(sums, m, (own * np.where(sine, -1j, 1.0))[:, None] * j[degree])
            away = -distance - place[0]
            r, turn = np.hypot(away, place[1]), np.exp(1j * np.arctan2(-place[1], away))
            waves = _waves(k * r[:, None], turn, self._orders + 1)
            if slope:  # by minus x: d/dx J_m exp(i m a) = k/2 (that of m - 1 less that of m + 1)
                below = np.concatenate([-np.conj(waves[1:2]), waves[: self._orders]])
                out += np.einsum("mk,mck->ck", sums, -k / 2 * (below - waves[1:])).real
            else:
                out += np.einsum("mk,mck->ck", sums, waves[:-1]).real
        return out * self._compliance(k)[0] / (2 * np.pi)


@lru_cache(_KEPT)
def discs(stack: Stack, number: int, size: float, pitch: float, floating: int) -> Discs:
    """Kept: what they are found from does not depend on the contact."""
    return Discs(stack, number, size, pitch, floating)


def _bessel(x: Array, degree: int) -> Array:
    """j_l(x) of all degrees; (l, ...)."""
    return np.asarray(spherical_jn(np.arange(degree + 1)[:, None], x))


def _waves(x: Array, turn: ComplexArray, most: int) -> ComplexArray:
    """J_m(x) exp(i m a) of m from 0; (m, case, k)."""
    return np.stack([jv(m, x) * turn[:, None] ** m for m in range(most + 1)])


def _panels(gap: float, farthest: float) -> tuple[Array, Array]:
    """Nodes and weights in k of what turns by a phase up to k times the farthest, and ends smoothly for the gap."""
    edges, last = [0.0], (_END + 3 * _SLOPE) / gap
    while edges[-1] < last:
        edges.append(edges[-1] + min(_TURN / farthest, max(_FIRST, _GROWTH * edges[-1])))
    low, length = np.array(edges[:-1]), np.diff(edges)
    k = (low[:, None] + length[:, None] * (1 + _NODES) / 2).ravel()
    ended = erfc((k * gap - _END) / _SLOPE) / 2
    return k, (length[:, None] * _WEIGHTS / 2).ravel() * ended


def _coupled(table: Array, degree: Indices, m: Indices, sine: Indices, angle: float) -> Array:
    """(K^-1 f_a, f_b) of two discs times 2 pi, by int j_l j_l' J_p k/K dk; the second lies at an angle from the first.

    The angle of waves is integrated over by exp(-iz cos) = sum (-i)^p J_p(z) exp(ip ...), of the products of two
    trigonometric functions over their sum and their difference.
    """
    a, b = m[:, None], m[None]
    total, less = a + b, np.abs(a - b)
    of_sum = (-1.0) ** b * table[degree[:, None], degree[None], total]
    of_less = np.where(a >= b, 1.0, (-1.0) ** (a + b)) * table[degree[:, None], degree[None], less]
    sine_a, sine_b = sine[:, None], sine[None]
    turned, back = total * angle, (a - b) * angle
    both = np.where(sine_a == sine_b, np.cos(back), np.sin(np.where(sine_a, back, -back)))
    sums = np.where(sine_a == sine_b, np.where(sine_a, -1.0, 1.0) * np.cos(turned), np.sin(turned))
    return np.asarray((of_less * both + of_sum * sums) / 2)
