"""The parts of a graded film's kernels that are not smooth, applied to the basis exactly (films, section 7).

What decays like k^-j in Fourier space is, in x, a multiple of

    K_oo:  -Y1/2 sgn x + Y2/pi x log|x| + Y3/4 x|x|,     K_ox:  Y1/pi log|x| + Y2/2 |x| - Y3/(2 pi) x^2 log|x|

and a smooth rest. Integrals of the basis times sgn(X - S) and log|X - S| are closed, their products with X - S follow
from the recurrences of the basis. These parts are projected, not collocated: a double exponential rule takes any
exponent at the edges.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebvander
from scipy.special import betainc

from approximation.chebyshev import coefficients, gauss_points
from solver.arrays import Array
from solver.line.basis import Basis, double_exponential, jacobi

#: Types of integrals: sgn, its product with (X - S) and (X - S)^2; the same of log; the same of 1.
SIGN, LOG, PLAIN = 0, 3, 6


@dataclass(frozen=True, eq=False)
class Rough:
    """Integrals of the basis, projected and at the edges."""

    basis: Basis

    @cached_property
    def _rule(self) -> tuple[Array, Array, Array, Array]:
        """X, 1 - X, 1 + X and weights of a double exponential rule on [-1, 1]."""
        A, B = self.basis.exponents
        return double_exponential(min(1 - A, 1 - B, 1 + A, 1 + B), 301 + 8 * self.basis.terms)

    @cached_property
    def projected(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Coefficients in P^(-A,-B) and in U, of the pressure's terms and of a field's; (type, M, term) each.

        Behind the M coefficients in U stand the sums of all, M and beyond, at X = 1 and at X = -1 with the signs of
        T_n there: integrals with sqrt((1 +- X) / (1 -+ X)) / pi.
        """
        X, to_trailing, to_leading, weights = self._rule
        basis = self.basis
        A, B = basis.exponents
        dual = basis.dual(X, basis.terms) * (weights * to_trailing**-A * to_leading**-B) / basis.dual_norms[:, None]
        angle = 2 * np.arctan2(np.sqrt(to_trailing), np.sqrt(to_leading))
        orders = np.arange(1, basis.terms + 1)[:, None]
        whole = np.stack([1 / np.tan(angle / 2), -np.tan(angle / 2)]) / 2  # sums of sin(n angle), with the signs
        series = 2 / np.pi * np.concatenate([np.sin(orders * angle), whole]) * weights  # U_(n-1) sqrt(1 - X^2)
        pressed, charged = self.pressures(X, to_trailing, to_leading), self.charges(to_trailing, to_leading)
        return (dual @ pressed, series @ pressed), (dual @ charged, series @ charged)

    def at(self, X: Array) -> tuple[Array, Array]:
        """Integrals at points on either side of the edges; (type, point, term), of the pressure and of a field."""
        inside = np.abs(X) <= 1
        within, beyond = X[inside], X[~inside]
        closed = self.pressures(within, 1 - within, 1 + within), self.charges(1 - within, 1 + within)
        S, to_trailing, to_leading, weights = self._rule
        A, B = self.basis.exponents
        angle = 2 * np.arctan2(np.sqrt(to_trailing), np.sqrt(to_leading))[:, None]
        terms = (
            (weights * to_trailing**A * to_leading**B)[:, None] * self.basis.pressure_factor(S),
            (weights / np.sqrt(to_trailing * to_leading))[:, None] * np.cos(angle * np.arange(self.basis.terms + 1)),
        )
        distance = np.where(beyond[:, None] > 0, beyond[:, None] - 1 + to_trailing, beyond[:, None] + 1 - to_leading)
        functions = np.array([np.sign(distance), np.log(np.abs(distance)), np.ones_like(distance)])
        parts = []
        for values, rule in zip(closed, terms, strict=True):
            whole = np.empty((9, X.size, rule.shape[1]))
            whole[:, inside] = values
            for kind, power in np.ndindex(3, 3):
                whole[3 * kind + power, ~inside] = (functions[kind] * distance**power) @ rule
            parts.append(whole)
        return parts[0], parts[1]

    def pressures(self, X: Array, to_trailing: Array, to_leading: Array) -> Array:
        """Integrals of w P_j; (type, point, pressures).

        X, to_trailing, to_leading: (point,), points, and 1 - X and 1 + X of them.
        """
        A, B = self.basis.exponents
        count = self.basis.pressures + 2
        j = np.arange(1, count)
        sign = np.empty((X.size, count))
        sign[:, 0] = self.basis.total * (2 * betainc(B + 1, A + 1, to_leading / 2) - 1)
        edge = (to_trailing ** (A + 1) * to_leading ** (B + 1))[:, None]
        sign[:, 1:] = -edge * jacobi(count - 1, A + 1, B + 1, X) / j
        # d/dX int w P_j log|X - S| = pi tan(theta) w P_j + pi gain P_(j+k0)^(-A,-B)
        tan = np.tan(np.pi * self.basis.delta)
        log = np.pi / 2 * tan * sign + self._smooth_logs(X, count, tan)
        shift = _multiplication(count, A, B)
        return self._by_distance(X, sign, log, self.basis.total, shift)[..., : self.basis.pressures]

    def _smooth_logs(self, X: Array, count: int, tan: float) -> Array:
        """The polynomial part of the logarithmic integrals, with its constants from X = 1; (X, count)."""
        A, B = self.basis.exponents
        size = count + 2
        dual = jacobi(count + 1, -A, -B, gauss_points(size))
        order = self.basis.order
        local = dual[:, order : order + count] if order >= 0 else np.concatenate([0 * dual[:, :1], dual], 1)[:, :count]
        series = chebint(np.pi * self.basis.gain * coefficients(local))
        values = chebvander(X, size) @ series
        at_one = np.sum(series, 0)  # T_n(1) = 1
        S, to_trailing, to_leading, weights = self._rule
        exact = (weights * to_trailing**A * to_leading**B * np.log(to_trailing)) @ jacobi(count, A, B, S)
        moments = np.zeros(count)
        moments[0] = self.basis.total
        return np.asarray(values + (exact - np.pi / 2 * tan * moments - at_one))

    def charges(self, to_trailing: Array, to_leading: Array) -> Array:
        """Integrals of T_n / sqrt(1 - X^2); (type, point, M + 1).

        to_trailing, to_leading: (point,), 1 - X and 1 + X of points.
        """
        count = self.basis.terms + 3
        angle = 2 * np.arctan2(np.sqrt(to_trailing), np.sqrt(to_leading))[:, None]
        n = np.arange(1, count)
        sign = np.concatenate([np.pi - 2 * angle, -2 / n * np.sin(n * angle)], 1)
        log = np.concatenate([np.full_like(angle, -np.pi * np.log(2)), -np.pi / n * np.cos(n * angle)], 1)
        shift = (np.eye(count, k=1) + np.eye(count, k=-1)) / 2
        shift[0, 1] = 1.0
        return self._by_distance(np.cos(angle[:, 0]), sign, log, np.pi, shift)[..., : self.basis.terms + 1]

    @staticmethod
    def _by_distance(X: Array, sign: Array, log: Array, total: float, shift: Array) -> Array:
        """All types from integrals F_j of a kernel: that of X - S times it is X F_j - sum_l shift_jl F_l."""
        plain = np.zeros_like(sign)
        plain[:, 0] = total
        parts = []
        for kernel in (sign, log, plain):
            first = X[:, None] * kernel - kernel @ shift.T
            parts += [kernel, first, X[:, None] * first - first @ shift.T]
        return np.array(parts)


def weights(tails: Array, friction: float, carried: Array, half_lengths: Array) -> Array:
    """Shares of the types in du/dx of (y, phi, psi, x); (half, 4, type)."""
    shear = friction * carried[0]
    odd = np.concatenate([tails[:, 1:, 1:] @ carried, tails[:, :1, 0] * shear], 1)
    even = np.concatenate([tails[:, 1:, 0] * shear, -(tails[:, 1:, 0] @ carried)[:, None]], 1)
    h = half_lengths[:, None]
    logarithm = np.log(h)
    out = np.empty((half_lengths.size, 4, 9))
    out[..., SIGN] = -odd[0] / 2
    out[..., SIGN + 1] = h * even[1] / 2
    out[..., SIGN + 2] = h**2 * odd[2] / 4
    out[..., LOG] = even[0] / np.pi + 0 * h
    out[..., LOG + 1] = h * odd[1] / np.pi
    out[..., LOG + 2] = -(h**2) * even[2] / (2 * np.pi)
    out[..., PLAIN:] = logarithm[..., None] * out[..., LOG:PLAIN]
    return out * h[..., None]


def _multiplication(count: int, a: float, b: float) -> Array:
    """S P_j = sum_l shift_jl P_l^(a,b); (count, count), the last row cut."""
    shift = np.zeros((count, count))
    shift[0, :2] = 1 - 2 * (a + 1) / (a + b + 2), 2 / (a + b + 2)
    for j in range(1, count):
        t = 2 * j + a + b
        above = 2 * (j + 1) * (j + a + b + 1) * t
        slope, bias = t * (t + 1) * (t + 2) / above, (t + 1) * (a * a - b * b) / above
        shift[j, j - 1], shift[j, j] = 2 * (j + a) * (j + b) * (t + 2) / above / slope, -bias / slope
        if j + 1 < count:
            shift[j, j + 1] = 1 / slope
    return shift
