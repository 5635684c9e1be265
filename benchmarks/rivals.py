"""Other regressors behind one face: fit to scattered cases, answer mean and standard deviation where they have one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from importlib.util import find_spec
from typing import Any

import numpy as np
from scipy.interpolate import NdBSpline, RBFInterpolator, make_interp_spline
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.neural_network import MLPRegressor

from approximation.arrays import Array
from approximation.chebyshev import coefficients, polynomials
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.use.validation import contracted

#: Standard deviations to either side that hold 95 % of a normal variable.
REACH = float(Normal().ends(NOMINAL)[1, 0])
#: Mean (n, p) at scaled inputs (n, d) and, where asked for and there is one, its standard deviation (n, p).
Predict = Callable[[Array, bool], tuple[Array, Array | None]]
#: From scaled inputs (n, d) and standardised outputs (n, p) to a predictor.
Fit = Callable[[Array, Array], Predict]


def standardised(values: Array, fit: Callable[[Array], Predict]) -> Predict:
    """Return a predictor of values that is fitted to them with mean zero and deviation one.

    values: (..., p), the outputs.
    """
    case_axes = tuple(range(values.ndim - 1))
    offset, scale = values.mean(axis=case_axes), values.std(axis=case_axes)
    predict = fit((values - offset) / scale)

    def scaled(t: Array, with_std: bool) -> tuple[Array, Array | None]:
        mean, std = predict(t, with_std)
        return offset + scale * mean, None if std is None else scale * std

    return scaled


def scikit_learn(t: Array, y: Array, noisy: bool = False) -> Predict:
    """One Gaussian process an output, RBF kernel with a length scale an input, marginal likelihood.

    t: (n, d), scaled coordinates of the cases; y: (n, p), the outputs.
    """
    kernel = ConstantKernel(1.0, (1e-4, 1e5)) * RBF(np.ones(t.shape[1]), (1e-2, 1e3))
    if noisy:
        kernel = kernel + WhiteKernel(1e-4, (1e-10, 1.0))
    models = [GaussianProcessRegressor(kernel, alpha=1e-10, random_state=0).fit(t, column) for column in y.T]

    def predict(X: Array, with_std: bool) -> tuple[Array, Array | None]:
        if not with_std:
            return np.stack([model.predict(X) for model in models], axis=1), None
        pairs = [model.predict(X, return_std=True) for model in models]
        return np.stack([mean for mean, _ in pairs], axis=1), np.stack([std for _, std in pairs], axis=1)

    return predict


def _perceptron(t: Array, y: Array) -> Predict:
    """Neural network of scikit-learn, two layers of 64, all outputs at once; it has no standard deviation."""
    model = MLPRegressor(hidden_layer_sizes=(64, 64), solver="lbfgs", max_iter=1000, tol=1e-7, random_state=0).fit(t, y)
    return lambda X, with_std: (np.asarray(model.predict(X)), None)


def _rbf_interpolator(t: Array, y: Array) -> Predict:
    """Scipy's interpolator, quintic, all cases at once; it has no standard deviation."""
    model = RBFInterpolator(t, y, kernel="quintic")
    return lambda X, with_std: (np.asarray(model(X)), None)


def smt(t: Array, y: Array, noisy: bool = False) -> Predict:
    """Kriging of the Surrogate Modeling Toolbox, one model an output, one start of its search.

    t: (n, d), scaled coordinates of the cases; y: (n, p), the outputs.
    """
    from smt.surrogate_models import KRG

    models = []
    for column in y.T:
        model = KRG(theta0=[1e-1] * t.shape[1], print_global=False, n_start=1, eval_noise=noisy)
        model.set_training_values(t, column)
        model.train()
        models.append(model)

    def predict(X: Array, with_std: bool) -> tuple[Array, Array | None]:
        mean = np.concatenate([model.predict_values(X) for model in models], axis=1)
        if not with_std:
            return mean, None
        noise = [np.ravel(model.optimal_noise) if noisy else 0.0 for model in models]
        variance = np.concatenate(
            [model.predict_variances(X) + nugget for model, nugget in zip(models, noise, strict=True)], axis=1
        )
        return mean, np.sqrt(np.maximum(variance, 0.0))

    return predict


def openturns(t: Array, y: Array) -> Predict:
    """Gaussian process of OpenTURNS, squared exponential, one model an output.

    t: (n, d), scaled coordinates of the cases; y: (n, p), the outputs.
    """
    import openturns as ot

    models = []
    for column in y.T:
        basis = ot.ConstantBasisFactory(t.shape[1]).build()
        kernel = ot.SquaredExponential(t.shape[1])
        fitted = ot.GaussianProcessFitter(ot.Sample(t), ot.Sample(column[:, None]), kernel, basis)
        fitted.run()
        regression = ot.GaussianProcessRegression(fitted.getResult())
        regression.run()
        models.append(regression.getResult())

    def predict(X: Array, with_std: bool) -> tuple[Array, Array | None]:
        places = ot.Sample(X)
        mean = np.concatenate([np.array(model.getMetaModel()(places)) for model in models], axis=1)
        if not with_std:
            return mean, None
        variances = [
            ot.GaussianProcessConditionalCovariance(model).getConditionalMarginalVariance(places) for model in models
        ]
        return mean, np.sqrt(np.maximum(np.concatenate([np.array(variance) for variance in variances], axis=1), 0.0))

    return predict


def tinygp(t: Array, y: Array) -> Predict:
    """Gaussian process of tinygp, squared exponential, a length scale an input; likelihood maximised by scipy."""
    import jax
    from scipy.optimize import minimize
    from tinygp import GaussianProcess, kernels, transforms

    jax.config.update("jax_enable_x64", True)

    def process(theta: Array) -> Any:
        kernel = jax.numpy.exp(theta[0]) * transforms.Linear(jax.numpy.exp(-theta[2:]), kernels.ExpSquared())
        return GaussianProcess(kernel, t, diag=jax.numpy.exp(theta[1]))

    def fitted(column: Array) -> Array:
        loss = jax.jit(jax.value_and_grad(lambda theta: -process(theta).log_probability(column)))

        def with_slope(theta: Array) -> tuple[float, Array]:
            value, slope = loss(theta)
            return float(value), np.asarray(slope, dtype=np.float64)

        bounds = [(-10.0, 12.0), (-25.0, 0.0), *[(-5.0, 7.0)] * t.shape[1]]
        start = np.concatenate([[0.0, -9.0], np.zeros(t.shape[1])])
        return np.asarray(minimize(with_slope, start, jac=True, bounds=bounds).x)

    fits = [(fitted(column), column) for column in y.T]

    def predict(X: Array, with_std: bool) -> tuple[Array, Array | None]:
        both = [process(theta).predict(column, X, return_var=True) for theta, column in fits]
        mean, variance = (np.stack([np.asarray(pair[part]) for pair in both], axis=1) for part in (0, 1))
        return mean, np.sqrt(np.maximum(variance, 0.0)) if with_std else None

    return predict


@dataclass(frozen=True)
class Rival:
    """A method: its name, the package that it needs, its fit, and the numbers of cases that it can be given."""

    name: str
    package: str
    fit: Fit
    cases: tuple[int, ...]


RIVALS = [
    Rival("scikit-learn GP (RBF)", "sklearn", scikit_learn, (256, 1024)),
    Rival("scikit-learn MLP", "sklearn", _perceptron, (1024, 4096)),
    Rival("scipy RBFInterpolator", "scipy", _rbf_interpolator, (256, 1024, 4096)),
    Rival("SMT Kriging", "smt", smt, (64, 128)),
]


def installed(rivals: Sequence[Rival] = RIVALS) -> tuple[list[Rival], list[str]]:
    """Return the rivals that can run here, and the names of those left out."""
    present = [rival for rival in rivals if find_spec(rival.package)]
    return present, [rival.name for rival in rivals if rival not in present]


#: From the scaled levels of every factor and standardised outputs (n_1, ..., n_d, p) to a predictor.
GridFit = Callable[[Sequence[Array], Array], Predict]


def _chebyshev(levels: Sequence[Array], values: Array) -> Predict:
    """The tensor polynomial through all cases; the transform belongs to the fit."""
    tensor = reduce(coefficients, range(len(levels)), values)

    def predict(X: Array, with_std: bool) -> tuple[Array, None]:
        rows = [polynomials(column, len(nodes)).T for column, nodes in zip(X.T, levels, strict=True)]
        return contracted(tensor, rows), None

    return predict


def _cubic_spline(levels: Sequence[Array], values: Array) -> Predict:
    """The tensor product of cubic splines, not-a-knot; of lower degree along a factor with fewer than four levels."""
    knots, degrees, spline_coefficients = [], [min(3, len(nodes) - 1) for nodes in levels], values
    for axis, (nodes, degree) in enumerate(zip(levels, degrees, strict=True)):
        spline = make_interp_spline(nodes, spline_coefficients, degree, axis=axis)
        knots.append(spline.t)
        spline_coefficients = np.moveaxis(spline.c, 0, axis)  # the spline keeps its axis first
    interpolant = NdBSpline(tuple(knots), np.ascontiguousarray(spline_coefficients), tuple(degrees))
    return lambda X, with_std: (np.asarray(interpolant(X)), None)


GRID_RIVALS: dict[str, GridFit] = {
    "tensor Chebyshev interpolation": _chebyshev,
    "cubic grid spline (scipy NdBSpline)": _cubic_spline,
}
