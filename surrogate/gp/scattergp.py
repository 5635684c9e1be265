"""Gaussian processes for scattered designs: scikit-learn's regressor behind the shared face."""

import warnings
from collections.abc import Sequence
from typing import ClassVar, Literal, Self, get_args

import numpy as np
import xarray as xr
from scipy.linalg import solve_triangular
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Kernel, Matern

from surrogate.data.arrays import Array
from surrogate.data.factorial import output_names, text_attrs
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.gp.factors import steepness
from surrogate.gp.model import GaussianProcess

KernelName = Literal["rbf", "matern32", "matern52"]
KERNELS: tuple[str, ...] = get_args(KernelName)

LENGTHS = (1e-2, 1e3)
VARIANCES = (1e-4, 1e5)


class ScatterGP(GaussianProcess):
    """Gaussian process on scattered cases, one length scale an input, noise-free but for a tiny nugget.

    The outputs are independent `sklearn.gaussian_process.GaussianProcessRegressor`s on scaled coordinates; the cost of
    a fit grows with the cube of the number of cases (about 1,000 are practical).

    Parameters
    ----------
    kernel : {"matern52", "matern32", "rbf"}
        Correlation function.
    inputs : sequence of Input, optional
        Inputs with box and scale; by default the variables that are not `outputs`, with the range of the cases.
    outputs : sequence of str, optional
        Outputs, by default the variables that are not `inputs`. One of the two must be given.
    nugget : float
        Added to the diagonal, relative to the variance of the output.
    restarts : int
        Restarts of the search for the maximum of the marginal likelihood.
    random_state : int
        Seed of the restarts.

    Attributes
    ----------
    regressors_ : list of GaussianProcessRegressor
        One fitted regressor an output.

    Examples
    --------
    >>> x = np.linspace(0, 1, 9)
    >>> cases = xr.Dataset({"x": ("case", x), "f": ("case", np.exp(x))})
    >>> model = ScatterGP(inputs=[Input("x", 0, 1)]).fit(cases)
    >>> bool(abs(model.predict({"x": 0.3})["f"] - np.exp(0.3)) < 1e-3)
    True
    """

    engine: ClassVar[str] = "scatter"

    def __init__(
        self,
        kernel: KernelName = "matern52",
        inputs: Sequence[Input] | None = None,
        outputs: Sequence[str] | None = None,
        nugget: float = 1e-10,
        restarts: int = 0,
        random_state: int = 0,
    ) -> None:
        self.kernel = kernel
        self.inputs = inputs
        self.outputs = outputs
        self.nugget = nugget
        self.restarts = restarts
        self.random_state = random_state

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to scattered cases.

        Parameters
        ----------
        X : Dataset
            One dimension (such as `case`); inputs and outputs are variables over it.

        Raises
        ------
        ValueError
            An unknown kernel, a data set of other dimensions, missing variables, values that are not finite, a case
            outside the box; one line that names it.
        """
        if self.kernel not in KERNELS:
            raise ValueError(f"kernel {self.kernel!r} is none of {', '.join(KERNELS)}")
        inputs, names = self._roles(X)
        columns = {name: _column(X, name) for name in [*(one.name for one in inputs), *names]}
        for one in inputs:
            low, high = columns[one.name].min(), columns[one.name].max()
            if low < one.low or high > one.high:
                wrong = low if low < one.low else high
                raise ValueError(f"input {one.name!r} has the value {wrong:g} outside its range {one.range_text()}")
        self.inputs_, self.outputs_ = tuple(inputs), tuple(names)
        self.attrs_ = {name: text_attrs(X[name]) for name in names}
        self.calibration_ = None
        self.points_ = np.stack([columns[one.name] for one in inputs], axis=1)
        self.values_ = np.stack([columns[name] for name in names], axis=1)
        t = unit_coordinates(self.inputs_, self.points_).T
        self.regressors_ = [self._regressor(t, values, None) for values in self.values_.T]
        return self

    def state(self) -> xr.Dataset:
        """Return what a file must hold beside inputs, outputs and probes."""
        return xr.Dataset(
            {
                "point": (("case", "input"), self.points_),
                "value": (("case", "output"), self.values_),
                "theta": (
                    ("output", "theta_index"),
                    np.stack([regressor.kernel_.theta for regressor in self.regressors_]),
                ),
            },
            attrs={
                "kernel": self.kernel,
                "nugget": self.nugget,
                "restarts": self.restarts,
                "random_state": self.random_state,
            },
        )

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the model of a stored state; ValueError names what is inconsistent."""
        attrs = stored.attrs
        if attrs["kernel"] not in KERNELS:
            raise ValueError(f"unknown kernel {attrs['kernel']!r}")
        model = cls(
            attrs["kernel"],
            inputs,
            tuple(outputs),
            float(attrs["nugget"]),
            int(attrs["restarts"]),
            int(attrs["random_state"]),
        )
        model.inputs_, model.outputs_, model.attrs_ = inputs, tuple(outputs), outputs
        model.points_ = stored["point"].transpose("case", "input").values
        model.values_ = stored["value"].transpose("case", "output").values
        theta = stored["theta"].transpose("output", "theta_index").values
        if theta.shape[1] != len(inputs) + 1:
            raise ValueError(f"theta has {theta.shape[1]} columns for {len(inputs)} inputs")
        t = unit_coordinates(inputs, model.points_).T
        model.regressors_ = [model._regressor(t, y, row) for y, row in zip(model.values_.T, theta, strict=True)]
        return model

    def _roles(self, X: xr.Dataset) -> tuple[Sequence[Input], list[str]]:
        if self.inputs is not None:
            return self.inputs, output_names(X, self.outputs, exclude=[one.name for one in self.inputs])
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

    def _regressor(self, t: Array, values: Array, theta: Array | None) -> GaussianProcessRegressor:
        kernel = ConstantKernel(1.0, VARIANCES) * self._correlation(t.shape[1])
        regressor = GaussianProcessRegressor(
            kernel if theta is None else kernel.clone_with_theta(theta),
            alpha=self.nugget,
            optimizer="fmin_l_bfgs_b" if theta is None else None,
            n_restarts_optimizer=self.restarts if theta is None else 0,
            normalize_y=True,
            random_state=self.random_state,
        )
        with warnings.catch_warnings():
            # a length scale at its bound means an output that is flat or linear along an input, which is no fault
            warnings.simplefilter("ignore", ConvergenceWarning)
            return regressor.fit(t, values)

    def _correlation(self, inputs: int) -> Kernel:
        if self.kernel == "rbf":
            return RBF(np.ones(inputs), LENGTHS)
        return Matern(np.ones(inputs), LENGTHS, nu=1.5 if self.kernel == "matern32" else 2.5)

    @property
    def parts(self) -> int:
        """Number of parts of the variance: one."""
        return 1

    def _mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        if weights is None:
            return np.stack([regressor.predict(t.T) for regressor in self.regressors_]), None
        with warnings.catch_warnings():
            # at a training point the variance is zero up to rounding, and scikit-learn warns of its sign
            warnings.filterwarnings("ignore", message="Predicted variances smaller than 0")
            pairs = [regressor.predict(t.T, return_std=True) for regressor in self.regressors_]
        return np.stack([mean for mean, _ in pairs]), weights[0][:, None] * np.stack([std**2 for _, std in pairs])

    def _slopes(self, t: Array) -> Array:
        slopes = np.empty((len(t), len(self.outputs_), t.shape[1]))
        for p, regressor in enumerate(self.regressors_):
            for i, slope in enumerate(self._kernel_slopes(regressor, t)):
                slopes[i, p] = slope @ regressor.alpha_ * regressor._y_train_std
        return slopes

    def _slope_variances(self, t: Array, weights: Array) -> Array:
        slopes = np.empty((len(t), len(self.outputs_), t.shape[1]))
        for p, regressor in enumerate(self.regressors_):
            variance, lengths = np.exp(regressor.kernel_.theta[0]), np.exp(regressor.kernel_.theta[1:])
            size = weights[0, p] * regressor._y_train_std**2
            for i, slope in enumerate(self._kernel_slopes(regressor, t)):
                white = solve_triangular(regressor.L_, slope.T, lower=True)
                prior = variance * steepness(self.kernel) / lengths[i] ** 2
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
        if self.kernel == "rbf":
            return np.asarray(np.exp(-0.5 * r * r))
        if self.kernel == "matern32":
            return np.asarray(3 * np.exp(-np.sqrt(3) * r))
        return np.asarray(5 / 3 * (1 + np.sqrt(5) * r) * np.exp(-np.sqrt(5) * r))


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
