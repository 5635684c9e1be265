"""Other regressors behind one face: fit to scattered cases, answer mean and standard deviation where they have one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from importlib.util import find_spec
from typing import Any

import numpy as np
from scipy.interpolate import NdBSpline, RBFInterpolator, make_interp_spline
from scipy.optimize import minimize
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


def _gpytorch(t: Array, y: Array) -> Predict:
    """Exact batch of independent Gaussian processes in double precision, 100 steps of Adam."""
    import gpytorch as gp
    import torch

    x, targets = torch.tensor(t), torch.tensor(np.ascontiguousarray(y.T))
    batch = torch.Size([targets.shape[0]])

    class Model(gp.models.ExactGP):  # type: ignore[misc]  # untyped
        def __init__(self, likelihood: Any) -> None:
            super().__init__(x.expand(*batch, *x.shape), targets, likelihood)
            self.mean = gp.means.ConstantMean(batch_shape=batch)
            base = gp.kernels.RBFKernel(ard_num_dims=t.shape[1], batch_shape=batch)
            self.kernel = gp.kernels.ScaleKernel(base, batch_shape=batch)

        def forward(self, inputs: Any) -> Any:
            return gp.distributions.MultivariateNormal(self.mean(inputs), self.kernel(inputs))

    noise = gp.constraints.GreaterThan(1e-8)
    likelihood = gp.likelihoods.GaussianLikelihood(batch_shape=batch, noise_constraint=noise)
    likelihood.noise = 1e-6
    model = Model(likelihood).double()
    model.train()
    optimiser = torch.optim.Adam(model.parameters(), lr=0.1)
    loss = gp.mlls.ExactMarginalLogLikelihood(likelihood, model)
    for _ in range(100):
        optimiser.zero_grad()
        value = -loss(model(x.expand(*batch, *x.shape)), targets).sum()
        value.backward()
        optimiser.step()
    model.eval()
    likelihood.eval()

    def predict(X: Array, with_std: bool) -> tuple[Array, Array | None]:
        with torch.no_grad(), gp.settings.fast_pred_var():
            answer = model(torch.tensor(X).expand(*batch, *X.shape))
            return answer.mean.numpy().T, np.sqrt(answer.variance.numpy().T) if with_std else None

    return predict


@dataclass(frozen=True)
class Rival:
    """A method: its name, the package that it needs, whether it gives a standard deviation, its fit, and sizes."""

    name: str
    package: str
    has_std: bool
    fit: Fit
    cases: tuple[int, ...]


RIVALS = [
    Rival("scikit-learn GP (RBF)", "sklearn", True, scikit_learn, (256, 1024)),
    Rival("scikit-learn MLP", "sklearn", False, _perceptron, (1024, 4096)),
    Rival("scipy RBFInterpolator", "scipy", False, _rbf_interpolator, (256, 1024, 4096)),
    Rival("SMT Kriging", "smt", True, smt, (64, 128)),
    Rival("GPyTorch exact GP", "gpytorch", True, _gpytorch, (256, 512)),
]


def installed() -> tuple[list[Rival], list[str]]:
    """Return the rivals that can run here, and the names of those left out."""
    present = [rival for rival in RIVALS if find_spec(rival.package)]
    return present, [rival.name for rival in RIVALS if rival not in present]


#: From the scaled levels of every factor and standardised outputs (n_1, ..., n_d, p) to a predictor.
GridFit = Callable[[Sequence[Array], Array], Predict]
# Noise of the Kronecker process, as a share of its variance: what double precision needs.
_NOISE = 1e-10


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


def kronecker(levels: Sequence[Array], values: Array) -> Predict:
    """A Gaussian process an output with an RBF kernel a factor, by marginal likelihood, in plain numpy.

    The covariance is a Kronecker product (Y. Saatci, Scalable Inference for Structured Gaussian Process Models, 2011,
    chapter 5): eigenvectors of every factor's matrix diagonalise it, and mean and variance are contractions over the
    whole grid.

    levels: sequence of ndarray, shape (n_f,), of every factor in [-1, 1]; values: (n_1, ..., n_d, p), the outputs.
    """
    parts = [_process(levels, output_values) for output_values in np.moveaxis(values, -1, 0)]

    def predict(X: Array, with_std: bool) -> tuple[Array, Array | None]:
        pairs = [part(X, with_std) for part in parts]
        mean = np.stack([mean for mean, _ in pairs], axis=1)
        return mean, np.stack([std for _, std in pairs], axis=1) if with_std else None

    return predict


def _process(levels: Sequence[Array], values: Array) -> Callable[[Array, bool], tuple[Array, Array]]:
    def decomposed(logs: Array) -> tuple[list[Array], Array, Array]:
        """Eigenvectors, the eigenvalues of the whole, and the data in the eigenvectors."""
        pairs = [np.linalg.eigh(_rbf(nodes, nodes, np.exp(log))) for nodes, log in zip(levels, logs, strict=True)]
        vectors = [vector for _, vector in pairs]
        spectrum = reduce(np.multiply.outer, [np.maximum(value, 0.0) for value, _ in pairs]) + _NOISE
        return vectors, spectrum, _transformed(values, vectors)

    def loss(logs: Array) -> float:
        _, spectrum, data = decomposed(logs)
        # the variance of the process is profiled out
        return float(values.size * np.log((data**2 / spectrum).mean()) + np.log(spectrum).sum())

    bounds = [(np.log(0.2), np.log(20.0))] * len(levels)
    fit = minimize(
        loss, np.full(len(levels), 0.7), method="L-BFGS-B", bounds=bounds, options={"maxiter": 50, "eps": 1e-4}
    )
    vectors, spectrum, data = decomposed(fit.x)
    variance = float((data**2 / spectrum).mean())
    weights = _transformed(data / spectrum, [vector.T for vector in vectors])

    def predict(X: Array, with_std: bool) -> tuple[Array, Array]:
        near = [_rbf(column, nodes, np.exp(log)) for column, nodes, log in zip(X.T, levels, fit.x, strict=True)]
        mean = contracted(weights[..., None], near)[:, 0]
        if not with_std:
            return mean, mean
        squares = [(rows @ vector) ** 2 for rows, vector in zip(near, vectors, strict=True)]
        known = contracted(1 / spectrum[..., None], squares)[:, 0]
        return mean, np.sqrt(variance * np.maximum(1 - known, 0.0))

    return predict


def _rbf(a: Array, b: Array, length: float) -> Array:
    return np.asarray(np.exp(-0.5 * ((a[:, None] - b) / length) ** 2))


def _transformed(values: Array, bases: Sequence[Array]) -> Array:
    """Multiply every axis by the transpose of its basis."""
    for basis in bases:
        values = np.tensordot(values, basis, (0, 0))  # the axis moves to the end, so after all the order is the old
    return values


GRID_RIVALS: dict[str, GridFit] = {
    "tensor Chebyshev interpolation": _chebyshev,
    "cubic grid spline (scipy NdBSpline)": _cubic_spline,
    "Kronecker RBF GP (numpy)": kronecker,
}
