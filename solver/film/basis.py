"""Basis of the tractions on the contact and the rules that project onto it (films, section 4).

    sigma_yy = w sum_j s_j P_j^(A,B)(X),   (D_y, B_y) = D1 sigma_yy + sum_n c_n T_n(X) / sqrt(1 - X^2),

w = (1 - X)^A (1 + X)^B, k0 = A + B. With tan(theta) = eta kap / lam and A = 1/2 + delta at a smooth trailing edge,

    (eta kap + lam H)[w P_j^(A,B)] = -(lam 2^k0 / sin(pi A)) P_(j+k0)^(-A,-B),    H[T_n / sqrt(1 - X^2)] = U_(n-1).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import beta, eval_chebyu, eval_jacobi, roots_jacobi

from solver.arrays import Array


@dataclass(frozen=True, eq=False)
class Basis:
    """Basis with exponents of one friction, and its rules; nothing here knows a length.

    Parameters
    ----------
    delta
        theta / pi of the friction angle, |delta| < 1/2.
    smooth
        Whether the trailing and the leading edge are smooth.
    terms
        M: number of collocation nodes.
    """

    delta: float
    smooth: tuple[bool, bool]
    terms: int

    @property
    def exponents(self) -> tuple[float, float]:
        """A and B."""
        return (0.5 if self.smooth[0] else -0.5) + self.delta, (0.5 if self.smooth[1] else -0.5) - self.delta

    @property
    def order(self) -> int:
        """k0 = A + B: 1 between smooth edges, 0 with one corner, -1 between corners."""
        return sum(self.smooth) - 1

    @property
    def pressures(self) -> int:
        """Number of terms of the pressure."""
        return self.terms - self.order

    @property
    def gain(self) -> float:
        """2^k0 / sin(pi A)."""
        return float(2.0**self.order / np.sin(np.pi * self.exponents[0]))

    @cached_property
    def nodes(self) -> Array:
        """Collocation nodes X: Gauss-Jacobi of weight (-A, -B); (M,)."""
        return self._dual_rule[0]

    @cached_property
    def _dual_rule(self) -> tuple[Array, Array]:
        A, B = self.exponents
        return _gauss_jacobi(self.terms, -A, -B)

    @cached_property
    def projection(self) -> Array:
        """From values at the nodes to coefficients in P^(-A,-B), by the Gauss rule itself; (M, M)."""
        X, weights = self._dual_rule
        P = self.dual(X, self.terms) * weights
        return np.asarray(P / (P @ self.dual(X, self.terms).T).diagonal()[:, None])

    @cached_property
    def charge_projection(self) -> Array:
        """From values at the nodes to coefficients in U of the interpolating polynomial; (M, M)."""
        angle = np.pi * np.arange(1, self.terms + 1) / (self.terms + 1)
        orders = np.arange(1, self.terms + 1)
        to_series = 2 / (self.terms + 1) * np.sin(orders[:, None] * angle) * np.sin(angle)
        return np.asarray(to_series @ self.dual(np.cos(angle), self.terms).T @ self.projection)

    @cached_property
    def pressure_rule(self) -> tuple[Array, Array]:
        """Nodes S of weight w, and weights times P_j(S); (N,) and (N, pressures)."""
        S, weights = _gauss_jacobi(self.terms + 2, *self.exponents)
        return S, weights[:, None] * self.pressure_factor(S)

    @cached_property
    def charge_rule(self) -> tuple[Array, Array]:
        """Nodes S of weight 1/sqrt(1 - S^2), and weights times T_n(S); (N,) and (N, M + 1)."""
        count = self.terms + 2
        angle = np.pi * (np.arange(count) + 0.5) / count
        return np.cos(angle), np.pi / count * np.cos(angle[:, None] * np.arange(self.terms + 1))

    @cached_property
    def average_rule(self) -> tuple[Array, Array]:
        """Nodes and weights of the mean over the contact with weight (1 - X^2)^(3/2); (node,) each."""
        count = self.terms // 2 + 8
        X = np.cos(np.pi * np.arange(1, count + 1) / (count + 1))  # of weight sqrt(1 - X^2)
        return X, 8 / 3 * (1 - X**2) ** 2 / (count + 1)

    def pressure_factor(self, X: Array) -> Array:
        """P_j^(A,B); (X, pressures)."""
        return np.asarray(eval_jacobi(np.arange(self.pressures), *self.exponents, np.asarray(X)[..., None]))

    def dual(self, X: Array, count: int) -> Array:
        """P_j^(-A,-B), j < count; (count, X)."""
        A, B = self.exponents
        return np.asarray(eval_jacobi(np.arange(count)[:, None], -A, -B, X))

    def local(self, X: Array) -> Array:
        """The right side (2^k0 / sin pi A) P_(j+k0)^(-A,-B), P_(-1) = 0; (X, pressures)."""
        A, B = self.exponents
        orders = np.arange(self.pressures) + self.order
        values = eval_jacobi(np.maximum(orders, 0), -A, -B, np.asarray(X)[..., None])
        return np.asarray(self.gain * np.where(orders >= 0, values, 0.0))

    def weight(self, X: Array) -> Array:
        """w at |X| < 1."""
        A, B = self.exponents
        return np.asarray((1 - X) ** A * (1 + X) ** B)

    @property
    def total(self) -> float:
        """m0: integral of w."""
        A, B = self.exponents
        return float(2 ** (A + B + 1) * beta(A + 1, B + 1))

    @cached_property
    def first_moments(self) -> Array:
        """Integrals of X w P_j; (pressures,)."""
        S, rule = self.pressure_rule
        return np.asarray(S @ rule)

    @cached_property
    def sign_moments(self) -> Array:
        """Integrals of w P_j times the mean of sgn(X - S) / 2 over X; (pressures,): by a double exponential rule."""
        steps = np.linspace(-3.2, 3.2, 241 + 8 * self.terms)
        share = 1 / (1 + np.exp(-np.pi * np.sinh(steps)))
        A, B = self.exponents
        S, one, other = 2 * share - 1, 2 / (1 + np.exp(np.pi * np.sinh(steps))), 2 * share  # 1 - S, 1 + S
        weight = (steps[1] - steps[0]) * np.pi / 2 * np.cosh(steps) * one ** (A + 1) * other ** (B + 1)
        angle = np.arctan2(S, np.sqrt(one * other))
        mean = -(angle + 2 / 3 * np.sin(2 * angle) + np.sin(4 * angle) / 12) / np.pi
        return np.asarray((weight * mean) @ self.pressure_factor(S))


def _gauss_jacobi(count: int, one: float, other: float) -> tuple[Array, Array]:
    """Gauss's rule of weight (1 - X)^one (1 + X)^other."""
    with np.errstate(invalid="ignore"):  # SciPy divides 0 by 0 where one + other = -1, in a place that it then replaces
        X, weights = roots_jacobi(count, one, other)
    return X, weights


def log_mean(S: Array) -> Array:
    """Mean of log|X - S| over X with weight (1 - X^2)^(3/2) (films, section 5)."""
    return np.asarray(-np.log(2) + 2 / 3 * (2 * S**2 - 1) - (8 * S**4 - 8 * S**2 + 1) / 12)


def second_kind(X: Array, count: int) -> Array:
    """U_n, n < count; (X, count)."""
    return np.asarray(eval_chebyu(np.arange(count), np.asarray(X)[..., None]))
