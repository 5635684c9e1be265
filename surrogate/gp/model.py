"""The face that all surrogates share: named, labelled inputs and outputs."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, ClassVar, Literal, Self, overload

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from sklearn.exceptions import NotFittedError

from surrogate.data.arrays import Array, Flags
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.points import Points, Queries, named_points, outside, require_inside
from surrogate.gp.conformal import HALF_WIDTH, NOMINAL, Calibration, calibrate

# Queries are answered in blocks of this size, so that intermediate arrays stay in cache and memory stays bounded.
BLOCK = 2048


class GaussianProcess(ABC):
    """Base of the surrogates: several outputs over named inputs, with mean, standard deviation and gradient.

    Subclasses fit on a data set and answer at scaled coordinates; this class checks, labels and scales. They are no
    estimators of scikit-learn, which take plain arrays: `surrogate.FactorialRegressor` is one, over them.

    Attributes
    ----------
    inputs_ : tuple of Input
        Inputs of the fitted model.
    outputs_ : tuple of str
        Names of its outputs.
    attrs_ : dict
        `units` and `long_name` of every output.
    calibration_ : Calibration or None
        What `calibrate` has learnt; None before.
    made_from_ : str
        A word of the caller's that tells what the model was made from, kept in its file; empty by default.
    """

    engine: ClassVar[str]
    inputs_: tuple[Input, ...]
    outputs_: tuple[str, ...]
    attrs_: dict[str, dict[str, str]]
    calibration_: Calibration | None
    made_from_: str = ""

    @abstractmethod
    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a data set that holds inputs and outputs."""

    @abstractmethod
    def _mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        """Return mean and variance, (p, B), at scaled coordinates t, (d, B).

        `weights`, shape (parts, p), multiply the parts of the variance; without them there is no variance.
        """

    @abstractmethod
    def _variance_slopes(self, t: Array, weights: Array) -> Array:
        """Return the derivatives of the weighted variances with respect to the scaled coordinates, (d, p, B)."""

    @property
    @abstractmethod
    def parts(self) -> int:
        """Number of parts that the variance is the sum of."""

    @abstractmethod
    def _slopes(self, t: Array) -> Array:
        """Return the derivatives of the means with respect to the scaled coordinates, (d, p, B)."""

    @abstractmethod
    def state(self) -> xr.Dataset:
        """Return what a file must hold beside inputs, outputs and probes."""

    @classmethod
    @abstractmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the model of a stored state; ValueError names what is inconsistent."""

    def only(self, outputs: Sequence[str]) -> Self:
        """Return a model that gives these outputs, and as few others as it can, for less."""
        return self

    @property
    def box(self) -> Mapping[str, Input]:
        """The trained box: name -> Input, in order."""
        self._require_fitted()
        return {one.name: one for one in self.inputs_}

    def predict(self, points: Queries, return_std: bool = True, *, extrapolate: bool = False) -> xr.Dataset:
        """Predict every output, with its standard deviation, at points.

        Parameters
        ----------
        points : mapping, Dataset, DataFrame or array
            One entry per input, in physical units: a scalar, a DataArray of any dimensions, or a plain sequence, which
            becomes a dimension named after its input; dimensions broadcast, so sequences span the full factorial. A
            DataFrame has a column an input, an array is (n, d) in their order: points along dimension `point`.
        return_std : bool
            Add `<output>_std`, the scale of `interval`: one of it to either side holds far less than 68 %, since
            interpolation errors are not Gaussian.
        extrapolate : bool
            Answer outside the trained box too, and add the boolean variable `extrapolated`.

        Returns
        -------
        Dataset
            `<output>` and `<output>_std` over the broadcast dimensions, with the units of the training data, and every
            input as a coordinate.

        Raises
        ------
        OutOfBoxError
            A point outside the trained box, unless `extrapolate`.
        ValueError
            Missing or unknown inputs, NaN, shapes, dimensions or coordinates that do not fit or span over 1e7 points.
        """
        self._require_fitted()
        named = named_points(points, self.inputs_)
        outer = self._checked(named, extrapolate)
        mean, std = self._blocks(named.X, return_std)
        answer: dict[str, tuple[NDArray[Any], dict[str, str]]] = {}
        for k, name in enumerate(self.outputs_):
            attrs = self.attrs_[name]
            answer[name] = mean[k], attrs
            if std is not None:
                long_name = f"standard deviation of {attrs.get('long_name', name)}"
                answer[f"{name}_std"] = std[k], {**attrs, "long_name": long_name}
        if outer is not None:
            answer["extrapolated"] = outer, {"long_name": "outside the trained box"}
        return named.dataset(answer)

    def interval(self, points: Queries, level: float = NOMINAL, *, extrapolate: bool = False) -> xr.Dataset:
        """Return the ends of the interval that holds the true value of an output in a share `level` of the cases.

        Parameters and errors as for `predict`, and ValueError for any other level than 0.95. Returns a Dataset with
        `<output>_lower` and `<output>_upper`. Before `calibrate` it is the process's own interval, which may not hold.
        """
        if level != NOMINAL:
            raise ValueError(
                f"level {level!r} is not {NOMINAL}, the only one that is calibrated: errors are not Gaussian, "
                "and no multiple of the standard deviation holds another share everywhere"
            )
        found = self.predict(points, extrapolate=extrapolate)
        answer: dict[str, xr.Variable] = {}
        for name in self.outputs_:
            mean, half = found[name].variable, HALF_WIDTH * found[f"{name}_std"].variable
            for end, value in (("lower", mean - half), ("upper", mean + half)):
                long_name = f"{end} end of the {NOMINAL:.0%} interval of {mean.attrs.get('long_name', name)}"
                value.attrs = {**mean.attrs, "long_name": long_name.replace("%", " %")}
                answer[f"{name}_{end}"] = value
        flags = {"extrapolated": found["extrapolated"].variable} if extrapolate else {}
        return xr.Dataset(answer | flags, found.coords)

    @overload
    def predict_array(
        self, X: NDArray[np.floating[Any]], return_std: Literal[False] = False, *, extrapolate: bool = False
    ) -> Array: ...

    @overload
    def predict_array(
        self, X: NDArray[np.floating[Any]], return_std: Literal[True], *, extrapolate: bool = False
    ) -> tuple[Array, Array]: ...

    def predict_array(
        self, X: NDArray[np.floating[Any]], return_std: bool = False, *, extrapolate: bool = False
    ) -> Array | tuple[Array, Array]:
        """Predict at plain points: X (n, d) in physical units -> (n, n_outputs), or a pair of them with `return_std`.

        Raises OutOfBoxError for a point outside the box (or NaN) unless `extrapolate`, ValueError for a wrong shape.
        """
        points = np.asarray(X, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != len(self.inputs_):
            raise ValueError(f"points must have shape (n, {len(self.inputs_)}), got {points.shape}")
        if not extrapolate:
            require_inside(points, self.inputs_)
        mean, std = self._blocks(points, return_std)
        return (mean.T, std.T) if std is not None else mean.T

    def gradient(self, points: Queries, return_std: bool = False, *, extrapolate: bool = False) -> xr.Dataset:
        """Return d output/d input at points, analytically, in physical units.

        Parameters and errors as for `predict`. Returns a Dataset with `<output>` and, with `return_std`,
        `<output>_std_gradient`, the derivative of the standard deviation, over (`input`, the points' dimensions); the
        coordinates `input` and `input_units` name the inputs and their units. Where the standard deviation is zero it
        has a kink, and 0 is given.
        """
        self._require_fitted()
        named = named_points(points, self.inputs_)
        outer = self._checked(named, extrapolate)
        parts = {"": self._physical_slopes(named.X, self._slopes)}
        if return_std:
            parts["_std_gradient"] = self._physical_slopes(named.X, self._std_slopes)
        coords = {
            "input": [one.name for one in self.inputs_],
            "input_units": ("input", [i.units for i in self.inputs_]),
        }
        answer = {}
        for suffix, slopes in parts.items():
            for k, name in enumerate(self.outputs_):
                attrs = self.attrs_[name]
                what = f"{'standard deviation of ' if suffix else ''}{attrs.get('long_name', name)}"
                derivative = {"long_name": f"derivative of {what} with respect to the input"}
                derivative |= {"units": f"({attrs['units']}) / input_units"} if "units" in attrs else {}
                each = slopes[:, k].reshape(-1, *named.shape)
                answer[f"{name}{suffix}"] = xr.Variable(("input", *named.dims), each, derivative)
        flags = {} if outer is None else {"extrapolated": (outer, {"long_name": "outside the trained box"})}
        return named.dataset(flags).assign_coords(coords).assign(answer)

    def gradient_array(self, X: NDArray[np.floating[Any]]) -> Array:
        """Return the derivatives of the means at plain points, in physical units: X (n, d) -> (n, n_outputs, d).

        Raises OutOfBoxError for a point outside the box.
        """
        points = np.asarray(X, dtype=np.float64)
        require_inside(points, self.inputs_)
        return np.ascontiguousarray(self._physical_slopes(points, self._slopes).T)

    def score(self, X: xr.Dataset, y: xr.Dataset | None = None) -> float:
        """Return the coefficient of determination R2 averaged over the outputs.

        Parameters
        ----------
        X : Dataset
            Cases with inputs and outputs: the kind of data set that `fit` takes, or scattered cases.
        y : Dataset, optional
            The outputs, when X holds the inputs only.
        """
        points, truth = self.cases(X if y is None else X.merge(y, join="exact"))
        mean = self.predict(points, return_std=False)
        scores = []
        for name in self.outputs_:
            true, predicted = xr.broadcast(truth[name], mean[name])
            spread = float(((true - true.mean()) ** 2).sum())
            error = float(((true - predicted) ** 2).sum())
            scores.append(1 - error / spread if spread else float(error == 0))
        return float(np.mean(scores))

    def cases(self, dataset: xr.Dataset) -> tuple[dict[str, xr.DataArray], xr.Dataset]:
        """Take a data set of cases, factorial or scattered, apart into points and true outputs.

        Raises ValueError for an input or output that it lacks.
        """
        self._require_fitted()
        for name in [one.name for one in self.inputs_] + list(self.outputs_):
            if name not in dataset.variables:
                raise ValueError(f"{name!r} is not in the data set; it has {', '.join(map(str, dataset.variables))}")
        return {one.name: dataset[one.name] for one in self.inputs_}, dataset[list(self.outputs_)]

    def calibrate(self, dataset: xr.Dataset) -> Self:
        """Make the standard deviations right on held-out cases: marginally, and in every slab of every input.

        The means stay as they are. A nominal 95 % interval is the mean +- 1.96 standard deviations.

        Parameters
        ----------
        dataset : Dataset
            Held-out cases, inputs and true outputs over one dimension; 3,000 spread over the box are a good number, 500
            give the right marginal coverage. They must not serve for validation as well.

        Raises
        ------
        ValueError
            Missing variables, NaN, a case outside the box, or too few cases.
        """
        points, truth = self.cases(dataset)
        named = named_points(points, self.inputs_)
        require_inside(named.X, self.inputs_)
        t = unit_coordinates(self.inputs_, named.X)
        like = named.labelled(np.zeros(len(named.X)), {})
        true = np.stack([named.flat(truth[name], like) for name in self.outputs_])
        bad = ~np.isfinite(true).all(axis=1)
        if bad.any():
            raise ValueError(f"output {self.outputs_[int(bad.argmax())]!r} is not finite in a case of the calibration")
        blocks = list(_slices(t.shape[1]))
        mean = np.concatenate([self._mean_variance(t[:, block], None)[0] for block in blocks], axis=1)
        single = np.repeat(np.eye(self.parts)[..., None], len(self.outputs_), axis=2)  # weights of one part alone
        parts = [
            np.concatenate([self._variance(t[:, block], weights) for block in blocks], axis=1) for weights in single
        ]
        self.calibration_ = calibrate(mean - true, parts, t)
        return self

    def _physical_slopes(self, X: Array, scaled: Callable[[Array], Array]) -> Array:
        """Turn derivatives in scaled coordinates into those in physical inputs, at points (n, d): (d, p, n)."""
        slopes = np.empty((len(self.inputs_), len(self.outputs_), len(X)))
        for block in _slices(len(X)):
            slopes[..., block] = scaled(unit_coordinates(self.inputs_, X[block]))
        chain = np.stack([one.unit_slope(X[:, k]) for k, one in enumerate(self.inputs_)])
        return np.asarray(slopes * chain[:, None, :])

    def _std_slopes(self, t: Array) -> Array:
        weights = self._weights()
        variance, slopes = self._variance(t, weights), self._variance_slopes(t, weights)
        if self.calibration_ is not None:
            return self.calibration_.std_slopes(variance, slopes, t)
        return np.asarray(slopes / (2 * np.sqrt(np.where(variance > 0, variance, np.inf))))

    def _weights(self) -> Array:
        return np.ones((self.parts, len(self.outputs_))) if self.calibration_ is None else self.calibration_.weights

    def _require_fitted(self) -> None:
        if not hasattr(self, "inputs_"):
            raise NotFittedError(f"this {type(self).__name__} is not fitted yet; call fit first")

    def _checked(self, named: Points, extrapolate: bool) -> Flags | None:
        if not extrapolate:
            require_inside(named.X, self.inputs_)
            return None
        return np.asarray(outside(named.X, self.inputs_).any(axis=1))

    def _blocks(self, X: Array, return_std: bool) -> tuple[Array, Array | None]:
        mean = np.empty((len(self.outputs_), len(X)))
        std = np.empty_like(mean) if return_std else None
        calibration, weights = self.calibration_, self._weights() if return_std else None
        for block in _slices(len(X)):
            t = unit_coordinates(self.inputs_, X[block])
            mean[:, block], variance = self._mean_variance(t, weights)
            if std is not None and variance is not None:
                std[:, block] = np.sqrt(variance) if calibration is None else calibration.std(variance, t)
        return mean, std

    def _variance(self, t: Array, weights: Array) -> Array:
        variance = self._mean_variance(t, weights)[1]
        return np.zeros((len(self.outputs_), t.shape[1])) if variance is None else variance


def _slices(count: int) -> Iterator[slice]:
    return (slice(start, start + BLOCK) for start in range(0, count, BLOCK))
