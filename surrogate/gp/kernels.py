"""Kernels beside scikit-learn's own: the Chebyshev kernel in closed form, and noise of cases that weigh unequally."""

from typing import Any

import numpy as np
from sklearn.gaussian_process.kernels import Hyperparameter, Kernel, WhiteKernel

from approximation.arrays import Array
from surrogate.gp.poisson import FIRST, RHO, Decay, kernel, squares


class Poisson(Kernel):  # type: ignore[misc]  # untyped
    """The product over inputs of 1 + first sum_{m>0} rho^(m-1) T_m T_m, with slopes as in `poisson.most_likely`.

    first, rho: (d,).
    """

    def __init__(self, first: Array, rho: Array) -> None:
        self.first, self.rho = first, rho

    @property
    def hyperparameter_first(self) -> Hyperparameter:
        """As scikit-learn wants it."""
        return Hyperparameter("first", "numeric", FIRST, np.size(self.first))

    @property
    def hyperparameter_rho(self) -> Hyperparameter:
        """As scikit-learn wants it."""
        return Hyperparameter("rho", "numeric", RHO, np.size(self.rho))

    def __call__(self, X: Array, Y: Array | None = None) -> Array:
        """The kernel between points (n, d) and (m, d), or the first themselves."""
        return kernel(self._decay, X.T, (X if Y is None else Y).T)

    def diag(self, X: Array) -> Array:
        """The kernel of every point with itself, (n,)."""
        return squares(self._decay, X.T)

    def is_stationary(self) -> bool:
        """It is not."""
        return False

    @property
    def _decay(self) -> Decay:
        return Decay(np.atleast_1d(self.first), np.atleast_1d(self.rho))


class Noise(WhiteKernel):  # type: ignore[misc]  # untyped
    """Noise of the cases that a process is fitted to: smaller where a case weighs more; of others, as of weight 1.

    weights: (n,), optional.
    """

    def __init__(
        self,
        noise_level: float = 1.0,
        noise_level_bounds: tuple[float, float] = (1e-5, 1e5),
        weights: Array | None = None,
    ) -> None:
        super().__init__(noise_level, noise_level_bounds)
        self.weights = weights

    def __call__(self, X: Array, Y: Array | None = None, eval_gradient: bool = False) -> Any:
        """The noise's covariance, (n, n) of the cases, nothing between these and other points; as scikit-learn's."""
        kernel = super().__call__(X, Y, eval_gradient)
        if Y is not None or self.weights is None:
            return kernel
        share = 1 / self.weights
        if eval_gradient:
            return kernel[0] * share, kernel[1] * share[:, None]
        return kernel * share
