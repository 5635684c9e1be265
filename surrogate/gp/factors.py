"""What one factor contributes to a separable Gaussian process: its kernel on the levels and its features at a query.

Every factor brings an orthonormal basis of functions on its levels, ordered from smooth to rough (discrete Chebyshev
polynomials: on Chebyshev-Gauss levels the discrete cosine transform), in which smooth data have few and quickly
decaying coefficients. The kernel of factor f for output p is ``constant + amplitude[f, p] * K_f(x, y)``.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.linalg import eigh
from typing_extensions import override

from approximation import chebyshev
from approximation.arrays import Array, Indices

# Mean features drop contributions of the kernel's tail below rounding.
NEGLIGIBLE = 1e-17


@dataclass(frozen=True)
class Features:
    """What the process needs of one factor at B query points."""

    mean: Array  # shape (modes, B); Functions that the coefficients of the mean multiply
    prior: Array  # shape (B,); K(x, x), without constant and amplitude
    # shape (B,); Part of K(x, x) that the levels leave unknown, >= 0: K(x, x) - K(x, X) K(X, X)^-1 K(X, x)
    residual: Array


class Factor(ABC):
    """Kernel of one factor on given levels, in the scaled coordinate."""

    constant: ClassVar[float]  # Constant part of the kernel beside the scaled part
    t: Array  # shape (n,); Levels in the scaled coordinate
    parameter: float  # The kernel's one hyper-parameter
    affine: bool = False  # Whether the kernel's functions are affine, so that the levels leave nothing unknown
    basis: Array  # shape (n, n); Orthonormal columns, from smooth to rough
    weights: Array  # shape (n,); Scale between coefficients in `basis` and those that multiply `Features.mean`

    @abstractmethod
    def inverse(self) -> tuple[Array, Array]:
        """Return K^-1 basis, shape (n, n), and the diagonal of K^-1, shape (n,), at unit amplitude."""

    @abstractmethod
    def features(self, t: Array, modes: int) -> Features:
        """Return the features at points.

        t: (B,), scaled coordinates.
        """

    @abstractmethod
    def slopes(self, t: Array, modes: int) -> Features:
        """Return what the process needs for derivatives by t.

        These are the derivatives of the mean's functions, and d^2/dx dy at x = y = t of the kernel K(x, y) and of its
        unknown part: the variances of the derivative.

        t: (B,), scaled coordinates.
        """


class ChebyshevFactor(Factor):
    """Factor kernel sum_{0<m<2n} rho^m T_m(x) T_m(y) beside a constant, on the n zeros of T_n.

    On these levels T_{2n-m} = -T_m and T_n = 0, so every kernel that is diagonal in the Chebyshev polynomials has the
    discrete cosine transform as eigenvectors, and each pair (m, 2n-m) shares one eigenvalue rho^m + rho^(2n-m). With
    2n terms the constant has no alias and the mean reproduces it exactly. What the levels leave unknown is

        T_n(x)^2 [rho^n + 4 sum_{0<m<n} rho^m rho^(2n-m) / (rho^m + rho^(2n-m)) T_{n-m}(x)^2],

    a sum of squares that vanishes on the levels (from T_m + T_{2n-m} = 2 T_n T_{n-m}). A factor with two levels is
    taken as affine: its kernel ends at T_1 and nothing is left unknown.
    Source: aliasing, Trefethen, Approximation Theory and Approximation Practice (2013), chapter 4; the rest follows.

    levels: Number of levels n. decay: shape (2n,) or, affine, (2,); Coefficients of the kernel without its constant.
    eigenvalues: shape (n,); Of every mode of the basis, over the square of its weight those of the kernel on the
    levels. damping: shape (n,); Share of every mode that its alias takes. unknown: shape (n,); Coefficients of
    T_j(x)^2 in what the levels leave unknown over T_n(x)^2; that of j = 0 is rho^n.
    """

    constant = 1.0

    def __init__(self, levels: int, rho: float) -> None:
        self.parameter, self.t = rho, chebyshev.gauss_points(levels)
        n = self.levels = levels
        self.affine = n == 2
        self.basis, self.weights = cosine_basis(n)
        decay = rho ** np.arange(2 * n)
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

    @override
    def features(self, t: Array, modes: int) -> Features:
        """Return T_m damped by its alias, K(x, x) and what the levels leave unknown."""
        T = chebyshev.polynomials(t, len(self.decay))
        squares = T * T
        prior, residual = self._shares @ squares
        if not self.affine:
            residual *= squares[self.levels]
        return Features(self._mean(T, modes), prior, residual)

    @override
    def slopes(self, t: Array, modes: int) -> Features:
        """Return those of T_m damped by its alias; kernel and unknown part are sums of products T(x) T(y)."""
        T = chebyshev.polynomials(t, len(self.decay))
        S = chebyshev.slopes(t, T)
        n, rows = self.levels, self._damped(modes)
        mean, prior = S[:modes].copy(), self.decay @ S**2
        if self.affine:
            return Features(mean, prior, np.zeros_like(t))
        mirror = n - rows
        mean[rows] -= 2 * self.damping[rows, None] * (S[n] * T[mirror] + T[n] * S[mirror])
        return Features(mean, prior, self.unknown @ (S[n] * T[:n] + T[n] * S[:n]) ** 2)

    def plain(self) -> dict[str, object]:
        """Return what `features` needs, as plain lists."""
        return {
            "levels": self.levels,
            "affine": self.affine,
            "decay": self.decay.tolist(),
            "damping": self.damping.tolist(),
            "unknown": self.unknown.tolist(),
            "firstDamped": self._first_damped,
        }

    def _mean(self, T: Array, modes: int) -> Array:
        first, n = self._first_damped, self.levels
        if first >= modes:
            return T[:modes]
        mean = T[:modes].copy()
        mean[first:] -= (2 * self.damping[first:modes, None] * T[n]) * T[n - first : n - modes : -1]
        return mean

    def _damped(self, modes: int) -> Indices:
        return np.arange(self._first_damped, max(modes, self._first_damped))


class StationaryFactor(Factor):
    """Factor kernel that depends on the distance of scaled coordinates only: RBF or Matern, on any levels.

    Formulas: C. E. Rasmussen and C. K. I. Williams, Gaussian Processes for Machine Learning (2006), section 4.2.

    t: (n,).
    """

    constant = 0.0

    def __init__(self, kind: str, t: Array, length_scale: float, nugget: float) -> None:
        self.parameter = length_scale
        self._kind, self.t = kind, t
        self.basis, self.weights = polynomial_basis(t), np.ones(len(t))
        K = radial(kind, np.abs(t[:, None] - t) / length_scale)[0] + nugget * np.eye(len(t))
        eigenvalues, vectors = eigh(K)
        # rounding can push the smallest eigenvalues of a smooth kernel below the nugget
        eigenvalues = np.maximum(eigenvalues, max(nugget, len(t) * np.finfo(float).eps))
        self._whiten = (vectors / np.sqrt(eigenvalues)).T
        self._inverse = self._whiten.T @ self._whiten
        self._cardinal = (self.basis.T @ self._whiten.T) @ self._whiten

    def inverse(self) -> tuple[Array, Array]:
        """Return K^-1 basis and the diagonal of K^-1, nugget included."""
        return self._cardinal.T, np.diag(self._inverse)

    @override
    def features(self, t: Array, modes: int) -> Features:
        """Return basis^T K^-1 k(X, x), the constant prior and 1 - k^T K^-1 k."""
        k, _ = radial(self._kind, np.abs(t - self.t[:, None]) / self.parameter)
        white = self._whiten @ k
        residual = np.maximum(1 - np.einsum("ib,ib->b", white, white), 0)
        return Features(self._cardinal[:modes] @ k, np.ones_like(t), residual)

    @override
    def slopes(self, t: Array, modes: int) -> Features:
        """Return those of basis^T K^-1 k(X, x), and the variance of the derivative before and after the levels."""
        apart = (t - self.t[:, None]) / self.parameter
        slope = -apart * radial(self._kind, np.abs(apart))[1] / self.parameter
        white = self._whiten @ slope
        prior = np.full_like(t, steepness(self._kind) / self.parameter**2)
        return Features(
            self._cardinal[:modes] @ slope, prior, np.maximum(prior - np.einsum("ib,ib->b", white, white), 0)
        )


def radial(kind: str, r: Array) -> tuple[Array, Array]:
    """Return a stationary correlation k at distances over the length scale, and -k'(r)/r, which is finite at zero."""
    if kind == "rbf":
        k = np.exp(-0.5 * r * r)
        return k, k
    if kind == "matern32":
        decay = np.exp(-np.sqrt(3) * r)
        return (1 + np.sqrt(3) * r) * decay, 3 * decay
    if kind == "matern52":
        s = np.sqrt(5) * r
        decay = np.exp(-s)
        return (1 + s + s * s / 3) * decay, 5 / 3 * (1 + s) * decay
    raise ValueError(f"unknown kernel {kind!r}")


def steepness(kind: str) -> float:
    """Return minus the second derivative at zero of a stationary correlation of unit length scale."""
    return float(radial(kind, np.zeros(()))[1])


def cosine_basis(n: int) -> tuple[Array, Array]:
    """Return the discrete cosine basis on n Chebyshev-Gauss points, (n, n), and the norms that make it T_m, (n,)."""
    weights = np.full(n, np.sqrt(2 / n))
    weights[0] = np.sqrt(1 / n)
    return np.ascontiguousarray(chebyshev.polynomials(chebyshev.gauss_points(n), n).T * weights), weights


def polynomial_basis(t: Array) -> Array:
    """Return polynomials of degree 0 to n-1 that are orthonormal on n points t, columns of an (n, n) matrix."""
    basis, _ = np.linalg.qr(chebyshev.polynomials(t, len(t)).T)
    return np.asarray(basis)
