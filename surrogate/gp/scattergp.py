"""Gaussian processes on scattered cases: one scikit-learn regressor per output, with the Chebyshev kernel.

The kernel is the product over inputs j of 1 + first_j sum_{0<m<=DEGREE} rho_j^(m-1) T_m(x) T_m(y).
"""

import warnings
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Self

import numpy as np
import scipy  # scipy.optimize, slow to import, when something is fitted
import xarray as xr
from scipy.linalg import cho_solve, solve_triangular
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Hyperparameter, Kernel, WhiteKernel
from typing_extensions import override

from approximation import products
from approximation.arrays import Array, Indices
from surrogate.data.factorial import output_names, text_attrs
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.face.model import GaussianProcess
from surrogate.intervals.distribution import NOMINAL, Normal

DEGREE = 128  # highest degree of the kernel; variation along an input beyond it counts as noise
FIRST, RHO = (1e-6, 1e3), (1e-3, 0.97)  # ranges of the parameters first_j and rho_j
VARIANCES, NOISE = (1e-6, 1e6), (1e-12, 1e1)  # ranges of signal and noise, relative to the output's variance


class Chebyshev(Kernel):  # type: ignore[misc]  # untyped
    """The Chebyshev kernel on [-1, 1]^d with parameters (d,); coordinates beyond the ends are clipped."""

    def __init__(self, first: Array, rho: Array) -> None:
        self.first, self.rho = first, rho

    @property
    def hyperparameter_first(self) -> Hyperparameter:
        """Range of the coefficients of T_1, for scikit-learn."""
        return Hyperparameter("first", "numeric", FIRST, np.size(self.first))

    @property
    def hyperparameter_rho(self) -> Hyperparameter:
        """Range of the decays, for scikit-learn."""
        return Hyperparameter("rho", "numeric", RHO, np.size(self.rho))

    def __call__(self, X: Array, Y: Array | None = None, eval_gradient: bool = False) -> Any:
        """Return the kernel between points (n, d) and (m, d), and its derivatives by the parameters' logarithms."""
        first, decay, by_rho = self._weights()
        left, right = _polynomials(X), _polynomials(X if Y is None else Y).swapaxes(1, 2)
        sums = first * (left @ (decay * right))
        kernel = np.prod(1 + sums, axis=0)
        if not eval_gradient:
            return kernel
        others = _others(1 + sums)
        slopes = np.concatenate([others * sums, others * first * (left @ (by_rho * right))])
        return kernel, np.moveaxis(slopes, 0, -1)

    def diag(self, X: Array) -> Array:
        """Return the kernel of every point with itself, (n,)."""
        return np.asarray(np.prod(self._diagonals(X), axis=0))

    def is_stationary(self) -> bool:
        """Return False: the kernel depends on position."""
        return False

    def slopes(self, X: Array, Y: Array) -> Array:
        """Return the derivatives of the kernel by each coordinate of X, (d, n, m)."""
        first, decay, _ = self._weights()
        right = decay * _polynomials(Y).swapaxes(1, 2)
        slopes = _derivatives(X) * (np.abs(X.T) <= 1)[..., None]
        return np.asarray(_others(1 + first * (_polynomials(X) @ right)) * first * (slopes @ right))

    def steepness(self, X: Array) -> Array:
        """Return the prior variances of the derivatives by each coordinate at points (n, d): (d, n)."""
        first, decay, _ = self._weights()
        return np.asarray(_others(self._diagonals(X)) * (first * (_derivatives(X) ** 2 @ decay))[..., 0])

    def _weights(self) -> tuple[Array, Array, Array]:
        """Return `first`, (d, 1, 1), the powers of rho, and their derivatives by its logarithm, (d, DEGREE, 1) each."""
        first, rho = (np.reshape(part, (-1, 1, 1)) for part in (self.first, self.rho))
        power = np.arange(DEGREE)[:, None]
        decay = rho**power
        return first, decay, power * decay

    def _diagonals(self, X: Array) -> Array:
        """Return the factors of the kernel of every point (n, d) with itself, (d, n)."""
        first, decay, _ = self._weights()
        return np.asarray(1 + (first * (_polynomials(X) ** 2 @ decay))[..., 0])


class Noise(WhiteKernel):  # type: ignore[misc]  # untyped
    """Noise of the training cases, whose variance is divided by the weights (n,) of the cases."""

    def __init__(
        self, noise_level: float = 1e-4, noise_level_bounds: tuple[float, float] = NOISE, weights: Array | None = None
    ) -> None:
        super().__init__(noise_level, noise_level_bounds)
        self.weights = weights

    def __call__(self, X: Array, Y: Array | None = None, eval_gradient: bool = False) -> Any:
        """Return the covariance of the noise, (n, n), zero between the cases and other points."""
        kernel = super().__call__(X, Y, eval_gradient)
        if Y is not None or self.weights is None:
            return kernel
        share = 1 / self.weights
        if eval_gradient:
            return kernel[0] * share, kernel[1] * share[:, None]
        return kernel * share


def whole(inputs: int, weights: Array | None = None) -> Kernel:
    """Return the Chebyshev kernel times a variance, with noise of weighted cases."""
    correlation = Chebyshev(np.full(inputs, 0.3), np.full(inputs, 0.3))
    return ConstantKernel(1.0, VARIANCES) * correlation + Noise(weights=weights)


def _others(factors: Array) -> Array:
    """Return for every factor the product of all others, (d, ...)."""
    ones = np.ones_like(factors[:1])
    before = np.multiply.accumulate(np.concatenate([ones, factors[:-1]]))
    after = np.multiply.accumulate(np.concatenate([ones, factors[:0:-1]]))[::-1]
    return np.asarray(before * after)


def _polynomials(X: Array) -> Array:
    """Return T_1 .. T_DEGREE of the coordinates of points (n, d), clipped to [-1, 1]: (d, n, DEGREE)."""
    return np.moveaxis(products.polynomials(np.clip(X.T, -1, 1), DEGREE + 1)[1:], 0, -1)


def _derivatives(X: Array) -> Array:
    """Return the derivatives of `_polynomials`, (d, n, DEGREE)."""
    t = np.clip(X.T, -1, 1)
    return np.moveaxis(products.derivatives(t, products.polynomials(t, DEGREE + 1))[1:], 0, -1)


#: Most cases from which the kernel's parameters are learnt, and of a process: the cost grows with their cube.
SUBSET, MOST = 500, 3000
#: Half-width of the kernel's range in half-widths of the box, so that it covers points just outside of the box.
REACH = 1.25
_ITERATIONS = 25  # of the search for the most likely parameters


class ScatterGP(GaussianProcess):
    """Gaussian process on scattered cases, any number of outputs.

    Every output is a scikit-learn regressor with the Chebyshev kernel on a box that is a quarter wider, and estimated
    noise. More than 500 cases have the kernel's parameters of 500 random ones. Standard deviations are those of a new
    case, noise included, widened until the 95 % intervals of left-out cases hold; they grow outside of the box. The
    `_std` of a gradient has no noise.

    Parameters
    ----------
    inputs : sequence of Input, optional
        Inputs with box and scale; by default the variables that are not `outputs`, with the range of the cases.
    outputs : sequence of str, optional
        Outputs, by default the variables that are not `inputs`. One of the two must be given.
    nugget : float
        Added to the diagonal, relative to the variance of the output, besides the estimated noise.
    random_state : int
        Seed of the choice of the cases from which the kernel's parameters are learnt.

    Attributes
    ----------
    regressors_ : list of GaussianProcessRegressor
        The fitted regressors, one per output.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from surrogate import Input, ScatterGP
    >>> rng = np.random.default_rng(0)
    >>> x, y = rng.uniform(-1, 1, (2, 200))
    >>> cases = xr.Dataset({"x": ("case", x), "y": ("case", y)})
    >>> cases["f"] = ("case", np.exp(x * y) + 0.1 * rng.normal(size=200))
    >>> model = ScatterGP(inputs=[Input("x", -1, 1), Input("y", -1, 1)]).fit(cases)
    >>> found = model.predict({"x": 0.5, "y": 0.4})
    >>> bool(abs(found["f"] - np.exp(0.2)) < 0.05), bool(abs(found["f_std"] - 0.1) < 0.03)
    (True, True)
    """

    engine: ClassVar[str] = "scatter"
    parts: ClassVar[int] = 1
    regressors_: list[GaussianProcessRegressor]
    _stretch: Array  # factors that widen the deviations; (p,)

    def __init__(
        self,
        inputs: Sequence[Input] | None = None,
        outputs: Sequence[str] | None = None,
        nugget: float = 1e-10,
        random_state: int = 0,
    ) -> None:
        self.inputs = inputs
        self.outputs = outputs
        self.nugget = nugget
        self.random_state = random_state

    def fit(self, X: xr.Dataset, weights: Array | None = None) -> Self:
        """Fit to scattered cases.

        Parameters
        ----------
        X : Dataset
            One dimension (such as `case`); inputs and outputs are variables over it.
        weights : ndarray, shape (n,), optional
            Positive numbers of cases that each counts as: the variance of its noise is divided by them.

        Raises
        ------
        ValueError
            A data set of other dimensions, missing variables, values that are not finite, a case outside the box, more
            than 3,000 cases.
        """
        inputs, names = self._roles(X)
        columns = {name: _column(X, name) for name in [*(input_.name for input_ in inputs), *names]}
        for factor_input in inputs:
            low, high = columns[factor_input.name].min(), columns[factor_input.name].max()
            if low < factor_input.low or high > factor_input.high:
                wrong = low if low < factor_input.low else high
                raise ValueError(
                    f"input {factor_input.name!r} has the value {wrong:g} outside its range {factor_input.range_text()}"
                )
        self.inputs_, self.outputs_ = tuple(inputs), tuple(names)
        self.attrs_ = {name: text_attrs(X[name]) for name in names}
        self.calibration_ = None
        self.points_ = np.stack([columns[input_.name] for input_ in inputs], axis=1)
        self.values_, self.weights_ = np.stack([columns[name] for name in names], axis=1), weights
        self.cases_ = len(self.points_)
        if self.cases_ > MOST:
            raise ValueError(f"{self.cases_} scattered cases are more than {MOST}; a factorial has no such limit")
        subset = np.sort(np.random.default_rng(self.random_state).permutation(self.cases_)[:SUBSET])
        self._condition([self._most_likely(subset, column) for column in self.values_.T])
        return self

    def _most_likely(self, subset: Indices, values: Array) -> Array:
        """Return the logarithms of the kernel's most likely parameters for the cases `subset`."""
        kernel = whole(len(self.inputs_), None if self.weights_ is None else self.weights_[subset])
        if np.ptp(values[subset]) == 0:  # the parameters have no influence
            return np.asarray(kernel.theta)
        with warnings.catch_warnings():
            # a parameter at its bound means an output that is flat or linear along an input, which is no fault
            warnings.simplefilter("ignore", ConvergenceWarning)
            fitted = self._regressor(kernel, _least).fit(self._scaled(self.points_[subset]), values[subset])
        return np.asarray(fitted.kernel_.theta)

    def _condition(self, thetas: Sequence[Array]) -> None:
        """Condition the processes with parameters `thetas`, one array per output, on all cases."""
        kernel, X = whole(len(self.inputs_), self.weights_), self._scaled(self.points_)
        self.regressors_ = [
            self._regressor(kernel.clone_with_theta(theta), None).fit(X, values)
            for theta, values in zip(thetas, self.values_.T, strict=True)
        ]
        self._stretch = np.array([_stretch(regressor) for regressor in self.regressors_])

    def _regressor(self, kernel: Kernel, optimizer: object) -> GaussianProcessRegressor:
        return GaussianProcessRegressor(kernel, alpha=self.nugget, optimizer=optimizer, normalize_y=True)

    def _scaled(self, points: Array) -> Array:
        return np.asarray(unit_coordinates(self.inputs_, points).T / REACH)

    @override
    def state(self) -> xr.Dataset:
        weights = np.ones(self.cases_) if self.weights_ is None else self.weights_
        return xr.Dataset(
            {
                "point": (("case", "input"), self.points_),
                "value": (("case", "output"), self.values_),
                "weight": ("case", weights),
                "theta": (("output", "theta_index"), [regressor.kernel_.theta for regressor in self.regressors_]),
            },
            attrs={"nugget": self.nugget, "random_state": self.random_state, "reach": REACH},
        )

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        attrs = stored.attrs
        if float(attrs.get("reach", 1.0)) != REACH or "feature_degree" in stored:
            raise ValueError("scattered cases of a kernel that is not read any more: fit them again")
        model = cls(inputs, tuple(outputs), float(attrs["nugget"]), int(attrs["random_state"]))
        model.inputs_, model.outputs_, model.attrs_ = inputs, tuple(outputs), outputs
        model.points_ = stored["point"].transpose("case", "input").values
        model.values_ = stored["value"].transpose("case", "output").values
        model.weights_, model.cases_ = stored["weight"].values, len(model.points_)
        theta = stored["theta"].transpose("output", "theta_index").values
        if theta.shape != (len(outputs), len(whole(len(inputs)).theta)):
            raise ValueError(f"theta has {theta.shape[1]} columns for {len(inputs)} inputs")
        model._condition(list(theta))
        return model

    def _roles(self, X: xr.Dataset) -> tuple[Sequence[Input], list[str]]:
        if self.inputs is not None:
            return self.inputs, output_names(X, self.outputs, exclude=[input_.name for input_ in self.inputs])
        if self.outputs is None:
            raise ValueError(
                "scattered cases do not tell inputs from outputs; give inputs=[Input(...), ...] or outputs=[...]"
            )
        names = [str(name) for name in X.data_vars if name not in self.outputs]
        if not names:
            raise ValueError("the data set has no variable beside the outputs")
        columns = {name: _column(X, name) for name in names}
        inputs = [
            Input(name, float(v.min()), float(v.max()), "linear", **text_attrs(X[name])) for name, v in columns.items()
        ]
        return inputs, output_names(X, self.outputs, exclude=())

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array]:
        """Return means and variances; beyond the kernel's range means stay and deviations grow with the prior slope."""
        X = t.T / REACH
        if weights is None:
            mean = np.stack([regressor.predict(X) for regressor in self.regressors_])
            return mean, np.zeros_like(mean)
        with warnings.catch_warnings():
            # at a training point the variance is zero up to rounding, and scikit-learn warns of a negative one
            warnings.filterwarnings("ignore", message="Predicted variances smaller than 0")
            pairs = [regressor.predict(X, return_std=True) for regressor in self.regressors_]
        variance = np.stack([std**2 for _, std in pairs])
        beyond = np.maximum(np.abs(X) - 1, 0)
        if beyond.any():
            for p, (size, kernel) in enumerate(map(_process, self.regressors_)):
                variance[p] += size * np.einsum("dn,nd->n", kernel.steepness(X), beyond**2)
        return np.stack([mean for mean, _ in pairs]), (weights[0] * self._stretch**2)[:, None] * variance

    @override
    def slopes(self, t: Array) -> Array:
        X, slopes = t.T / REACH, np.empty((len(t), len(self.regressors_), t.shape[1]))
        for p, regressor in enumerate(self.regressors_):
            size, kernel = _process(regressor)
            weights = regressor.alpha_ * size / regressor._y_train_std
            slopes[:, p] = kernel.slopes(X, regressor.X_train_) @ weights
        return slopes / REACH

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        X, variances = t.T / REACH, np.empty((len(t), len(self.regressors_), t.shape[1]))
        for p, regressor in enumerate(self.regressors_):
            size, kernel = _process(regressor)
            prior = kernel.steepness(X)
            for i, slope in enumerate(kernel.slopes(X, regressor.X_train_)):
                white = solve_triangular(regressor.L_, slope.T, lower=True)
                known = size / regressor._y_train_std**2 * np.einsum("nb,nb->b", white, white)
                variances[i, p] = weights[0, p] * size * np.maximum(prior[i] - known, 0)
        return np.asarray(variances * (self._stretch[:, None] / REACH) ** 2)


def _least(cost: Callable[[Array], tuple[float, Array]], start: Array, bounds: Array) -> tuple[Array, float]:
    """Return the parameters of least cost and the cost, by scikit-learn's rule for optimisers."""
    limits = scipy.optimize.Bounds(bounds[:, 0], bounds[:, 1])
    optimum = scipy.optimize.minimize(
        cost, start, method="L-BFGS-B", jac=True, bounds=limits, options={"maxiter": _ITERATIONS}
    )
    return optimum.x, float(optimum.fun)


def _process(regressor: GaussianProcessRegressor) -> tuple[float, Chebyshev]:
    """Return the variance of a regressor's process, in squared units of its output, and its correlation kernel."""
    signal = regressor.kernel_.k1
    return float(signal.k1.constant_value) * float(regressor._y_train_std) ** 2, signal.k2


def _stretch(regressor: GaussianProcessRegressor) -> float:
    """Return the factor >= 1 on standard deviations at which the 95 % intervals of left-out cases hold."""
    inverse = cho_solve((regressor.L_, True), np.eye(len(regressor.L_)))
    # left-out errors over their deviations: Rasmussen and Williams (2006), equation 5.12
    scores = np.sort(np.abs(regressor.alpha_) / np.sqrt(np.diag(inverse)))
    rank = min(len(scores), int(np.ceil(NOMINAL * (len(scores) + 1))))
    return max(1.0, float(scores[rank - 1] / Normal().ends(NOMINAL)[1, 0]))


def _column(X: xr.Dataset, name: str) -> Array:
    if name not in X.variables:
        raise ValueError(f"{name!r} is not in the data set; it has {', '.join(map(str, X.variables))}")
    array = X[name]
    if array.ndim != 1 or array.dtype.kind not in "iuf":
        raise ValueError(f"{name!r} must be numbers over one dimension, got {array.dtype} over {array.dims}")
    if array.dims != X[next(iter(X.data_vars))].dims:
        raise ValueError(f"{name!r} is over {array.dims[0]!r}, unlike the other variables")
    if not np.isfinite(array.values).all():
        raise ValueError(f"{name!r} is not finite in {int((~np.isfinite(array.values)).sum())} of {array.size} cases")
    return np.asarray(array.values, dtype=np.float64)
