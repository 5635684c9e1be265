"""A regressor for scikit-learn: arrays that form a factorial go to the grid process, others to the scattered one."""

import warnings
from collections.abc import Sequence
from math import prod
from typing import Literal, Self, get_args, overload

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from sklearn.base import BaseEstimator, MultiOutputMixin, RegressorMixin
from sklearn.utils.validation import _check_sample_weight, check_array, check_is_fitted, validate_data

from approximation.arrays import Array, Indices, unmasked
from approximation.chebyshev import gauss_points
from surrogate.data.factorial import follows_chebyshev
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.gp.gridgp import GridGP
from surrogate.gp.imputation import MOST
from surrogate.gp.imputation import fit as fit_with_missing
from surrogate.gp.scattergp import ScatterGP

Design = Literal["auto", "factorial", "scattered"]
_SAME = 1e-9  # of the range of an output, by which cases that stand twice may differ
_STEEPNESS = (1e-3, 20.0)  # of levels spread by their logarithms: half of that of the largest over the least
_NEARLY = 0.8  # of the combinations of all levels, from which on the rest is called missing


class FactorialRegressor(MultiOutputMixin, RegressorMixin, BaseEstimator):  # type: ignore[misc]  # untyped
    """Gaussian process regression of arrays and tables, one or more outputs, by scikit-learn's rules.

    Cases that are every combination of Chebyshev-Gauss levels of their columns (see `chebyshev_levels`), or of what a
    scaler makes of such levels, in any order, are fitted by `GridGP`: with spectral accuracy, free of noise, at a cost
    that grows little faster than their number. A case that stands twice with the same outputs counts once, and where a
    few combinations are missing they are filled in by the process itself, and a warning says so. All others, a
    factorial of other levels among them, are fitted by `ScatterGP`, with a noise that is estimated: at most 3,000,
    at a cost that grows with the cube of their number.

    Parameters
    ----------
    design : {"auto", "factorial", "scattered"}
        Which of the two the cases are; by default they are looked at. "factorial" refuses those that are none.
    inputs : sequence of Input, optional
        Range and scale of every column, in their order. By default the range of the cases on a linear scale or, of
        Chebyshev-Gauss levels, the range and scale that they are those of.
    nugget : float
        Added to the diagonal of the correlation, of scattered cases, relative to the variance of the output.
    extrapolate : bool
        Answer outside the range of the cases too, as cross-validation must; False raises `OutOfBoxError` there.

    Attributes
    ----------
    model_ : GridGP or ScatterGP
        The fitted process: intervals, gradients, sensitivities, files. Its inputs have the names of the columns, or
        `x0`, `x1`, ..., and are these less `shift_`; its outputs are `y0`, `y1`, ...
    shift_ : ndarray
        Zero for every column, but for one whose levels are logarithmic Chebyshev-Gauss levels that a scaler has moved:
        what takes these back, but for their unit.
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
        inputs: Sequence[Input] | None = None,
        nugget: float = 1e-10,
        extrapolate: bool = True,
    ) -> None:
        self.design = design
        self.inputs = inputs
        self.nugget = nugget
        self.extrapolate = extrapolate

    def fit(self, X: ArrayLike, y: ArrayLike, sample_weight: ArrayLike | None = None) -> Self:
        """Fit to cases.

        Parameters
        ----------
        X : array-like or DataFrame, shape (n, d)
            Inputs, a row a case.
        y : array-like, shape (n,) or (n, p)
            Outputs.
        sample_weight : array-like, shape (n,), optional
            How many cases each counts as: none of those of weight zero, and of others the noise has so many times less
            variance. A factorial, which has no noise, has no other use for them.

        Raises
        ------
        ValueError
            Values that are not finite numbers, negative weights, fewer than two cases, a constant column, cases outside
            of `inputs`, an unknown design, or no factorial where one is asked for; one line.
        """
        if self.design not in get_args(Design):
            raise ValueError(f"design {self.design!r} is none of {', '.join(get_args(Design))}")
        columns, outputs = validate_data(
            self, unmasked(X), unmasked(y), dtype=np.float64, multi_output=True, y_numeric=True, ensure_min_samples=2
        )
        weights = _check_sample_weight(unmasked(sample_weight), columns, dtype=np.float64, ensure_non_negative=True)
        if (weights == 0).any():
            columns, outputs, weights = columns[weights > 0], outputs[weights > 0], weights[weights > 0]
            check_array(columns, ensure_min_samples=2)
        names = [str(name) for name in getattr(self, "feature_names_in_", [f"x{k}" for k in range(columns.shape[1])])]
        if self.inputs is not None and len(self.inputs) != len(names):
            raise ValueError(f"inputs has {len(self.inputs)} entries for the {len(names)} columns {', '.join(names)}")
        for name, column in zip(names, columns.T, strict=True):
            if np.ptp(column) == 0:
                raise ValueError(f"column {name!r} is {column[0]:g} in all {len(column)} cases; leave it out")
        self._single = outputs.ndim == 1
        values = np.asarray(outputs, dtype=np.float64).reshape(len(columns), -1)
        levels = [np.unique(column) for column in columns.T]
        if self.inputs is not None:
            names = [input_.name for input_ in self.inputs]
        shift = None if self.design == "scattered" else self._moved(names, levels)
        scattered = self.design == "scattered" or (self.design == "auto" and shift is None)
        places = None if scattered else _places(columns, levels)
        if places is None:
            columns, values, weights = _once(columns, values, weights)
            places = None if scattered else _places(columns, levels)
        if places is None and self.design == "factorial":
            raise ValueError(
                f"the {len(columns)} cases are no factorial: the columns have "
                f"{' x '.join(str(len(column)) for column in levels)} levels, and every combination is needed once"
            )
        if places is None and self.design == "auto" and not scattered:
            places = _some_places(columns, levels)
            if places is None:
                _warn_of_doubles(names, columns)
        self.shift_ = np.zeros(len(names)) if places is None or shift is None else shift
        if places is None:
            self.model_ = self._scattered(names, columns, values, weights)
        else:
            self.model_ = self._grid(names, levels, values, places)
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
        points = validate_data(self, unmasked(X), dtype=np.float64, reset=False) - self.shift_
        if return_std:
            mean, std = self.model_.predict_array(points, return_std=True, extrapolate=self.extrapolate)
            return self._shaped(mean), self._shaped(std)
        return self._shaped(self.model_.predict_array(points, extrapolate=self.extrapolate))

    def _shaped(self, values: Array) -> Array:
        return values[:, 0] if self._single else values

    def _grid(self, names: list[str], levels: list[Array], values: Array, places: Indices) -> GaussianProcess:
        sizes = [len(values_of_factor) for values_of_factor in levels]
        ordered, missing = np.zeros((np.prod(sizes), values.shape[1])), np.ones(np.prod(sizes), dtype=bool)
        ordered[places], missing[places] = values, False
        outputs = _outputs(names, values)
        data = xr.Dataset(
            {name: (names, column.reshape(sizes)) for name, column in zip(outputs, ordered.T, strict=True)},
            coords={name: along - by for name, along, by in zip(names, levels, self.shift_, strict=True)},
        )

        def made() -> GridGP:
            return GridGP(self.inputs, outputs)

        return fit_with_missing(made, data, missing.reshape(sizes)) if missing.any() else made().fit(data)

    def _moved(self, names: list[str], levels: list[Array]) -> Array | None:
        """The shift of levels from Chebyshev-Gauss levels, of `inputs` or of any range; None where they are none."""
        shifts = [np.zeros(len(names))]
        if self.inputs is None:
            shifts.append(np.array(list(map(_shift, levels))))
        for shift in shifts:
            coords = {name: along - by for name, along, by in zip(names, levels, shift, strict=True)}
            if follows_chebyshev(xr.Dataset(coords=coords), names, self.inputs):
                return shift
        return None

    def _scattered(self, names: list[str], columns: Array, values: Array, weights: Array) -> GaussianProcess:
        outputs = _outputs(names, values)
        case = _free("case", names)
        pairs = zip([*names, *outputs], [*columns.T, *values.T], strict=True)
        data = xr.Dataset({name: (case, column) for name, column in pairs})
        case_weights = None if (weights == 1).all() else weights
        return ScatterGP(self.inputs, outputs, self.nugget).fit(data, case_weights)


def _places(columns: Array, levels: Sequence[Array], most_missing: float = 0.0) -> Indices | None:
    """The place of every case in the full product of the levels, (n,); None if one stands twice or too many lack."""
    sizes = tuple(len(values) for values in levels)
    if not 0 <= prod(sizes) - len(columns) <= most_missing:
        return None
    indices = [np.searchsorted(values, column) for values, column in zip(levels, columns.T, strict=True)]
    places: Indices = np.ravel_multi_index(indices, sizes)
    return places if len(np.unique(places)) == len(columns) else None


def _once(columns: Array, values: Array, weights: Array) -> tuple[Array, Array, Array]:
    """The cases in an order of their own; those that stand several times with the same outputs once, with all weight.

    Copies to the last bit count once in any case, others where no two cases at a place differ by more than rounding.
    """
    for keys in (np.column_stack([columns, values]), None):
        _, first, which = np.unique(columns if keys is None else keys, axis=0, return_index=True, return_inverse=True)
        which = which.ravel()
        difference = np.abs(values - values[first][which]).max(axis=0)
        if (difference <= _SAME * np.ptp(values, axis=0)).all():
            columns, values, weights = columns[first], values[first], np.bincount(which, weights).astype(np.float64)
    return columns, values, weights


def _shift(levels: Array) -> float:
    """Return the shift a of at least four levels a + b exp(c x) at Chebyshev points x, so that a log scale fits."""
    points = gauss_points(len(levels))
    if len(levels) < 4:
        return 0.0  # any three levels are of this kind
    middle = len(levels) // 2
    share = (levels[middle] - levels[0]) / (levels[-1] - levels[0])

    def missed(steepness: float) -> float:
        grown = np.expm1(steepness * (points - points[0]))
        return float(grown[middle] / grown[-1] - share)

    if not missed(_STEEPNESS[1]) < 0 < missed(_STEEPNESS[0]):
        return 0.0
    root = brentq(missed, *_STEEPNESS, xtol=1e-15, rtol=4 * np.finfo(float).eps)
    return float(levels[0] - (levels[-1] - levels[0]) / np.expm1(root * (points[-1] - points[0])))


def _some_places(columns: Array, levels: Sequence[Array]) -> Indices | None:
    """The places of cases that are a factorial but for a few, which a warning tells; None unless they are such."""
    sizes = tuple(len(values) for values in levels)
    whole = prod(sizes)
    if len(sizes) == 1 or min(sizes) < 3:
        return None
    places = _places(columns, levels, min((1 - _NEARLY) * whole, MOST))
    if places is None:
        return None
    warnings.warn(
        f"{whole - len(columns)} of the {whole} combinations of {' x '.join(map(str, sizes))} levels are "
        "missing: the process fills them in",
        UserWarning,
        stacklevel=3,
    )
    return places


def _warn_of_doubles(names: Sequence[str], columns: Array) -> None:
    """Warn of cases of a factorial that have several outputs, for which all are learnt as scattered."""
    rows, counts = np.unique(columns, axis=0, return_counts=True)
    if (several := counts > 1).any():
        case = ", ".join(f"{name} = {value:g}" for name, value in zip(names, rows[several][0], strict=True))
        warnings.warn(
            f"cases of a factorial, {np.count_nonzero(several)} of them several times with other outputs, as {case}: "
            "learnt as scattered cases with noise, far less exactly",
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
