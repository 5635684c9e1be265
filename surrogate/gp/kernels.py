"""Kernels of scattered cases for scikit-learn's regressor: the Chebyshev kernel, and noise of weighted cases.

The Chebyshev kernel is the product over inputs of 1 + first_j sum_{m>0} rho_j^(m-1) T_m(x) T_m(y): that of the grid,
whose sum does not end. With x = cos(a), y = cos(b) the sum is half of Q(a - b) + Q(a + b) with Q(s) = (cos s - rho)/
(1 - 2 rho cos s + rho^2), by the Poisson kernel (W. Rudin, Real and Complex Analysis (1987), section 5.24).
"""

from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np
from sklearn.gaussian_process.kernels import ConstantKernel, Hyperparameter, Kernel, WhiteKernel

from approximation.arrays import Array

# Ranges of the parameters: coefficient of T_1 relative to that of the constant, and decay.
FIRST, RHO = (1e-6, 1e3), (1e-3, 0.97)
VARIANCES, NOISE = (1e-6, 1e6), (1e-12, 1e1)  # of signal and noise, relative to the output's variance


class Chebyshev(Kernel):  # type: ignore[misc]  # untyped
    """The Chebyshev kernel on [-1, 1]^d; coordinates beyond count as those of the nearest end.

    first, rho: shape (d,).
    """

    def __init__(self, first: Array, rho: Array) -> None:
        self.first, self.rho = first, rho

    @property
    def hyperparameter_first(self) -> Hyperparameter:
        """Coefficients of T_1, as scikit-learn reads them."""
        return Hyperparameter("first", "numeric", FIRST, np.size(self.first))

    @property
    def hyperparameter_rho(self) -> Hyperparameter:
        """Decays, as scikit-learn reads them."""
        return Hyperparameter("rho", "numeric", RHO, np.size(self.rho))

    def __call__(self, X: Array, Y: Array | None = None, eval_gradient: bool = False) -> Any:
        """Return the kernel between points (n, d) and (m, d), and its slopes by the logarithms of the parameters."""
        first, rho = np.atleast_1d(self.first), np.atleast_1d(self.rho)
        parts = [sums(x, y, decay) for x, y, decay in zip(X.T, (X if Y is None else Y).T, rho, strict=True)]
        factors = [1 + size * part[0] for size, part in zip(first, parts, strict=True)]
        kernel = np.prod(factors, axis=0)
        if not eval_gradient:
            return kernel
        d = len(factors)
        slopes = np.empty((*kernel.shape, 2 * d))
        for j, ((value, slope), others) in enumerate(zip(parts, _products(factors), strict=True)):
            slopes[..., j] = first[j] * others * value
            slopes[..., d + j] = first[j] * rho[j] * others * slope
        return kernel, slopes

    def diag(self, X: Array) -> Array:
        """Return the kernel of every point with itself, (n,)."""
        return np.asarray(np.prod(self._diagonals(X.T), axis=0))

    def is_stationary(self) -> bool:
        """Return False: the kernel depends on position."""
        return False

    def slopes(self, X: Array, Y: Array) -> list[Array]:
        """Return the derivatives of the kernel by each coordinate of X, (n, m) each."""
        first, rho = np.atleast_1d(self.first), np.atleast_1d(self.rho)
        factors = [1 + first[j] * sums(X[:, j], Y[:, j], rho[j])[0] for j in range(X.shape[1])]
        return [
            first[j]
            * sum_slopes(X[:, j], Y[:, j], rho[j])
            * np.prod([f for k, f in enumerate(factors) if k != j], axis=0)
            for j in range(X.shape[1])
        ]

    def steepness(self, X: Array) -> Array:
        """Return the prior variances of the derivatives by each coordinate at points (n, d): (d, n)."""
        first, rho = np.atleast_1d(self.first), np.atleast_1d(self.rho)
        others = _products(self._diagonals(X.T))
        return np.stack([first[j] * sum_curvature(x, rho[j]) * others[j] for j, x in enumerate(X.T)])

    def _diagonals(self, t: Array) -> list[Array]:
        first, rho = np.atleast_1d(self.first), np.atleast_1d(self.rho)
        cosines = 2 * np.clip(t, -1, 1) ** 2 - 1  # of the sum of the angles; that of their difference is one
        return [
            1 + size / 2 * ((cosine - decay) / (1 + decay * decay - 2 * decay * cosine) + 1 / (1 - decay))
            for size, decay, cosine in zip(first, rho, cosines, strict=True)
        ]


class Noise(WhiteKernel):  # type: ignore[misc]  # untyped
    """Noise of the cases that a process is fitted to: its variance is divided by a case's weight.

    weights: shape (n,), optional.
    """

    def __init__(
        self, noise_level: float = 1e-4, noise_level_bounds: tuple[float, float] = NOISE, weights: Array | None = None
    ) -> None:
        super().__init__(noise_level, noise_level_bounds)
        self.weights = weights

    def __call__(self, X: Array, Y: Array | None = None, eval_gradient: bool = False) -> Any:
        """Return the covariance of the noise, (n, n) of the cases, zero between them and other points."""
        kernel = super().__call__(X, Y, eval_gradient)
        if Y is not None or self.weights is None:
            return kernel
        share = 1 / self.weights
        if eval_gradient:
            return kernel[0] * share, kernel[1] * share[:, None]
        return kernel * share


def whole(inputs: int, weights: Array | None = None) -> Kernel:
    """Return the Chebyshev kernel times a variance, with noise of weighted cases."""
    correlation = Chebyshev(np.full(inputs, 0.3), np.full(inputs, 0.3))
    return ConstantKernel(1.0, VARIANCES) * correlation + Noise(weights=weights)


def _products(factors: Sequence[Array]) -> list[Array]:
    """Return the products of all other factors, one a factor."""
    before = accumulate(factors[:-1], np.multiply, initial=np.ones(1))
    after = accumulate(factors[:0:-1], np.multiply, initial=np.ones(1))
    return [left * right for left, right in zip(before, reversed(list(after)), strict=True)]


def sums(x: Array, y: Array, rho: float) -> tuple[Array, Array]:
    """Return sum_{m>0} rho^(m-1) T_m(x) T_m(y), (n, m), and its slope by rho."""
    x, y = np.clip(x, -1, 1), np.clip(y, -1, 1)
    even = np.multiply.outer(x, y)
    odd = np.multiply.outer(np.sqrt(1 - x * x), np.sqrt(1 - y * y))
    value, slope = np.zeros_like(even), np.zeros_like(even)
    for cosine in (even + odd, even - odd):  # of the difference and of the sum of the angles
        inverse = 1 / (1 + rho * rho - 2 * rho * cosine)
        part = (cosine - rho) * inverse
        value += part / 2
        slope += part * part - inverse / 2
    return value, slope


def sum_slopes(x: Array, y: Array, rho: float) -> Array:
    """Return the slopes by x of the sums of `sums`, (n, m); zero beyond [-1, 1]."""
    below, above, _, by_below, by_above = _quotient(np.clip(x, -1, 1)[:, None], np.clip(y, -1, 1)[None], rho)
    slope = (by_above / 2 - above / below / 2 * by_below) / below
    return np.asarray(np.where(np.abs(x)[:, None] <= 1, slope, 0.0))


def sum_curvature(x: Array, rho: float) -> Array:
    """Return the slopes by x and by y of the sums of `sums` at y = x, (n,)."""
    inside = np.clip(x, -1, 1)
    below, above, squared, by_below, by_above = _quotient(inside, inside, rho)
    value = above / below / 2
    slope = (by_above / 2 - value * by_below) / below
    by_both = (2 * rho * rho + squared) - by_above / 2 * by_below / below  # the numerator's slope by both, halved
    curvature = (by_both - slope * by_below + 4 * rho * squared * value + value * by_below**2 / below) / below
    return np.asarray(curvature)


def _quotient(x: Array, y: Array, rho: float) -> tuple[Array, Array, float, Array, Array]:
    """Return denominator and numerator of twice the sums, 1 + rho^2, and the slopes of both by x."""
    squared = 1 + rho * rho
    even, circle = 2 * x * y, x * x + y * y - 1
    below = squared**2 - 2 * rho * squared * even + 4 * rho * rho * circle
    above = (squared + 2 * rho * rho) * even - 4 * rho * circle - 2 * rho * squared
    by_below = -4 * rho * squared * y + 8 * rho * rho * x
    by_above = 2 * (squared + 2 * rho * rho) * y - 8 * rho * x
    return below, above, squared, by_below, by_above
