"""A dense Gaussian process, written from the textbook with numpy's Cholesky: the oracle of the structured ones."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

Array = NDArray[np.float64]
FactorKernel = Callable[[Array, Array], Array]


def predict(kernels: Sequence[FactorKernel], levels: Sequence[Array], values: Array, t: Array) -> tuple[Array, Array]:
    """Mean and variance at t (B, d) given values (n_1, ..., n_d), zero prior mean, product kernel of unit variance."""
    K, cross, prior = _matrices(kernels, levels, t)
    L = np.linalg.cholesky(K)
    white = np.linalg.solve(L, cross.T)
    return white.T @ np.linalg.solve(L, values.ravel()), np.diag(prior) - (white**2).sum(axis=0)


def covariance(kernels: Sequence[FactorKernel], levels: Sequence[Array], t: Array) -> Array:
    """Posterior covariance between points t (B, d), as `predict` has its diagonal: (B, B)."""
    K, cross, prior = _matrices(kernels, levels, t)
    return np.asarray(prior - cross @ np.linalg.solve(K, cross.T))


def _matrices(kernels: Sequence[FactorKernel], levels: Sequence[Array], t: Array) -> list[Array]:
    """Prior covariances of the grid, of t and the grid, and of t."""
    grid = np.stack(np.meshgrid(*levels, indexing="ij"), axis=-1).reshape(-1, len(levels))
    pairs = [(grid, grid), (t, grid), (t, t)]
    return [np.prod([k(u[:, f], v[:, f]) for f, k in enumerate(kernels)], axis=0) for u, v in pairs]


def chebyshev(levels: int, rho: float, amplitude: float) -> FactorKernel:
    """1 + amplitude sum_{0<m<2n} rho^m T_m T_m, and 1 + amplitude T_1 T_1 on two levels."""
    terms = 2 if levels == 2 else 2 * levels
    weights = amplitude * (np.ones(2) if levels == 2 else rho ** np.arange(terms))
    weights[0] = 1
    return lambda x, y: (chebvander(x, terms - 1) * weights) @ chebvander(y, terms - 1).T
