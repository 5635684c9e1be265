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
    """Return the kernel between scaled coordinates (d, n) and (d, m): (n, m)."""
    product = np.ones((t.shape[1], at.shape[1]))
    for first, rho, x, y in zip(decay.first, decay.rho, t, at, strict=True):
        product *= 1 + first * _sums(x, y, rho)[0]
    return product


def most_likely(t: Array, y: Array) -> tuple[Decay, float]:
    """Return the kernel under which outputs are most likely, and the share of noise.

    Parameters
    ----------
    t : ndarray, shape (d, n)
        Scaled coordinates of the cases; the cost grows with the cube of n.
    y : ndarray, shape (n, p)
        Standardised outputs; each has a variance of its own, which is profiled out.

    Returns
    -------
    decay : Decay
    noise : float
        Variance of the noise over that of the process, one for all outputs.
    """
    d = len(t)
    start = np.log(np.concatenate([np.full(d, 0.3), np.full(d, 0.3), [1e-3]]))
    bounds = [tuple(np.log(one)) for one in [FIRST] * d + [RHO] * d + [NOISE]]
    found = scipy.optimize.minimize(
        _cost, start, (t, y), method="L-BFGS-B", jac=True, bounds=bounds, options={"maxiter": ITERATIONS}
    )
    parameters = np.exp(found.x)
    return Decay(parameters[:d], parameters[d : 2 * d]), float(parameters[-1])


def _cost(logs: Array, t: Array, y: Array) -> tuple[float, Array]:
    """Minus twice the logarithm of the likelihood, over the cases, and its slopes by the logarithms of the parameters.

    C. E. Rasmussen and C. K. I. Williams, Gaussian Processes for Machine Learning (2006), eqs. 5.8 and 5.9, with the
    variance of each output at its best value.
    """
    d, (n, p) = len(t), y.shape
    first, rho, noise = np.exp(logs[:d]), np.exp(logs[d:-1]), float(np.exp(logs[-1]))
    sums = [_sums(x, x, one) for x, one in zip(t, rho, strict=True)]
    factors = [1 + one * some[0] for one, some in zip(first, sums, strict=True)]
    C = np.ones((n, n))
    for factor in factors:
        C *= factor
    C[np.diag_indices(n)] += noise
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
    slopes[-1] = noise * np.trace(weight)
    before = weight  # the product with all factors before the current one
    after = [np.ones((1, 1))]
    for factor in factors[:0:-1]:
        after.append(after[-1] * factor)
    for j, (factor, (value, slope)) in enumerate(zip(factors, sums, strict=True)):
        rest = before * after[d - 1 - j]
        slopes[j] = first[j] * np.vdot(rest, value)
        slopes[d + j] = first[j] * rho[j] * np.vdot(rest, slope)
        before = before * factor
    return cost, slopes


def _sums(x: Array, y: Array, rho: float) -> tuple[Array, Array]:
    """sum_{m>0} rho^(m-1) T_m(x) T_m(y), (n, m), and its slope by rho."""
    inside = np.clip(x, -1, 1), np.clip(y, -1, 1)
    a, b = (np.arccos(one) for one in inside)
    even = np.multiply.outer(*inside)
    odd = np.multiply.outer(np.sin(a), np.sin(b))
    value, slope = np.zeros_like(even), np.zeros_like(even)
    for cosine in (even + odd, even - odd):  # of the difference and of the sum of the angles
        inverse = 1 / (1 + rho * rho - 2 * rho * cosine)
        part = (cosine - rho) * inverse
        value += part / 2
        slope += part * part - inverse / 2
    return value, slope
