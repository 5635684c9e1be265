"""Exact Gaussian processes on some scattered cases: scikit-learn's regressors, kernel and noise by likelihood."""

import warnings
from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_triangular
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Kernel, Matern
from typing_extensions import override

from approximation.arrays import Array
from surrogate.face.posterior import Posterior
from surrogate.gp.factors import radial, steepness
from surrogate.gp.kernels import Noise, Poisson
from surrogate.gp.poisson import kernel as poisson
from surrogate.gp.poisson import most_likely, sum_curvature, sum_slopes, sums

LENGTHS = (1e-2, 1e3)
VARIANCES = (1e-4, 1e5)
NOISE = (1e-10, 1e1)
#: Among which the cases of an output choose.
CHOICES = ("chebyshev", "rbf", "matern52")


class Exact(Posterior):
    """One regressor an output."""

    parts = 1

    def __init__(self, kernels: Sequence[str], regressors: Sequence[GaussianProcessRegressor]) -> None:
        self.kernels, self.regressors = list(kernels), list(regressors)

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        if weights is None:
            return np.stack([regressor.predict(t.T) for regressor in self.regressors]), None
        with warnings.catch_warnings():
            # at a training point the variance is zero up to rounding, and scikit-learn warns of its sign
            warnings.filterwarnings("ignore", message="Predicted variances smaller than 0")
            pairs = [regressor.predict(t.T, return_std=True) for regressor in self.regressors]
        return np.stack([mean for mean, _ in pairs]), weights[0][:, None] * np.stack([std**2 for _, std in pairs])

    @override
    def slopes(self, t: Array) -> Array:
        slopes = np.empty((len(t), len(self.regressors), t.shape[1]))
        for p, (kernel, regressor) in enumerate(zip(self.kernels, self.regressors, strict=True)):
            for i, slope in enumerate(_kernel_slopes(kernel, regressor, t)):
                slopes[i, p] = slope @ regressor.alpha_ * regressor._y_train_std
        return slopes

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of these derivatives, (d, p, B); noise has no part in them."""
        slopes = np.empty((len(t), len(self.regressors), t.shape[1]))
        for p, (kernel, regressor) in enumerate(zip(self.kernels, self.regressors, strict=True)):
            size, priors = weights[0, p] * regressor._y_train_std**2, _slope_priors(kernel, regressor, t)
            for i, slope in enumerate(_kernel_slopes(kernel, regressor, t)):
                white = solve_triangular(regressor.L_, slope.T, lower=True)
                slopes[i, p] = size * (priors[i] - np.einsum("nb,nb->b", white, white))
        return slopes


def regressor(
    kernel: str,
    t: Array,
    values: Array,
    theta: Array | None,
    nugget: float,
    restarts: int = 0,
    random_state: int = 0,
    weights: Array | None = None,
    noisy: bool = False,
) -> GaussianProcessRegressor:
    """Return the regressor of one output."""
    whole = ConstantKernel(1.0, VARIANCES) * _correlation(kernel, t.shape[1])
    if noisy:
        whole = whole + Noise(1e-4, NOISE, weights)
    if theta is None and kernel == "chebyshev":
        theta = _likely(t, values, nugget, weights)
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


def chosen(
    t: Array, values: Array, nugget: float, restarts: int, random_state: int, weights: Array | None
) -> tuple[str, GaussianProcessRegressor]:
    """The kernel under which an output with noise is most likely, each parameter at the price of half ln n (BIC).

    t: (n, d), scaled coordinates of the cases; values: (n,), the output; weights: (n,), what each case counts; None:
    all alike.
    """
    if np.ptp(values) == 0:
        return "rbf", regressor("rbf", t, values, np.log([1.0] * (t.shape[1] + 1) + [NOISE[0]]), nugget, noisy=True)
    tried = {
        kernel: regressor(kernel, t, values, None, nugget, restarts, random_state, weights, noisy=True)
        for kernel in CHOICES
    }

    def score(kernel: str) -> float:
        fitted = tried[kernel]
        return float(fitted.log_marginal_likelihood_value_ - 0.5 * len(fitted.kernel_.theta) * np.log(len(t)))

    best = max(tried, key=score)
    return best, tried[best]


def parameters(kernel: str, inputs: int, noisy: bool) -> int:
    """Number of parameters of a regressor's kernel."""
    return 1 + inputs * (2 if kernel == "chebyshev" else 1) + noisy


def _likely(t: Array, values: Array, nugget: float, weights: Array | None) -> Array:
    """Logarithms of the most likely parameters of the Chebyshev kernel with noise."""
    y = (values - values.mean()) / values.std()
    decay, noise = most_likely(t.T, y[:, None], weights)
    C = poisson(decay, t.T, t.T)
    C[np.diag_indices(len(t))] += noise / (1.0 if weights is None else weights)
    variance = float(y @ np.linalg.solve(C, y)) / len(t)
    return np.asarray(np.log(np.concatenate([[variance], decay.first, decay.rho, [max(noise * variance, nugget)]])))


def _correlation(kernel: str, inputs: int) -> Kernel:
    if kernel == "chebyshev":
        return Poisson(np.full(inputs, 0.3), np.full(inputs, 0.3))
    if kernel == "rbf":
        return RBF(np.ones(inputs), LENGTHS)
    return Matern(np.ones(inputs), LENGTHS, nu=1.5 if kernel == "matern32" else 2.5)


def _kernel_slopes(kernel: str, regressor: GaussianProcessRegressor, t: Array) -> list[Array]:
    """The slopes of k(t, X) with respect to every coordinate of t, each (B, n)."""
    d, theta, X = len(t), np.exp(regressor.kernel_.theta), regressor.X_train_.T
    if kernel == "chebyshev":
        first, rho = theta[1 : 1 + d], theta[1 + d : 1 + 2 * d]
        factors = [1 + first[i] * sums(t[i], X[i], rho[i])[0] for i in range(d)]
        slopes = [first[i] * sum_slopes(t[i], X[i], rho[i]) for i in range(d)]
        return [theta[0] * slopes[i] * _product(factors, i) for i in range(d)]
    lengths = theta[1 : 1 + d]
    differences = [(t[i][:, None] - X[i]) / lengths[i] for i in range(d)]
    # every correlation's slope is -(difference / length) g(r) / length
    shared = theta[0] * radial(kernel, np.sqrt(sum(difference * difference for difference in differences)))[1]
    return [-difference * shared / length for difference, length in zip(differences, lengths, strict=True)]


def _slope_priors(kernel: str, regressor: GaussianProcessRegressor, t: Array) -> list[Array]:
    """The prior variances of the derivatives by every coordinate of t, each (B,)."""
    d, theta = len(t), np.exp(regressor.kernel_.theta)
    if kernel == "chebyshev":
        first, rho = theta[1 : 1 + d], theta[1 + d : 1 + 2 * d]
        factors = [1 + first[i] * np.diag(sums(t[i], t[i], rho[i])[0]) for i in range(d)]
        return [theta[0] * first[i] * sum_curvature(t[i], rho[i]) * _product(factors, i) for i in range(d)]
    return [np.full(t.shape[1], theta[0] * steepness(kernel) / length**2) for length in theta[1 : 1 + d]]


def _product(factors: Sequence[Array], without: int) -> Array:
    """The product of all factors but one."""
    product = np.ones_like(factors[0])
    for i, factor in enumerate(factors):
        if i != without:
            product = product * factor
    return product
