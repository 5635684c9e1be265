"""Gaussian processes for scattered cases: a few by scikit-learn's regressors, many by finite rank."""

from collections.abc import Sequence
from typing import ClassVar, Literal, Self, get_args

import numpy as np
import xarray as xr
from sklearn.gaussian_process import GaussianProcessRegressor
from typing_extensions import override

from approximation.arrays import Array
from surrogate.data.factorial import output_names, text_attrs
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.face.model import GaussianProcess
from surrogate.gp.exact import Exact, regressor
from surrogate.gp.finiterank import FiniteRank
from surrogate.gp.kernels import whole

KernelName = Literal["auto", "rbf", "matern32", "matern52", "chebyshev"]
KERNELS: tuple[str, ...] = get_args(KernelName)
#: Cases above which "auto" is the kernel "chebyshev" of finite rank, whose cost is that of their number.
MANY = 500
#: End of the Chebyshev kernel in half-widths of the box: cases up to an eighth of the width outside are answered by it.
REACH = 1.25


class ScatterGP(GaussianProcess):
    """Gaussian process on scattered cases, any number of outputs.

    Up to 500 cases, every output is a regressor of scikit-learn, whose cost grows with the cube of the number of cases.
    The kernel "auto" is the Chebyshev kernel of `GridGP` on a box that is a quarter wider, with noise that is
    estimated; its deviations are widened until the 95 % intervals of left-out cases hold, and grow outside of the box.
    The kernels "rbf", "matern32" and "matern52" have a length scale an input and no noise but for a tiny nugget. With
    "chebyshev", and with "auto" for more cases, the outputs are one process of finite rank (module `finiterank`), whose
    cost grows with the number of cases, and whose noise is estimated as well. Standard deviations are those of a new
    case, with its noise; `_std` of a gradient has no noise in it.

    Parameters
    ----------
    kernel : {"auto", "rbf", "matern32", "matern52", "chebyshev"}
        Correlation function; "auto" is the Chebyshev kernel, full for up to 500 cases, of finite rank for more.
    inputs : sequence of Input, optional
        Inputs with box and scale; by default the variables that are not `outputs`, with the range of the cases.
    outputs : sequence of str, optional
        Outputs, by default the variables that are not `inputs`. One of the two must be given.
    nugget : float
        Added to the diagonal, relative to the variance of the output, beside the noise that "auto" estimates;
        "chebyshev" has none.
    restarts : int
        Restarts of the search for the maximum of the marginal likelihood; "chebyshev" has none.
    random_state : int
        Seed of the restarts, or of the choice of the cases from which the decay of "chebyshev" is learnt.
    rank : int
        Most features of "chebyshev"; there are at most half as many as cases. Time and memory grow with its square.

    Attributes
    ----------
    process_ : Exact or FiniteRank
        What was fitted.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from surrogate import Input, ScatterGP
    >>> rng = np.random.default_rng(0)
    >>> x, y = rng.uniform(-1, 1, (2, 5000))
    >>> cases = xr.Dataset({"x": ("case", x), "y": ("case", y)})
    >>> cases["f"] = ("case", np.exp(x * y) + 0.1 * rng.normal(size=5000))
    >>> model = ScatterGP(inputs=[Input("x", -1, 1), Input("y", -1, 1)], rank=100).fit(cases)
    >>> found = model.predict({"x": 0.5, "y": 0.4})
    >>> bool(abs(found["f"] - np.exp(0.2)) < 0.02), bool(abs(found["f_std"] - 0.1) < 0.01)
    (True, True)
    """

    engine: ClassVar[str] = "scatter"
    process_: Exact | FiniteRank
    _reach: float  # end of the kernel's coordinates in half-widths; 1 in files of former releases

    def __init__(
        self,
        kernel: KernelName = "auto",
        inputs: Sequence[Input] | None = None,
        outputs: Sequence[str] | None = None,
        nugget: float = 1e-10,
        restarts: int = 0,
        random_state: int = 0,
        rank: int = 2000,
    ) -> None:
        self.kernel = kernel
        self.inputs = inputs
        self.outputs = outputs
        self.nugget = nugget
        self.restarts = restarts
        self.random_state = random_state
        self.rank = rank

    @property
    def regressors_(self) -> list[GaussianProcessRegressor]:
        """The fitted regressors, one an output; none with "chebyshev"."""
        return self.process_.regressors if isinstance(self.process_, Exact) else []

    def fit(self, X: xr.Dataset, weights: Array | None = None) -> Self:
        """Fit to scattered cases.

        Parameters
        ----------
        X : Dataset
            One dimension (such as `case`); inputs and outputs are variables over it.
        weights : ndarray, shape (n,), optional
            How many cases each counts as: what the variance of its noise is divided by, all of them positive. Kernels
            without noise have no use for them.

        Raises
        ------
        ValueError
            An unknown kernel, a rank below one, a data set of other dimensions, missing variables, values that are not
            finite, a case outside the box, fewer than two cases for "chebyshev"; one line that names it.
        """
        if self.kernel not in KERNELS:
            raise ValueError(f"kernel {self.kernel!r} is none of {', '.join(KERNELS)}")
        if self.rank < 1:
            raise ValueError(f"rank {self.rank} must be at least 1")
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
        points = np.stack([columns[input_.name] for input_ in inputs], axis=1)
        values = np.stack([columns[name] for name in names], axis=1)
        self.cases_, self.process_ = len(points), self._process(points, values, weights)
        return self

    def _process(self, points: Array, values: Array, weights: Array | None) -> Exact | FiniteRank:
        cases, t = len(points), unit_coordinates(self.inputs_, points) / REACH
        self._reach = REACH
        if self.kernel == "chebyshev" or (self.kernel == "auto" and cases > MANY):
            if cases < 2:
                raise ValueError(f"the kernel 'chebyshev' needs at least 2 cases, got {cases}")
            return FiniteRank.fit(t, values, min(self.rank, cases // 2), self.random_state, weights)
        self.points_, self.values_, self.weights_ = points, values, weights
        noisy = self.kernel == "auto"
        name, known = ("chebyshev", weights) if noisy else (self.kernel, None)
        how = self.nugget, self.restarts, self.random_state, known, noisy
        fitted = [regressor(name, t.T, column, None, *how) for column in values.T]
        return Exact([name] * len(fitted), fitted, widened=True)

    @override
    def state(self) -> xr.Dataset:
        names = ("kernel", "nugget", "restarts", "random_state", "rank")
        attrs = {name: getattr(self, name) for name in names} | {"reach": self._reach}
        if isinstance(self.process_, FiniteRank):
            return self.process_.state().assign_attrs(attrs)
        thetas = [regressor.kernel_.theta for regressor in self.process_.regressors]
        theta = np.zeros((len(thetas), max(map(len, thetas))))  # kernels have unequally many parameters
        for row, parameters in zip(theta, thetas, strict=True):
            row[: len(parameters)] = parameters
        weights = np.ones(len(self.points_)) if self.weights_ is None else self.weights_
        return xr.Dataset(
            {
                "point": (("case", "input"), self.points_),
                "value": (("case", "output"), self.values_),
                "weight": ("case", weights),
                "theta": (("output", "theta_index"), theta),
            },
            attrs=attrs | {"kernels": " ".join(self.process_.kernels)},
        )

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
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
            int(attrs["rank"]),
        )
        model.inputs_, model.outputs_, model.attrs_ = inputs, tuple(outputs), outputs
        model._reach = float(attrs.get("reach", 1.0))
        if "feature_degree" in stored:
            model.process_ = FiniteRank.restore(stored, len(inputs), len(outputs))
            return model
        model.points_ = stored["point"].transpose("case", "input").values
        model.values_ = stored["value"].transpose("case", "output").values
        model.weights_ = stored["weight"].values if "weight" in stored else None
        theta = stored["theta"].transpose("output", "theta_index").values
        usual = " ".join(["matern52" if model.kernel == "auto" else model.kernel] * len(outputs))
        kernels, noisy = attrs.get("kernels", usual).split(), model.kernel == "auto" and "kernels" in attrs
        if len(kernels) != len(outputs) or not set(kernels) <= set(KERNELS) - {"auto"}:
            raise ValueError(f"kernels {' '.join(kernels)!r} for {len(outputs)} outputs")
        counts = [len(whole(kernel, len(inputs), noisy).theta) for kernel in kernels]
        if theta.shape[1] != max(counts):
            raise ValueError(f"theta has {theta.shape[1]} columns for {len(inputs)} inputs")
        X = unit_coordinates(inputs, model.points_).T / model._reach
        how = model.nugget, 0, model.random_state, model.weights_, noisy
        columns = zip(kernels, model.values_.T, theta, counts, strict=True)
        regressors = [regressor(kernel, X, y, parameters[:count], *how) for kernel, y, parameters, count in columns]
        model.process_ = Exact(kernels, regressors, model._reach > 1)
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

    @property
    def parts(self) -> int:
        """Number of parts of the variance: one, or with "chebyshev" two, that of the function and the noise."""
        return self.process_.parts

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        return self.process_.mean_variance(t / self._reach, weights)

    @override
    def slopes(self, t: Array) -> Array:
        return self.process_.slopes(t / self._reach) / self._reach

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        return self.process_.slope_variances(t / self._reach, weights) / self._reach**2


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
