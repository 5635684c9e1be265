"""The Chebyshev kernel of scattered cases in closed form, and its parameters by marginal likelihood.

The kernel is the product over inputs of 1 + first_j sum_{m>0} rho_j^(m-1) T_m(x) T_m(y): that of the grid, whose sum
does not end. With x = cos(a), y = cos(b) the sum is half of Q(a - b) + Q(a + b) with Q(s) = (cos s - rho)/(1 - 2 rho
cos s + rho^2), by the Poisson kernel (W. Rudin, Real and Complex Analysis (1987), section 5.24).
"""

from dataclasses import dataclass

import numpy as np
import scipy  # scipy.optimize, slow to import, when something is fitted
from scipy.linalg import LinAlgError, cho_solve, cholesky
from scipy.linalg.lapack import dpotri

from approximation.arrays import Array

# Ranges of the parameters: coefficient of T_1 beside that of the constant, decay, and noise over signal, as variances.
FIRST, RHO, NOISE = (1e-6, 1e2), (1e-3, 0.97), (1e-10, 1e2)
ITERATIONS = 60


@dataclass(frozen=True)
class Decay:
    """Parameters of the kernel: coefficients first_j rho_j^(m-1) of T_m, (d,) each."""

    first: Array
    rho: Array

    def coefficients(self, degrees: int) -> Array:
        """Return the coefficients of T_0 .. T_degrees of every input, (d, degrees + 1)."""
        rest = self.first[:, None] * self.rho[:, None] ** np.arange(degrees)
        return np.concatenate([np.ones((len(rest), 1)), rest], axis=1)


def kernel(decay: Decay, t: Array, at: Array) -> Array:
    """Return the kernel, (n, m).

    t, at: (d, n), (d, m), scaled coordinates.
    """
    product = np.ones((t.shape[1], at.shape[1]))
    for first, rho, x, y in zip(decay.first, decay.rho, t, at, strict=True):
        product *= 1 + first * sums(x, y, rho)[0]
    return product


def squares(decay: Decay, t: Array) -> Array:
    """Return the kernel of points with themselves, (n,).

    t: (d, n), scaled coordinates.
    """
    product = np.ones(t.shape[1])
    for first, rho, x in zip(decay.first, decay.rho, np.clip(t, -1, 1), strict=True):
        cosine = 2 * x * x - 1  # of the sum of the angles; that of their difference is one
        product *= 1 + first / 2 * ((cosine - rho) / (1 + rho * rho - 2 * rho * cosine) + 1 / (1 - rho))
    return product


def most_likely(t: Array, y: Array, weights: Array | None = None) -> tuple[Decay, float]:
    """Return the kernel under which outputs are most likely, and the share of noise.

    t: (d, n); y: (n, p); weights: (n,), optional.
    """
    d, share = len(t), np.ones(t.shape[1]) if weights is None else 1 / weights
    start = np.log(np.concatenate([np.full(d, 0.3), np.full(d, 0.3), [1e-3]]))
    bounds = [tuple(np.log(ends)) for ends in [FIRST] * d + [RHO] * d + [NOISE]]
    optimum = scipy.optimize.minimize(
        _cost, start, (t, y, share), method="L-BFGS-B", jac=True, bounds=bounds, options={"maxiter": ITERATIONS}
    )
    parameters = np.exp(optimum.x)
    return Decay(parameters[:d], parameters[d : 2 * d]), float(parameters[-1])


def _cost(logs: Array, t: Array, y: Array, share: Array | float = 1.0) -> tuple[float, Array]:
    """Minus twice the logarithm of the likelihood, over the cases, and its slopes by the logarithms of the parameters.

    C. E. Rasmussen and C. K. I. Williams, Gaussian Processes for Machine Learning (2006), eqs. 5.8 and 5.9, with the
    variance of each output at its best value.
    """
    d, (n, p) = len(t), y.shape
    first, rho, noise = np.exp(logs[:d]), np.exp(logs[d:-1]), float(np.exp(logs[-1]))
    parts = [sums(x, x, rate) for x, rate in zip(t, rho, strict=True)]
    factors = [1 + size * some[0] for size, some in zip(first, parts, strict=True)]
    C = np.ones((n, n))
    for factor in factors:
        C *= factor
    C[np.diag_indices(n)] += noise * share
    try:
        L = cholesky(C, lower=True, check_finite=False)
    except LinAlgError:
        return np.inf, np.zeros_like(logs)
    alpha = cho_solve((L, True), y, check_finite=False)
    energy = np.einsum("np,np->p", y, alpha)
    cost = float(np.log(energy / n).sum() + 2 * p * np.log(np.diag(L)).sum() / n)
    inverse, _ = dpotri(L, lower=1)
    inverse += np.tril(inverse, -1).T  # only the lower triangle was filled
    weight = p / n * inverse - (alpha / energy) @ alpha.T
    slopes = np.empty_like(logs)
    slopes[-1] = noise * float((np.diag(weight) * share).sum())
    before = weight  # the product with all factors before the current one
    after = [np.ones((1, 1))]
    for factor in factors[:0:-1]:
        after.append(after[-1] * factor)
    for j, (factor, (value, slope)) in enumerate(zip(factors, parts, strict=True)):
        rest = before * after[d - 1 - j]
        slopes[j] = first[j] * np.vdot(rest, value)
        slopes[d + j] = first[j] * rho[j] * np.vdot(rest, slope)
        before = before * factor
    return cost, slopes


def sums(x: Array, y: Array, rho: float) -> tuple[Array, Array]:
    """sum_{m>0} rho^(m-1) T_m(x) T_m(y), (n, m), and its slope by rho.

    x, y: (n,), (m,), scaled coordinates.
    """
    inside = np.clip(x, -1, 1), np.clip(y, -1, 1)
    a, b = (np.arccos(cosine) for cosine in inside)
    even = np.multiply.outer(*inside)
    odd = np.multiply.outer(np.sin(a), np.sin(b))
    value, slope = np.zeros_like(even), np.zeros_like(even)
    for cosine in (even + odd, even - odd):  # of the difference and of the sum of the angles
        inverse = 1 / (1 + rho * rho - 2 * rho * cosine)
        part = (cosine - rho) * inverse
        value += part / 2
        slope += part * part - inverse / 2
    return value, slope


def sum_slopes(x: Array, y: Array, rho: float) -> Array:
    """Slopes by x of the sums of `sums`, (n, m), by the quotient of polynomials that these are; zero beyond [-1, 1].

    x, y: (n,), (m,), scaled coordinates.
    """
    inside = np.clip(x, -1, 1)[:, None], np.clip(y, -1, 1)[None]
    below, above, _, by_below, by_above = _quotient(*inside, rho)
    slope = (by_above / 2 - above / below / 2 * by_below) / below
    return np.asarray(np.where(np.abs(x)[:, None] <= 1, slope, 0.0))


def sum_curvature(x: Array, rho: float) -> Array:
    """Slopes by x and by y of the sums of `sums` at y = x, (n,).

    x: (n,), scaled coordinates.
    """
    inside = np.clip(x, -1, 1)
    below, above, squared, by_below, by_above = _quotient(inside, inside, rho)
    value = above / below / 2
    slope = (by_above / 2 - value * by_below) / below
    both = (2 * rho * rho + squared) - by_above / 2 * by_below / below  # the numerator's own slope by both, halved
    curvature = (both - slope * by_below + 4 * rho * squared * value + value * by_below**2 / below) / below
    return np.asarray(np.where(np.abs(x) <= 1, curvature, 0.0))


def _quotient(x: Array, y: Array, rho: float) -> tuple[Array, Array, float, Array, Array]:
    """Denominator and numerator of twice the sums, 1 + rho^2, and the slopes of both by x."""
    squared = 1 + rho * rho
    even, circle = 2 * x * y, x * x + y * y - 1
    below = squared**2 - 2 * rho * squared * even + 4 * rho * rho * circle
    above = (squared + 2 * rho * rho) * even - 4 * rho * circle - 2 * rho * squared
    by_below = -4 * rho * squared * y + 8 * rho * rho * x
    by_above = 2 * (squared + 2 * rho * rho) * y - 8 * rho * x
    return below, above, squared, by_below, by_above
