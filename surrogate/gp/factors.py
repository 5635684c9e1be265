"""Factor of a separable Gaussian process: its kernel on the levels and its features at a query.

Every factor brings an orthonormal basis of functions on its levels, ordered from smooth to rough (discrete Chebyshev
polynomials: on Chebyshev-Gauss levels the discrete cosine transform), in which smooth data have few and quickly
decaying coefficients. The kernel of factor f for output p is ``1 + amplitude[f, p] * K_f(x, y)``.
"""

from dataclasses import dataclass

import numpy as np

from approximation import chebyshev
from approximation.arrays import Array

# Mean features drop contributions of the kernel's tail below rounding.
NEGLIGIBLE = 1e-17


@dataclass(frozen=True)
class Features:
    """Features of one factor at B query points."""

    mean: Array  # shape (modes, B); Functions that the coefficients of the mean multiply
    prior: Array  # shape (B,); K(x, x), without the constant and the amplitude
    # shape (B,); Part of K(x, x) that the levels leave unknown, >= 0: K(x, x) - K(x, X) K(X, X)^-1 K(X, x)
    residual: Array


class Factor:
    """Factor kernel sum_{0<m<2n} rho^m T_m(x) T_m(y) beside a constant, on the n zeros of T_n.

    On these levels T_{2n-m} = -T_m and T_n = 0, so every kernel that is diagonal in the Chebyshev polynomials has the
    discrete cosine transform as eigenvectors, and each pair (m, 2n-m) shares one eigenvalue rho^m + rho^(2n-m). With
    2n terms the constant has no alias and the mean reproduces it exactly. What the levels leave unknown is

        T_n(x)^2 [rho^n + 4 sum_{0<m<n} rho^m rho^(2n-m) / (rho^m + rho^(2n-m)) T_{n-m}(x)^2],

    a sum of squares that vanishes on the levels (from T_m + T_{2n-m} = 2 T_n T_{n-m}). A factor with two levels is
    taken as affine: its kernel ends at T_1 and nothing is left unknown.
    Source: aliasing, Trefethen, Approximation Theory and Approximation Practice (2013), chapter 4; the rest follows.
    """

    t: Array  # shape (n,), levels in the scaled coordinate
    parameter: float  # rho, the kernel's decay
    levels: int  # their number n
    affine: bool  # whether the kernel is affine, so that the levels leave nothing unknown
    basis: Array  # shape (n, n), orthonormal columns on the levels, from smooth to rough
    weights: Array  # shape (n,), factor between coefficients in `basis` and those that multiply `Features.mean`
    decay: Array  # shape (2n,) or, affine, (2,), coefficients of the kernel without its constant
    eigenvalues: Array  # shape (n,), of the kernel on the levels, over the squares of `weights`
    damping: Array  # shape (n,), share of every mode that its alias takes
    unknown: Array  # shape (n,), coefficients of T_j(x)^2 in what the levels leave unknown over T_n(x)^2

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
        # one product gives the prior and what it must be multiplied by T_n^2 to give the residual
        self._shares = np.stack([decay, np.append(self.unknown, np.zeros(len(decay) - n))])

    def inverse(self) -> tuple[Array, Array]:
        """Return K^-1 basis and the diagonal of K^-1; the basis diagonalises K."""
        inverse = self.basis * (self.weights**2 / self.eigenvalues)
        return inverse, np.einsum("im,im->i", inverse, self.basis)

    def features(self, t: Array, modes: int) -> Features:
        """Return T_m damped by its alias, K(x, x) and what the levels leave unknown."""
        T = chebyshev.polynomials(t, len(self.decay))
        squares = T * T
        prior, residual = self._shares @ squares
        if not self.affine:
            residual *= squares[self.levels]
        return Features(self._mean(T, modes), prior, residual)

    def slopes(self, t: Array, modes: int) -> Features:
        """Return those of T_m damped by its alias; kernel and unknown part are sums of products T(x) T(y)."""
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
