"""Exact Gaussian processes on a few scattered cases: scikit-learn's regressors, one an output."""

import warnings
from collections.abc import Callable, Sequence

import numpy as np
import scipy  # scipy.optimize, slow to import, when something is fitted
from scipy.linalg import cho_solve, solve_triangular
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import Kernel, Sum
from typing_extensions import override

from approximation.arrays import Array
from surrogate.face.core import Posterior
from surrogate.gp.kernels import kernel_slopes, kernel_steepness, whole

ITERATIONS = 25  # of the search for the most likely parameters
NORMAL_95 = 1.959963984540054


class Exact(Posterior):
    """One of scikit-learn's regressors an output.

    The Chebyshev kernel ends at scaled coordinates of 1: beyond, its mean stays and its standard deviation grows with
    the distance, by the slope that the process has at the end.
    """

    parts = 1

    def __init__(self, kernels: Sequence[str], regressors: Sequence[GaussianProcessRegressor], widened: bool) -> None:
        self.kernels, self.regressors, self.widened = list(kernels), list(regressors), widened
        # of named kernels, and in files of former releases, deviations are those of the likelihood
        self.stretch = np.array(
            [_stretch(fitted) if widened and isinstance(fitted.kernel_, Sum) else 1.0 for fitted in regressors]
        )

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        X = t.T
        if weights is None:
            return np.stack([regressor.predict(X) for regressor in self.regressors]), None
        with warnings.catch_warnings():
            # at a training point the variance is zero up to rounding, and scikit-learn warns of its sign
            warnings.filterwarnings("ignore", message="Predicted variances smaller than 0")
            pairs = [regressor.predict(X, return_std=True) for regressor in self.regressors]
        variance = np.stack([std**2 for _, std in pairs])
        beyond = np.maximum(np.abs(X) - 1, 0)
        if self.widened and beyond.any():
            for p, (size, correlation) in enumerate(map(_scaled, self.regressors)):
                if self.kernels[p] == "chebyshev":
                    variance[p] += size * np.einsum("dn,nd->n", kernel_steepness(correlation, X), beyond**2)
        return np.stack([mean for mean, _ in pairs]), (weights[0] * self.stretch**2)[:, None] * variance

    @override
    def slopes(self, t: Array) -> Array:
        X, slopes = t.T, np.empty((len(t), len(self.regressors), t.shape[1]))
        for p, regressor in enumerate(self.regressors):
            size, correlation = _scaled(regressor)
            weights = regressor.alpha_ * size / regressor._y_train_std
            for i, slope in enumerate(kernel_slopes(correlation, X, regressor.X_train_)):
                slopes[i, p] = slope @ weights
        return slopes

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of these derivatives, (d, p, B); noise has no part in them."""
        X, variances = t.T, np.empty((len(t), len(self.regressors), t.shape[1]))
        for p, regressor in enumerate(self.regressors):
            size, correlation = _scaled(regressor)
            prior = kernel_steepness(correlation, X)
            for i, slope in enumerate(kernel_slopes(correlation, X, regressor.X_train_)):
                white = solve_triangular(regressor.L_, slope.T, lower=True)
                known = size / regressor._y_train_std**2 * np.einsum("nb,nb->b", white, white)
                variances[i, p] = weights[0, p] * size * np.maximum(prior[i] - known, 0)
        return np.asarray(variances * self.stretch[:, None] ** 2)


def regressor(
    kernel: str,
    X: Array,
    values: Array,
    theta: Array | None,
    nugget: float,
    restarts: int = 0,
    random_state: int = 0,
    weights: Array | None = None,
    noisy: bool = False,
) -> GaussianProcessRegressor:
    """Return the regressor of outputs on scaled coordinates (n, d), its parameters those given or most likely."""
    whole_kernel = whole(kernel, X.shape[1], noisy, weights)
    if np.ptp(values) == 0 and theta is None:  # nothing tells the parameters
        theta = whole_kernel.theta
    fitted = GaussianProcessRegressor(
        whole_kernel if theta is None else whole_kernel.clone_with_theta(theta),
        alpha=nugget,
        optimizer=_most_likely if theta is None else None,
        n_restarts_optimizer=restarts if theta is None else 0,
        normalize_y=True,
        random_state=random_state,
    )
    with warnings.catch_warnings():
        # a parameter at its bound means an output that is flat or linear along an input, which is no fault
        warnings.simplefilter("ignore", ConvergenceWarning)
        return fitted.fit(X, values)


def _most_likely(cost: Callable[[Array], tuple[float, Array]], start: Array, bounds: Array) -> tuple[Array, float]:
    """Return the parameters of least cost and the cost, by scikit-learn's rule for optimisers."""
    limits = scipy.optimize.Bounds(bounds[:, 0], bounds[:, 1])
    optimum = scipy.optimize.minimize(
        cost, start, method="L-BFGS-B", jac=True, bounds=limits, options={"maxiter": ITERATIONS}
    )
    return optimum.x, float(optimum.fun)


def _scaled(regressor: GaussianProcessRegressor) -> tuple[float, Kernel]:
    """Return the variance of a regressor's process in units of its output, and its correlation."""
    signal = regressor.kernel_.k1 if isinstance(regressor.kernel_, Sum) else regressor.kernel_
    return float(signal.k1.constant_value) * float(regressor._y_train_std) ** 2, signal.k2


def _stretch(regressor: GaussianProcessRegressor) -> float:
    """Return the factor by which 95 % intervals of every case, left out, hold it: at least 1.

    Left-out errors over their deviations: Rasmussen and Williams (2006), equation 5.12.
    """
    inverse = cho_solve((regressor.L_, True), np.eye(len(regressor.L_)))
    scores = np.sort(np.abs(regressor.alpha_) / np.sqrt(np.diag(inverse)))
    rank = min(len(scores), int(np.ceil(0.95 * (len(scores) + 1))))
    return max(1.0, float(scores[rank - 1]) / NORMAL_95)
