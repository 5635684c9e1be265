"""Basis of the tractions on the contact, its Hilbert transforms and its projections (films, F4.1 and F4.2)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import beta, roots_jacobi

from solver.arrays import Array, Points
from solver.cache import cached

#: The closed transforms lose a factor exp(c), c = 2 M log of the ellipse through z; below this c (3 digits) they serve.
CANCELS = 6.9
#: Above it Gauss's rules are exact to rounding: nodes per term, and the range of c.
RULES = ((5.0, CANCELS, 20.0), (2.4, 20.0, 60.0), (1.2, 60.0, np.inf))


@dataclass(frozen=True, eq=False)
class Basis:
    """Basis of the tractions in X for one friction and kind of edges, with its quadrature rules."""

    delta: float  # Friction angle over pi: A = 1/2 + delta at a smooth trailing edge
    smooth: tuple[bool, bool]  # Whether the trailing and the leading edge are smooth
    terms: int  # M, number of collocation nodes
    samples: int  # N, number of quadrature nodes

    @property
    def exponents(self) -> tuple[float, float]:
        """Exponents A and B of w = (1 - X)^A (1 + X)^B."""
        return (0.5 if self.smooth[0] else -0.5) + self.delta, (0.5 if self.smooth[1] else -0.5) - self.delta

    @property
    def order(self) -> int:
        """Order k0 = A + B, 1 between smooth edges, 0 with one corner and -1 between corners."""
        return sum(self.smooth) - 1

    @property
    def pressures(self) -> int:
        """Number of terms of the pressure."""
        return self.terms - self.order

    @property
    def gain(self) -> float:
        """Factor 2^k0 / sin(pi A) of F4.2."""
        return float(2.0**self.order / np.sin(np.pi * self.exponents[0]))

    @cached_property
    def nodes(self) -> Array:
        """Collocation nodes X of Gauss's rule with exponents -A and -B; (M,)."""
        return self._dual_rule[0]

    @cached_property
    def _dual_rule(self) -> tuple[Array, Array]:
        """Nodes and weights of Gauss's rule with exponents -A and -B; (M,) each."""
        A, B = self.exponents
        return gauss_jacobi(self.terms, -A, -B)

    @cached_property
    def projection(self) -> Array:
        """Matrix from values at the nodes to coefficients in P^(-A,-B), by Gauss's rule; (M, M)."""
        X, weights = self._dual_rule
        values = self.dual(X, self.terms)
        return np.asarray(values * weights / (values**2 @ weights)[:, None])

    @cached_property
    def charge_projection(self) -> Array:
        """Matrix from values at the nodes to coefficients in U of the interpolating polynomial; (M, M)."""
        angle = np.pi * np.arange(1, self.terms + 1) / (self.terms + 1)
        orders = np.arange(1, self.terms + 1)
        to_series = 2 / (self.terms + 1) * np.sin(orders[:, None] * angle) * np.sin(angle)
        return np.asarray(to_series @ self.dual(np.cos(angle), self.terms).T @ self.projection)

    @cached_property
    def pressure_rule(self) -> tuple[Array, Array]:
        """Nodes S (N,) of Gauss's rule with weight w, and its weights times P_j(S) (N, pressures)."""
        S, weights = gauss_jacobi(self.samples, *self.exponents)
        return S, weights[:, None] * self.pressure_factor(S)

    @cached_property
    def charge_rule(self) -> tuple[Array, Array]:
        """Nodes S (N,) of Gauss's rule with weight 1/sqrt(1 - S^2), and its weights times T_n(S) (N, M + 1)."""
        angle = np.pi * (np.arange(self.samples) + 0.5) / self.samples
        return np.cos(angle), np.pi / self.samples * np.cos(angle[:, None] * np.arange(self.terms + 1))

    @cached_property
    def mean(self) -> Array:
        """Weights at the nodes of the mean over the contact with weight (1 - X^2)^(3/2); (M,)."""
        X, weights = mean_rule(self.terms)
        return np.asarray(weights @ self.dual(X, self.terms).T @ self.projection)

    def pressure_factor(self, X: Points) -> Points:
        """P_j^(A,B) at X (X,); (X, pressures)."""
        return jacobi(self.pressures, *self.exponents, X)

    def dual(self, X: Array, count: int) -> Array:
        """P_j^(-A,-B) at X (X,) in [-1, 1]; (count, X)."""
        A, B = self.exponents
        return jacobi(count, -A, -B, X).T

    def local(self, X: Points) -> Points:
        """Right side (2^k0 / sin pi A) P_(j+k0)^(-A,-B) of F4.2, with P_(-1) = 0; (X, pressures)."""
        A, B = self.exponents
        dual = jacobi(self.terms, -A, -B, X)
        if self.order == 1:
            return self.gain * dual[..., 1:]
        return self.gain * (dual if self.order == 0 else np.concatenate([0 * dual[..., :1], dual], -1))

    def weight(self, X: Array) -> Array:
        """Weight w at |X| < 1, of the shape of X."""
        A, B = self.exponents
        return np.asarray((1 - X) ** A * (1 + X) ** B)

    def transforms(self, z: Points) -> tuple[Points, Points]:
        """H[w P_j] (..., pressures) and H[T_n / sqrt(1 - X^2)] (..., M + 1) at z (...), |z| > 1 or Im z >= 0."""
        return self.transformed(z, np.eye(self.pressures)), self.charged(z)

    def charged(self, z: Points) -> Points:
        """H[T_n / sqrt(1 - X^2)] at z as for :meth:`transforms`; (..., M + 1)."""
        outer, root = ellipse(z)
        out = np.empty((self.terms + 1, *z.shape), z.dtype)
        out[0], inverse = -1 / root, 1 / outer
        for n in range(self.terms):
            out[n + 1] = out[n] * inverse
        return np.moveaxis(out, 0, -1)

    def transformed(self, z: Points, terms: Array) -> Points:
        """H[w sum_j terms_j P_j] at z as for :meth:`transforms`, of terms (pressures, c); (..., c)."""

        def near(z: Points) -> Points:
            outside = self.outside(z)[..., None] * (self.pressure_factor(z) @ terms)
            return outside - self.local(z) @ terms

        return off_contact(z, self.terms, self.exponents, terms, near)

    def outside(self, z: Points) -> Points:
        """(z - 1)^A (z + 1)^B / sin pi A off the contact, of the shape of z."""
        A, B = self.exponents
        scale = self.gain / 2.0**self.order
        if np.iscomplexobj(z):
            out: Points = scale * ((z - 1) ** A * (z + 1) ** B)
        else:
            out = z * 0 + scale * np.where(z > 1, 1.0, (-1.0) ** self.order) * np.abs(z - 1) ** A * np.abs(z + 1) ** B
        return out

    @property
    def total(self) -> float:
        """Integral m0 of w."""
        A, B = self.exponents
        return float(2 ** (A + B + 1) * beta(A + 1, B + 1))

    @cached_property
    def first_moments(self) -> Array:
        """Integrals of X w P_j; (pressures,)."""
        S, rule = self.pressure_rule
        return np.asarray(S @ rule)

    @cached_property
    def sign_moments(self) -> Array:
        """Integrals of w P_j times the mean of sgn(X - S) / 2 over X, by a double exponential rule; (pressures,)."""
        A, B = self.exponents
        S, to_trailing, to_leading, weight = double_exponential(min(A + 1, B + 1), 241 + 8 * self.terms)
        weight = weight * to_trailing**A * to_leading**B
        angle = np.arctan2(S, np.sqrt(to_trailing * to_leading))
        mean = -(angle + 2 / 3 * np.sin(2 * angle) + np.sin(4 * angle) / 12) / np.pi
        return np.asarray((weight * mean) @ self.pressure_factor(S))


@cached
def gauss_jacobi(count: int, A: float, B: float) -> tuple[Array, Array]:
    """Nodes and weights (count,) of Gauss's rule with weight (1 - X)^A (1 + X)^B, read-only."""
    # SciPy divides by 0 where A + B = -1, in an entry that it then replaces
    with np.errstate(invalid="ignore", divide="ignore"):
        X, weights = roots_jacobi(count, A, B)
    for array in (X, weights):
        array.flags.writeable = False
    return X, weights


def off_contact(
    z: Points, count: int, exponents: tuple[float, float], terms: Array, near: Callable[[Points], Points]
) -> Points:
    """H[w sum_j terms_j P_j] at z (...) off the contact, of terms (j, c), by ``near`` close to it; (..., c)."""
    cancellation = 2 * count * np.log(np.abs(ellipse(z)[0]))
    out = np.empty((*z.shape, terms.shape[-1]), z.dtype)
    close = cancellation < CANCELS
    out[close] = near(z[close])
    for nodes_per_term, least, most in RULES:
        far = (cancellation >= least) & (cancellation < most)
        out[far] = by_gauss(z[far], int(np.ceil(nodes_per_term * count)), exponents, terms)
    return out


def by_gauss(z: Points, nodes: int, exponents: tuple[float, float], terms: Array) -> Points:
    """H[w sum_j terms_j P_j] by Gauss's rule, away from the contact; (..., c)."""
    S, weights = gauss_jacobi(nodes, *exponents)
    rule = weights[:, None] * (jacobi(len(terms), *exponents, S) @ terms) / np.pi
    values: Points = (1 / (S - z[..., None])) @ rule
    return values


def ellipse(z: Points) -> tuple[Points, Points]:
    """Return z + sqrt(z^2 - 1), which lies outside the unit disk, and the root, both of the shape of z."""
    root = np.sqrt(z - 1) * np.sqrt(z + 1) if np.iscomplexobj(z) else np.sign(z) * np.sqrt(z * z - 1)
    return z + root, root


def double_exponential(least: float, count: int) -> tuple[Array, Array, Array, Array]:
    """Nodes X, 1 - X, 1 + X and weights of a rule on [-1, 1] for any singularity at its ends; (count,) each."""
    end = np.arcsinh(40 / (np.pi * least))  # e^-40 of the integrand is left out
    steps = np.linspace(-end, end, count)
    below, above = 2 / (1 + np.exp(-np.pi * np.sinh(steps))), 2 / (1 + np.exp(np.pi * np.sinh(steps)))
    weights = (steps[1] - steps[0]) * np.pi / 2 * np.cosh(steps) * below * above
    return (below - above) / 2, above, below, np.asarray(weights)


def mean_rule(count: int) -> tuple[Array, Array]:
    """Nodes X and weights of the mean with weight (1 - X^2)^(3/2), by Gauss's rule of sqrt(1 - X^2); (count,) each."""
    angle = np.pi * np.arange(1, count + 1) / (count + 1)
    return np.cos(angle), 8 / 3 * np.sin(angle) ** 4 / (count + 1)


def log_mean(S: Array) -> Array:
    """Mean of log|X - S| over X with weight (1 - X^2)^(3/2) (films, F5.1), of the shape of S."""
    return np.asarray(-np.log(2) + 2 / 3 * (2 * S**2 - 1) - (8 * S**4 - 8 * S**2 + 1) / 12)


def jacobi(count: int, a: float, b: float, X: Points) -> Points:
    """Jacobi polynomials P_j^(a,b) at real or complex X, (...), by their recurrence; (..., count)."""
    values = np.ones((count, *X.shape), X.dtype)
    if count > 1:
        values[1] = (a + 1) + (a + b + 2) * (X - 1) / 2
    for j in range(1, count - 1):
        t = 2 * j + a + b
        above = 2 * (j + 1) * (j + a + b + 1) * t
        slope, shift = t * (t + 1) * (t + 2) / above, (t + 1) * (a * a - b * b) / above
        values[j + 1] = (slope * X + shift) * values[j] - 2 * (j + a) * (j + b) * (t + 2) / above * values[j - 1]
    return np.moveaxis(values, 0, -1)
