"""A regressor for scikit-learn: arrays that form a factorial go to the grid process, others to the scattered one."""

import warnings
from collections.abc import Sequence
from typing import Literal, Self, get_args, overload

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, MultiOutputMixin, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from approximation.arrays import Array, Indices
from surrogate.data.factorial import follows_chebyshev
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.gp.gridgp import GridGP
from surrogate.gp.scattergp import KernelName, ScatterGP

Design = Literal["auto", "factorial", "scattered"]
_SAME = 1e-9  # of the range of an output, by which cases that stand twice may differ
_NEARLY = 0.95  # of the combinations of all levels, from which on the rest is called missing


class FactorialRegressor(MultiOutputMixin, RegressorMixin, BaseEstimator):  # type: ignore[misc]  # untyped
    """Gaussian process regression of arrays and tables, one or more outputs, by scikit-learn's rules.

    Cases that are every combination of the levels of their columns, in any order, are fitted by `GridGP` at a cost that
    grows little faster than their number, free of noise but for `nugget`; a case that stands twice with the same
    outputs counts once, and a warning says where a few combinations are missing. All others are fitted by `ScatterGP`:
    up to 500 as free of noise, at the cube of their number, more with a noise that is estimated, at a cost that grows
    with their number.

    Parameters
    ----------
    design : {"auto", "factorial", "scattered"}
        Which of the two the cases are; by default they are looked at. "factorial" refuses those that are none.
    kernel : {"auto", "rbf", "matern32", "matern52", "chebyshev"}
        Correlation function of scattered cases, see `ScatterGP`, and of a factorial of any levels, where "auto" is
        "matern52". A factorial whose columns all have Chebyshev-Gauss levels (see `chebyshev_levels`) is interpolated
        by the kernel of that name, with spectral accuracy.
    inputs : sequence of Input, optional
        Range and scale of every column, in their order. By default the range of the cases on a linear scale or, of
        Chebyshev-Gauss levels, the range and scale that they are those of.
    nugget : float
        Added to the diagonal of the correlation, relative to the variance of the output; the chebyshev kernel has none.
    extrapolate : bool
        Answer outside the range of the cases too, as cross-validation must; False raises `OutOfBoxError` there.

    Attributes
    ----------
    model_ : GridGP or ScatterGP
        The fitted process: intervals, gradients, sensitivities, files. Its inputs have the names of the columns, or
        `x0`, `x1`, ...; its outputs are `y0`, `y1`, ...
    n_features_in_ : int
        Number of columns.
    feature_names_in_ : ndarray of str
        Their names, where all of them are text.

    Examples
    --------
    >>> import numpy as np
    >>> from surrogate import FactorialRegressor, chebyshev_levels
    >>> levels = [chebyshev_levels(0, 1, 9), chebyshev_levels(1, 100, 9, "log")]
    >>> X = np.stack(np.meshgrid(*levels), axis=-1).reshape(-1, 2)
    >>> model = FactorialRegressor().fit(X, np.exp(X[:, 0]) * np.log(X[:, 1]))
    >>> type(model.model_).__name__, model.model_.box["x1"].scale
    ('GridGP', 'log')
    >>> mean, std = model.predict([[0.5, 10.0]], return_std=True)
    >>> bool(abs(mean[0] - np.exp(0.5) * np.log(10)) < 1e-9)
    True
    """

    def __init__(
        self,
        design: Design = "auto",
        kernel: KernelName = "auto",
        inputs: Sequence[Input] | None = None,
        nugget: float = 1e-10,
        extrapolate: bool = True,
    ) -> None:
        self.design = design
        self.kernel = kernel
        self.inputs = inputs
        self.nugget = nugget
        self.extrapolate = extrapolate

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to cases.

        Parameters
        ----------
        X : array-like or DataFrame, shape (n, d)
            Inputs, a row a case.
        y : array-like, shape (n,) or (n, p)
            Outputs.

        Raises
        ------
        ValueError
            Values that are not finite numbers, fewer than two cases, a constant column, cases outside of `inputs`, an
            unknown kernel or design, or no factorial where one is asked for; one line.
        """
        if self.design not in get_args(Design):
            raise ValueError(f"design {self.design!r} is none of {', '.join(get_args(Design))}")
        if self.kernel not in get_args(KernelName):
            raise ValueError(f"kernel {self.kernel!r} is none of {', '.join(get_args(KernelName))}")
        columns, outputs = validate_data(
            self, X, y, dtype=np.float64, multi_output=True, y_numeric=True, ensure_min_samples=2
        )
        names = [str(name) for name in getattr(self, "feature_names_in_", [f"x{k}" for k in range(columns.shape[1])])]
        if self.inputs is not None and len(self.inputs) != len(names):
            raise ValueError(f"inputs has {len(self.inputs)} entries for the {len(names)} columns {', '.join(names)}")
        for name, column in zip(names, columns.T, strict=True):
            if np.ptp(column) == 0:
                raise ValueError(f"column {name!r} is {column[0]:g} in all {len(column)} cases; leave it out")
        self._single = outputs.ndim == 1
        values = np.asarray(outputs, dtype=np.float64).reshape(len(columns), -1)
        levels = [np.unique(column) for column in columns.T]
        places = None if self.design == "scattered" else _places(columns, levels)
        if places is None and self.design != "scattered":
            columns, values = _once(columns, values)
            places = _places(columns, levels)
        if places is None and self.design == "factorial":
            raise ValueError(
                f"the {len(columns)} cases are no factorial: the columns have "
                f"{' x '.join(str(len(some)) for some in levels)} levels, and every combination is needed once"
            )
        if places is None and self.design == "auto":
            _tell_missing(columns, levels)
        if self.inputs is not None:
            names = [one.name for one in self.inputs]
        self.model_ = (
            self._scattered(names, columns, values) if places is None else self._grid(names, levels, values, places)
        )
        return self

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[False] = False) -> Array: ...

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[True]) -> tuple[Array, Array]: ...

    def predict(self, X: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """Return the mean at points and, with `return_std`, the standard deviation: (n,) or (n, p), as `y` was.

        Parameters
        ----------
        X : array-like or DataFrame, shape (n, d)
            Points, columns as in `fit`.
        return_std : bool
            Give a pair of mean and standard deviation.

        Raises
        ------
        NotFittedError
            Before `fit`.
        ValueError
            Values that are not finite numbers, other columns than those of `fit`, or a point outside the range of the
            cases (`OutOfBoxError`) without `extrapolate`.
        """
        check_is_fitted(self)
        points = validate_data(self, X, dtype=np.float64, reset=False)
        if return_std:
            mean, std = self.model_.predict_array(points, return_std=True, extrapolate=self.extrapolate)
            return self._shaped(mean), self._shaped(std)
        return self._shaped(self.model_.predict_array(points, extrapolate=self.extrapolate))

    def _shaped(self, values: Array) -> Array:
        return values[:, 0] if self._single else values

    def _grid(self, names: list[str], levels: list[Array], values: Array, places: Indices) -> GaussianProcess:
        sizes = [len(some) for some in levels]
        ordered = np.empty_like(values)
        ordered[places] = values
        outputs = _outputs(names, values)
        data = xr.Dataset(
            {name: (names, column.reshape(sizes)) for name, column in zip(outputs, ordered.T, strict=True)},
            coords=dict(zip(names, levels, strict=True)),
        )
        chebyshev = follows_chebyshev(data, names, self.inputs)
        other = "matern52" if self.kernel == "auto" else self.kernel
        return GridGP("chebyshev" if chebyshev else other, self.inputs, outputs, nugget=self.nugget).fit(data)

    def _scattered(self, names: list[str], columns: Array, values: Array) -> GaussianProcess:
        outputs = _outputs(names, values)
        case = _free("case", names)
        every = zip([*names, *outputs], [*columns.T, *values.T], strict=True)
        data = xr.Dataset({name: (case, column) for name, column in every})
        return ScatterGP(self.kernel, self.inputs, outputs, self.nugget).fit(data)


def _places(columns: Array, levels: Sequence[Array]) -> Indices | None:
    """The place of every case in the full product of the levels, (n,); None unless every combination is there once."""
    sizes = tuple(len(some) for some in levels)
    if int(np.prod([float(size) for size in sizes])) != len(columns):
        return None
    indices = [np.searchsorted(some, column) for some, column in zip(levels, columns.T, strict=True)]
    places = np.ravel_multi_index(indices, sizes)
    return places if (np.bincount(places, minlength=len(columns)) == 1).all() else None


def _once(columns: Array, values: Array) -> tuple[Array, Array]:
    """The cases without those that stand several times with the same outputs; all of them where outputs differ."""
    _, first, which = np.unique(columns, axis=0, return_index=True, return_inverse=True)
    which = which.ravel()
    if len(first) == len(columns):
        return columns, values
    apart = np.abs(values - values[first][which]).max(axis=0)
    if (apart > _SAME * np.ptp(values, axis=0)).any():
        return columns, values
    return columns[first], values[first]


def _tell_missing(columns: Array, levels: Sequence[Array]) -> None:
    """Warn where cases are a factorial but for a few: as scattered ones they are learnt far less exactly."""
    whole, there = float(np.prod([float(len(some)) for some in levels])), len(np.unique(columns, axis=0))
    if columns.shape[1] > 1 and min(len(some) for some in levels) > 2 and _NEARLY * whole <= there < whole:
        sizes = " x ".join(str(len(some)) for some in levels)
        warnings.warn(
            f"{whole - there:.0f} of the {whole:.0f} combinations of {sizes} levels are missing: "
            "the cases are learnt as scattered ones, far less exactly than a factorial",
            UserWarning,
            stacklevel=3,
        )


def _outputs(names: Sequence[str], values: Array) -> list[str]:
    return [_free(f"y{k}", names) for k in range(values.shape[1])]


def _free(name: str, taken: Sequence[str]) -> str:
    """The name, with underscores until it is not one of those that are taken."""
    while name in taken:
        name += "_"
    return name
