"""Factor of a separable Gaussian process: its kernel on the levels and its features at query points.

The kernel of factor f for output p is ``1 + amplitude[f, p] * K_f(x, y)``. In the factor's basis of discrete Chebyshev
polynomials smooth data have few and quickly decaying coefficients.
"""

from dataclasses import dataclass

import numpy as np

from approximation import chebyshev
from approximation.arrays import Array

NEGLIGIBLE = 1e-17  # share of a mode that its alias may take and be dropped, below rounding


@dataclass(frozen=True)
class Features:
    """Features of one factor at B query points."""

    mean: Array  # shape (modes, B); functions that the coefficients of the mean multiply
    prior: Array  # shape (B,); K(x, x), without the constant and the amplitude
    residual: Array  # shape (B,); unknown part of K(x, x) given levels X, K(x, x) - K(x, X) K(X, X)^-1 K(X, x)


class Factor:
    """Factor kernel K(x, y) = sum_{0<m<2n} rho^m T_m(x) T_m(y) on the n zeros of T_n.

    On these levels T_{2n-m} = -T_m and T_n = 0 (aliasing: Trefethen, Approximation Theory and Approximation Practice
    (2013), chapter 4). So the discrete cosine transform has the eigenvectors of the kernel matrix, and each pair
    (m, 2n-m) has the eigenvalue rho^m + rho^(2n-m). With 2n terms the constant has no alias, and the mean reproduces
    it exactly. From T_m + T_{2n-m} = 2 T_n T_{n-m}, the unknown part of K(x, x) is

        T_n(x)^2 [rho^n + 4 sum_{0<m<n} rho^m rho^(2n-m) / (rho^m + rho^(2n-m)) T_{n-m}(x)^2].

    The kernel of a factor with two levels is affine: it ends at T_1 and leaves nothing unknown.
    """

    t: Array  # shape (n,), levels in the scaled coordinate
    parameter: float  # rho
    levels: int  # n
    affine: bool
    basis: Array  # shape (n, n), orthonormal columns on the levels, from smooth to rough
    weights: Array  # shape (n,), factor between coefficients in `basis` and those that multiply `Features.mean`
    decay: Array  # shape (2n,) or, affine, (2,), coefficients rho^m of the kernel, 0 for m = 0
    eigenvalues: Array  # shape (n,), eigenvalues of the kernel on the levels, over the squares of `weights`
    damping: Array  # shape (n,), share of every mode that its alias takes
    unknown: Array  # shape (n,), coefficients of T_j(x)^2 in the unknown part over T_n(x)^2

    def __init__(self, levels: int, rho: float) -> None:
        if not 0 < rho < 1:
            raise ValueError(f"rho must lie between 0 and 1, got {rho}")
        self.parameter, self.t = rho, chebyshev.gauss_points(levels)
        n = self.levels = levels
        self.affine = n == 2
        self.basis, self.weights = cosine_basis(n)
        decay = np.asarray(rho ** np.arange(2.0 * n), dtype=np.float64)
        decay[0] = 0.0
        if self.affine:
            decay = np.array([0.0, 1.0])
        self.decay = decay
        alias = np.zeros(n)
        if not self.affine:
            alias[1:] = decay[:n:-1]
        self.eigenvalues = decay[:n] + alias
        self.eigenvalues[0] = 1.0
        self.damping = alias / self.eigenvalues
        # T_{n-m} takes the m-th share, hence the reversal; T_0 stands for the term of T_n itself
        self.unknown = np.zeros(n)
        if not self.affine:
            self.unknown[1:] = 4 * (decay[:n] * self.damping)[:0:-1]
            self.unknown[0] = decay[n]
        significant = np.flatnonzero(self.damping > NEGLIGIBLE)
        self._first_damped = int(significant[0]) if significant.size else n
        # one product gives the prior and the residual over T_n^2
        self._shares = np.stack([decay, np.append(self.unknown, np.zeros(len(decay) - n))])

    def inverse(self) -> tuple[Array, Array]:
        """Return K^-1 basis, (n, n), and the diagonal of K^-1, (n,); the basis diagonalises K."""
        inverse = self.basis * (self.weights**2 / self.eigenvalues)
        return inverse, np.einsum("im,im->i", inverse, self.basis)

    def features(self, t: Array, modes: int) -> Features:
        """Return the features at scaled coordinates t, (B,), whose means are T_m damped by its alias."""
        T = chebyshev.polynomials(t, len(self.decay))
        squares = T * T
        prior, residual = self._shares @ squares
        if not self.affine:
            residual *= squares[self.levels]
        return Features(self._mean(T, modes), prior, residual)

    def slopes(self, t: Array, modes: int) -> Features:
        """Return the derivatives of the means' features at t, (B,), and the prior and unknown variance of a slope."""
        T = chebyshev.polynomials(t, len(self.decay))
        S = chebyshev.slopes(t, T)
        n, rows = self.levels, np.arange(self._first_damped, max(modes, self._first_damped))
        mean, prior = S[:modes].copy(), self.decay @ S**2
        if self.affine:
            return Features(mean, prior, np.zeros_like(t))
        mirror = n - rows
        mean[rows] -= 2 * self.damping[rows, None] * (S[n] * T[mirror] + T[n] * S[mirror])
        return Features(mean, prior, self.unknown @ (S[n] * T[:n] + T[n] * S[:n]) ** 2)

    def _mean(self, T: Array, modes: int) -> Array:
        first, n = self._first_damped, self.levels
        if first >= modes:
            return T[:modes]
        mean = T[:modes].copy()
        mean[first:] -= (2 * self.damping[first:modes, None] * T[n]) * T[n - first : n - modes : -1]
        return mean


def cosine_basis(n: int) -> tuple[Array, Array]:
    """Return the discrete cosine basis on n Chebyshev-Gauss points, (n, n), and the norms that make it T_m, (n,)."""
    weights = np.full(n, np.sqrt(2 / n))
    weights[0] = np.sqrt(1 / n)
    return np.ascontiguousarray(chebyshev.polynomials(chebyshev.gauss_points(n), n).T * weights), weights
