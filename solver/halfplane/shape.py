"""The pressure S under a punch of polynomial slope, its follower D and their transforms (theory, sections 4 and 5).

S = lam sigma_yy solves ``tan(theta) S + H[S] = G`` on |X| < 1. D is the charge that friction moves on a conductor:
``H[D] = -S``, without a total (the terms in lam/kap of theory, 3.4). With m, n = 1 at a smooth trailing, leading edge
and 0 at a corner, ``E(z) = ((z - 1)/(z + 1))^delta`` and ``V = (z - 1)^m (z + 1)^n Q``, Q a polynomial,

    S = cos(theta) (1 - X)^A (1 + X)^B Q(X),    A = m - 1/2 + delta,    B = n - 1/2 - delta,
    D sqrt(1 - X^2) = H[sqrt(1 - s^2) S] = (-1)^m [cos(theta) E V - Pol(E V)] / tan(theta).

S sqrt(1 - X^2) is E V up to sign; the transforms are the negative part of E V at infinity. ``E = 1 + delta Phi`` avoids
a division by theta. In ``u = z - sqrt(z^2 - 1)`` (|u| < 1 off the contact) E is ``((1 - u)/(1 + u))^(2 delta)``, V a
Laurent polynomial, and the negative part a power series in u without a constant.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import scipy  # scipy.special, slow to import, and not every job solves

from solver.arrays import Array, Points, dot, power_series, stack
from solver.halfplane.sliding import FrictionAngle

_FAR = 0.3  # |u| below which the series is used; above it the closed form loses less than (1/u)^(degree + 2)
_TERMS = 32  # 0.3^32 is below rounding


@dataclass(frozen=True, eq=False)
class Shape:
    """Functions S and D, their moments and transforms, dimensionless and linear in ``factor``."""

    angle: FrictionAngle
    smooth: tuple[bool, bool]  # Whether the trailing and the leading edge are smooth
    factor: Array  # Coefficients of Q, ascending powers of X; (..., degree + 1)

    @classmethod
    def of_slope(cls, angle: FrictionAngle, smooth: tuple[bool, bool], slope: Sequence[Array]) -> "Shape":
        """Return the shape under a slope G, by its coefficients (...); between two corners the one without a total."""
        power = sum(smooth) - 1  # A + B; between two smooth edges the shape exists only where imbalance() is 0
        series = _edge_series(angle.delta, smooth, len(slope) + 1)
        terms = [_coefficient(slope, series, j + power) for j in range(max(len(slope) - power, 1))]
        shape = cls(angle, smooth, (-1.0 if smooth[0] else 1.0) * stack(*terms))
        if any(smooth):
            return shape
        factor = np.array(shape.factor)
        factor[..., 0] -= shape.total / cls(angle, smooth, np.ones(1)).total
        return cls(angle, smooth, factor)

    @property
    def _sign(self) -> float:
        """Sign (-1)^m."""
        return -1.0 if self.smooth[0] else 1.0

    @cached_property
    def _power(self) -> Array:
        """Coefficients of V in powers of z; (..., degree + m + n + 1)."""
        power = self.factor
        for corner, smooth in zip((-1.0, 1.0), self.smooth, strict=True):
            if smooth:
                zero = np.zeros((*power.shape[:-1], 1))
                power = corner * np.append(power, zero, -1) + np.append(zero, power, -1)
        return power

    @cached_property
    def _chebyshev(self) -> Array:
        """Coefficients of V in Chebyshev polynomials (u^j + u^-j)/2; (..., degree + m + n + 1)."""
        return np.asarray(self._power @ chebyshev_of_powers(self._power.shape[-1]))

    def _laurent(self, numbers: range) -> Array:
        """Coefficients of u^k in V Phi for k in ``numbers``; (..., number)."""
        c, delta = self._chebyshev, self.angle.delta
        degree = c.shape[-1] - 1
        phi = [2 * term for term in _phi_series(2 * delta, max(numbers) + degree + 1)]  # of Phi in powers of u
        two_sided = {j: (0.5 if j else 1.0) * c[..., abs(j)] for j in range(-degree, degree + 1)}
        sums = [sum((two_sided[j] * phi[k - j] for j in two_sided if k > j), np.zeros(())) for k in numbers]
        return stack(*sums)

    @cached_property
    def _head(self) -> Array:
        """Coefficients of u^-k in V Phi from k = 0; (..., term)."""
        return self._laurent(range(0, -max(self._chebyshev.shape[-1] - 1, 1), -1))

    @cached_property
    def _tail(self) -> Array:
        """Coefficients of u^k in V Phi from k = 1; (..., term)."""
        return self._laurent(range(1, _TERMS + 1))

    @cached_property
    def total(self) -> Array:
        """Integral of S over -1 < X < 1; (...)."""
        return np.asarray(self._sign * np.pi * (self._chebyshev[..., 0] + self.angle.delta * self._head[..., 0]))

    @cached_property
    def first_moment(self) -> Array:
        """Integral of X S over -1 < X < 1; (...)."""
        head, tail = self._head, self._tail
        first = self._chebyshev[..., 1] if self._chebyshev.shape[-1] > 1 else 0.0
        mirrored = head[..., 1] if head.shape[-1] > 1 else 0.0
        return np.asarray(self._sign * np.pi / 2 * (first + self.angle.delta * (tail[..., 0] + mirrored)))

    @cached_property
    def logarithmic_moment(self) -> Array:
        """Integral of S [log(1 - X) + log 2]; (...)."""
        # The moments of w = (1 - X)^A (1 + X)^B obey a recursion in the power of X; its derivative by A is that of the
        # moments with the logarithm, which start from the beta function.
        (m, n), delta = self.smooth, self.angle.delta
        power, skew = m + n - 1, n - m - 2 * delta  # A + B, B - A
        start = np.pi * min(power + 2, 2) * (0.5 + delta if m else 1.0) * (0.5 - delta if n else 1.0)
        harmonic = (0.0, 1.0, 1.5)[power + 1]
        log_mean = delta * self.angle.digamma_difference + 2 - harmonic - (0.0 if m else 1 / (0.5 + delta))
        plain, logs = [start], [start * log_mean]
        for j in range(self.factor.shape[-1] - 1):
            before, log_before = (plain[j - 1], logs[j - 1]) if j else (0.0, 0.0)
            plain.append((skew * plain[j] + j * before) / (power + j + 2))
            logs.append((skew * logs[j] - plain[j] - plain[j + 1] + j * log_before) / (power + j + 2))
        return dot(self.factor, stack(*logs))

    @cached_property
    def follower_moment(self) -> Array:
        """Integral of D log(1 - X), which is pi int_1^inf H[D] dz, by recursion in the powers of z in V; (...)."""
        delta = self.angle.delta
        count = self._power.shape[-1]
        phi = _phi_series(delta, count)
        values = [-self.angle.digamma_difference - 4 / (1 + 2 * delta)]  # of int (z^j Phi - Pol) / sqrt(z^2 - 1)
        for j in range(count - 1):
            values.append((phi[j + 1] - 2 * delta * values[j] + (j * values[j - 1] if j else 0.0)) / (j + 1))
        return -np.pi * self._sign * self.angle.delta_over_tan * dot(self._power, stack(*values))

    def traction(self, X: Array) -> tuple[Array, Array]:
        """S and S sqrt(1 - X^2) at positions |X| < 1; (..., position)."""
        ratio = np.exp(-2 * self.angle.delta[..., None] * np.arctanh(X))
        scaled = self.angle.cos[..., None] * ratio * power_series(self.factor, X)
        root = np.sqrt((1 - X) * (1 + X))
        edges = self._edges(1 - X, 1 + X, root)
        return scaled * edges, scaled * (edges * root)

    def follower(self, X: Array) -> Array:
        """D sqrt(1 - X^2) at positions |X| < 1; (..., position)."""
        rho, root = self.angle.delta_over_tan[..., None], np.sqrt((1 - X) * (1 + X))
        slope = self.angle.log_cos_over_tan[..., None] - 2 * rho * np.arctanh(X)  # log(cos(theta) E) / tan(theta)
        pressed = self._edges(1 - X, 1 + X, root) * root * power_series(self.factor, X)
        return np.asarray(
            pressed * slope * scipy.special.exprel(slope * self.angle.tan[..., None])
            - self._sign * rho * self._polynomial_part(X)
        )

    def follower_at(self, edge: float) -> Array:
        """D sqrt(1 - X^2) at a smooth edge, X = 1 or -1; (...)."""
        return -self._sign * self.angle.delta_over_tan * self._polynomial_part(np.array([edge]))[..., 0]

    def _polynomial_part(self, X: Array) -> Array:
        """Pol(Phi V) at positions X; (..., position)."""
        head = np.array(self._head)
        head[..., 1:] *= 2
        return np.asarray(np.polynomial.chebyshev.chebval(X, np.moveaxis(head[..., None], -2, 0), tensor=False))

    def _edges(self, trailing: Points, leading: Points, root: Points) -> Points:
        """Distances from the edges to the powers m and n, over ``root``, the root of their product; (position,)."""
        if all(self.smooth):
            return root
        if not any(self.smooth):
            return 1 / root
        return (trailing if self.smooth[0] else leading) / root

    def transforms(self, z: Points, root: Points, slope: Array) -> tuple[Points, Points]:
        """H[S] and sqrt(z^2 - 1) H[D] at z (..., point) off the contact; (..., point) each."""
        delta, rho = self.angle.delta[..., None], self.angle.delta_over_tan[..., None]
        head, tail = self._head, self._tail
        u = 1 / (z + root)
        logarithm = np.log((z - 1) / (z + 1))
        phi = np.where(delta == 0, logarithm, np.expm1(delta * logarithm) / np.where(delta == 0, 1.0, delta))
        factor = self._edges(z - 1, z + 1, root) * power_series(self.factor, z)  # V / root
        pressure = power_series(slope, z) - self._sign * (1 + delta * phi) * factor
        negative = factor * root * phi - power_series(head, z + root)
        far = np.abs(u) < _FAR
        if np.any(any_far := far.any(axis=tuple(range(far.ndim - 1)))):
            small = np.where(far, u, 0)[..., any_far]
            series = small * power_series(tail, small)
            even = power_series(self._chebyshev, small) + delta * (series + power_series(head, small))
            pressure[..., any_far] = np.where(
                far[..., any_far], -self._sign * even / root[..., any_far], pressure[..., any_far]
            )
            negative[..., any_far] = np.where(far[..., any_far], series, negative[..., any_far])
        mirrored = power_series(head, u) - head[..., :1]
        return pressure, -self._sign * rho * (negative - mirrored)


@cache
def chebyshev_of_powers(count: int) -> Array:
    """Chebyshev coefficients of the powers 1 to X^(count - 1); (power, count)."""
    rows = [np.polynomial.chebyshev.poly2cheb(row) for row in np.eye(count)]
    return np.array([np.pad(row, (0, count - len(row))) for row in rows])


def imbalance(angle: FrictionAngle, slope: Sequence[Array]) -> Array:
    """Term in 1/z of G/X(z) (theory, section 4), 0 for two smooth edges in balance, by coefficients of G; (...)."""
    return _coefficient(slope, _edge_series(angle.delta, (True, True), len(slope)), 0)


def _edge_series(delta: Array, smooth: tuple[bool, bool], count: int) -> list[Array]:
    """Coefficients of (1 - t)^-A (1 + t)^-B in powers of t; (...) each."""
    m, n = smooth
    power, skew = m + n - 1, n - m - 2 * delta  # A + B, B - A
    series = [np.ones(()), -skew]
    for k in range(1, count - 1):
        series.append((-skew * series[k] + (k - 1 + power) * series[k - 1]) / (k + 1))
    return series


def _phi_series(delta: Array, count: int) -> list[Array]:
    """Coefficients of [((1 - t)/(1 + t))^delta - 1] / delta in powers of t; (...) each."""
    series = [np.zeros(()), np.array(-2.0)]
    for k in range(1, count - 1):
        series.append((-2 * delta * series[k] + (k - 1) * series[k - 1]) / (k + 1))
    return series


def _coefficient(slope: Sequence[Array], series: list[Array], shift: int) -> Array:
    """Sum over k of slope_k series_(k - shift); (...)."""
    terms = [slope[k] * series[k - shift] for k in range(len(slope)) if k >= shift]
    return np.asarray(sum(terms, np.zeros(())))
