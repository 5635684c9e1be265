"""Exact Gaussian processes with stationary kernels on some scattered cases: scikit-learn's regressors."""

import warnings
from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_triangular
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Kernel, Matern

from approximation.arrays import Array
from surrogate.gp.factors import steepness

LENGTHS = (1e-2, 1e3)
VARIANCES = (1e-4, 1e5)


class Stationary:
    """One regressor an output, each with a length scale an input.

    Parameters
    ----------
    kernel : {"matern52", "matern32", "rbf"}
        Correlation function.
    regressors : sequence of GaussianProcessRegressor
        Fitted, one an output.
    """

    parts = 1

    def __init__(self, kernel: str, regressors: Sequence[GaussianProcessRegressor]) -> None:
        self._kernel, self.regressors = kernel, list(regressors)

    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        """Return mean and weighted variance at scaled coordinates (d, B): (p, B) each."""
        if weights is None:
            return np.stack([regressor.predict(t.T) for regressor in self.regressors]), None
        with warnings.catch_warnings():
            # at a training point the variance is zero up to rounding, and scikit-learn warns of its sign
            warnings.filterwarnings("ignore", message="Predicted variances smaller than 0")
            pairs = [regressor.predict(t.T, return_std=True) for regressor in self.regressors]
        return np.stack([mean for mean, _ in pairs]), weights[0][:, None] * np.stack([std**2 for _, std in pairs])

    def slopes(self, t: Array) -> Array:
        """Return the derivatives of the means by the scaled coordinates, (d, p, B)."""
        slopes = np.empty((len(t), len(self.regressors), t.shape[1]))
        for p, regressor in enumerate(self.regressors):
            for i, slope in enumerate(self._kernel_slopes(regressor, t)):
                slopes[i, p] = slope @ regressor.alpha_ * regressor._y_train_std
        return slopes

    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of these derivatives, (d, p, B)."""
        slopes = np.empty((len(t), len(self.regressors), t.shape[1]))
        for p, regressor in enumerate(self.regressors):
            variance, lengths = np.exp(regressor.kernel_.theta[0]), np.exp(regressor.kernel_.theta[1:])
            size = weights[0, p] * regressor._y_train_std**2
            for i, slope in enumerate(self._kernel_slopes(regressor, t)):
                white = solve_triangular(regressor.L_, slope.T, lower=True)
                prior = variance * steepness(self._kernel) / lengths[i] ** 2
                slopes[i, p] = size * (prior - np.einsum("nb,nb->b", white, white))
        return slopes

    def _kernel_slopes(self, regressor: GaussianProcessRegressor, t: Array) -> list[Array]:
        """Return the slopes of k(t, X) with respect to every coordinate of t, each (B, n)."""
        variance, lengths = np.exp(regressor.kernel_.theta[0]), np.exp(regressor.kernel_.theta[1:])
        differences = [(t[i][:, None] - regressor.X_train_[:, i]) / lengths[i] for i in range(len(t))]
        # every correlation's slope is -(difference / length) g(r) / length
        shared = variance * self._radial(np.sqrt(sum(d * d for d in differences)))
        return [-difference * shared / length for difference, length in zip(differences, lengths, strict=True)]

    def _radial(self, r: Array) -> Array:
        if self._kernel == "rbf":
            return np.asarray(np.exp(-0.5 * r * r))
        if self._kernel == "matern32":
            return np.asarray(3 * np.exp(-np.sqrt(3) * r))
        return np.asarray(5 / 3 * (1 + np.sqrt(5) * r) * np.exp(-np.sqrt(5) * r))


def regressor(
    kernel: str, t: Array, values: Array, theta: Array | None, nugget: float, restarts: int, random_state: int
) -> GaussianProcessRegressor:
    """Return the regressor of one output: scaled coordinates (n, d), values (n,); `theta` is searched for without."""
    whole = ConstantKernel(1.0, VARIANCES) * _correlation(kernel, t.shape[1])
    made = GaussianProcessRegressor(
        whole if theta is None else whole.clone_with_theta(theta),
        alpha=nugget,
        optimizer="fmin_l_bfgs_b" if theta is None else None,
        n_restarts_optimizer=restarts if theta is None else 0,
        normalize_y=True,
        random_state=random_state,
    )
    with warnings.catch_warnings():
        # a length scale at its bound means an output that is flat or linear along an input, which is no fault
        warnings.simplefilter("ignore", ConvergenceWarning)
        return made.fit(t, values)


def _correlation(kernel: str, inputs: int) -> Kernel:
    if kernel == "rbf":
        return RBF(np.ones(inputs), LENGTHS)
    return Matern(np.ones(inputs), LENGTHS, nu=1.5 if kernel == "matern32" else 2.5)
