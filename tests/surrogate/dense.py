"""A dense Gaussian process, written from the textbook with numpy's Cholesky: the oracle of the structured ones."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray
from sklearn.gaussian_process.kernels import RBF, Matern

Array = NDArray[np.float64]
FactorKernel = Callable[[Array, Array], Array]


def predict(
    kernels: Sequence[FactorKernel], jitter: Sequence[float], levels: Sequence[Array], values: Array, t: Array
) -> tuple[Array, Array]:
    """Mean and variance at t (B, d) given values (n_1, ..., n_d), zero prior mean, product kernel of unit variance."""
    grid = np.stack(np.meshgrid(*levels, indexing="ij"), axis=-1).reshape(-1, len(levels))
    K = np.ones((len(grid), len(grid)))
    cross = np.ones((len(t), len(grid)))
    prior = np.ones(len(t))
    for f, kernel in enumerate(kernels):
        same = grid[:, f][:, None] == grid[:, f]
        K *= kernel(grid[:, f], grid[:, f]) + jitter[f] * same
        cross *= kernel(t[:, f], grid[:, f])
        prior *= np.array([kernel(one, one)[0, 0] for one in t[:, f : f + 1]])
    L = np.linalg.cholesky(K)
    white = np.linalg.solve(L, cross.T)
    return white.T @ np.linalg.solve(L, values.ravel()), prior - (white**2).sum(axis=0)


def covariance(kernels: Sequence[FactorKernel], jitter: Sequence[float], levels: Sequence[Array], t: Array) -> Array:
    """Posterior covariance between points t (B, d), as `predict` has its diagonal: (B, B)."""
    grid = np.stack(np.meshgrid(*levels, indexing="ij"), axis=-1).reshape(-1, len(levels))
    K, cross, prior = np.ones((len(grid), len(grid))), np.ones((len(t), len(grid))), np.ones((len(t), len(t)))
    for f, kernel in enumerate(kernels):
        K *= kernel(grid[:, f], grid[:, f]) + jitter[f] * (grid[:, f][:, None] == grid[:, f])
        cross *= kernel(t[:, f], grid[:, f])
        prior *= kernel(t[:, f], t[:, f])
    return np.asarray(prior - cross @ np.linalg.solve(K, cross.T))


def chebyshev(levels: int, rho: float, amplitude: float) -> FactorKernel:
    """1 + amplitude sum_{0<m<2n} rho^m T_m T_m, and 1 + amplitude T_1 T_1 on two levels."""
    terms = 2 if levels == 2 else 2 * levels
    weights = amplitude * (np.ones(2) if levels == 2 else rho ** np.arange(terms))
    weights[0] = 1
    return lambda x, y: (chebvander(x, terms - 1) * weights) @ chebvander(y, terms - 1).T


def stationary(kind: str, length_scale: float) -> FactorKernel:
    """Return scikit-learn's kernel of one coordinate."""
    kernel = RBF(length_scale) if kind == "rbf" else Matern(length_scale, nu=1.5 if kind == "matern32" else 2.5)
    return lambda x, y: np.asarray(kernel(x[:, None], y[:, None]))
