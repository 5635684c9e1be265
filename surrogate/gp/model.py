"""The face that all surrogates share: named, labelled inputs and outputs."""

from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from html import escape
from typing import Any, ClassVar, Literal, Self, overload

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from sklearn.exceptions import NotFittedError

from surrogate.data.arrays import Array, Flags
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.labels import Attrs
from surrogate.data.points import Points, Queries, named_points, outside, require_inside
from surrogate.gp.grouping import Grouping
from surrogate.intervals.conformal import MINIMUM, Calibration, calibrate
from surrogate.intervals.distribution import NOMINAL
from surrogate.intervals.predictive import EXTRAPOLATED, Predictive
from surrogate.intervals.sharing import sharing

# Queries are answered in blocks of this size, so that intermediate arrays stay in cache and memory stays bounded.
BLOCK = 2048
# Standard deviations below are zero: rounding that keeps logarithms finite, as of an output that is 0 everywhere.
SMALLEST = float(np.finfo(np.float64).tiny ** 0.25)
# From the physical coordinates of one point, and whether standard deviations are wanted, to means and them, (p,) each;
# None for a point outside of the box.
Single = Callable[[Sequence[float], bool], tuple[Array, Array | None] | None]


class GaussianProcess(Predictive):
    """Base of the surrogates: several outputs over named inputs, each a distribution at every point.

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
    grouping : Grouping or None
        The groups of inputs that it stands on, if any.
    made_from_ : str
        A word of the caller's that tells what the model was made from, kept in its file; empty by default.

    Examples
    --------
    >>> from surrogate import GridGP
    >>> x, y = Input("x", 0, 1), Input("y", 1, 2)
    >>> grid = xr.Dataset(coords={"x": x.levels(7), "y": y.levels(7)})
    >>> model = GridGP(inputs=[x, y]).fit(grid.assign(f=np.exp(grid.x) * grid.y, g=grid.x + grid.y))
    >>> isinstance(model, GaussianProcess), list(model.box), model.parts
    (True, ['x', 'y'], 2)
    >>> found = model.predict({"x": [0.2, 0.4], "y": 1.5})
    >>> found["g"].values.round(6).tolist(), list(found.data_vars)
    ([1.7, 1.9], ['f', 'f_std', 'g', 'g_std'])
    >>> model.gradient({"x": 0.2, "y": 1.5})["g"].values.round(6).tolist()
    [1.0, 1.0]
    >>> model.predict_array(np.array([[0.2, 1.5]])).shape, model.gradient_array(np.array([[0.2, 1.5]])).shape
    ((1, 2), (1, 2, 2))

    Held-out cases make means and intervals right:

    >>> rng = np.random.default_rng(0)
    >>> cases = xr.Dataset({"x": ("case", rng.uniform(0, 1, 300)), "y": ("case", rng.uniform(1, 2, 300))})
    >>> cases = cases.assign(f=np.exp(cases.x) * cases.y, g=cases.x + cases.y)
    >>> model.score(cases) > 0.999999, sorted(model.cases(cases)[1])
    (True, ['f', 'g'])
    >>> median = model.calibrate(cases).quantile({"x": 0.2, "y": 1.5}, 0.5)
    >>> bool(abs(median["f"] - 1.5 * np.exp(0.2)) < 1e-6)
    True
    >>> model.sample({"x": 0.2, "y": 1.5}, n=5, seed=0)["f"].shape
    (5,)
    >>> lower, upper = model.interval_array(np.array([[0.2, 1.5]]))
    >>> bool((lower < upper).all()), model.calibrated, model.distribution.cases
    (True, True, 300)
    >>> model.check_level(0.9)
    >>> model.only(["g"]).outputs_, model.thinned({"f": 1e-3}).outputs_, model.uncalibrated().calibration_
    (('g',), ('f', 'g'), None)
    """

    engine: ClassVar[str]
    MEMBERS: ClassVar[tuple[str, ...]] = ()
    grouping: Grouping | None = None
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
    def _slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of the derivatives by the scaled coordinates, (d, p, B)."""

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

    def stored(self) -> xr.Dataset:
        """Return the state with what `calibrate` has learnt."""
        state = self.state()
        return state if self.calibration_ is None else state.assign(self.calibration_.state())

    @classmethod
    def restored(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the model of what `stored` gave, calibration and all; ValueError names what is inconsistent."""
        model = cls.restore(stored, inputs, outputs)
        model.calibration_ = Calibration.restore(stored, model.parts, len(inputs), len(outputs))
        return model

    @property
    def members(self) -> Mapping[str, "GaussianProcess"]:
        """Models that it is made of, by the names of `MEMBERS`: a file holds them too."""
        return {}

    def with_members(self, members: Mapping[str, "GaussianProcess"]) -> Self:
        """Return the restored model with the models that it is made of; ValueError unless they fit."""
        return self

    @property
    def calibrated(self) -> bool:
        """Whether its intervals rest on held-out cases."""
        return self.calibration_ is not None

    def only(self, outputs: Sequence[str]) -> Self:
        """Return a model that gives these outputs, and as few others as it can, for less."""
        return self

    def thinned(self, errors: Mapping[str, float]) -> Self:
        """Return a model that costs less to ask for, with root-mean-square errors of some outputs, in their units."""
        return self

    @property
    def box(self) -> Mapping[str, Input]:
        """The trained box: name -> Input, in order."""
        self._require_fitted()
        return {one.name: one for one in self.inputs_}

    def _repr_html_(self) -> str:
        """What a notebook shows: the box, the outputs, and whether intervals are calibrated."""
        if not hasattr(self, "inputs_"):
            return f"<p><b>{type(self).__name__}</b>, not fitted yet</p>"
        import pandas as pd  # notebooks only

        rows = [(one.name, one.low, one.high, one.units, one.scale) for one in self.inputs_]
        box = pd.DataFrame(rows, columns=["input", "low", "high", "unit", "scale"])
        learnt = self.calibration_
        held = "not calibrated" if learnt is None else f"calibrated on {learnt.distribution.cases:,} cases"
        outputs = ", ".join(map(escape, self.outputs_))
        table = box.to_html(index=False, border=0)
        return f"<p><b>{type(self).__name__}</b> of {outputs}; intervals {held}</p>{table}"

    def predict(self, points: Queries, return_std: bool = True, *, extrapolate: bool = False) -> xr.Dataset:
        """Predict every output, with its standard deviation, at points.

        Parameters
        ----------
        points : mapping, Dataset, DataFrame or array
            One entry per input, in physical units: a scalar, a DataArray of any dimensions, or a plain sequence, which
            becomes a dimension named after its input; dimensions broadcast, so sequences span the full factorial. A
            DataFrame has a column an input, an array is (n, d) in their order: points along dimension `point`.
        return_std : bool
            Add `<output>_std`, the standard deviation: half of the central 68 % of the predictive distribution. The
            95 % interval is not 1.96 of it to either side, since the distribution is not Gaussian: see `interval`.
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
        named, parts, flags = self._asked(points, return_std, extrapolate)
        values = {
            f"{name}{suffix}": part[k]
            for k, name in enumerate(self.outputs_)
            for suffix, part in zip(("", "_std"), parts, strict=False)
        }

        def attrs() -> Attrs:
            own = self.attrs_
            told = {name: f"standard deviation of {own[name].get('long_name', name)}" for name in self.outputs_}
            stds = {f"{name}_std": {**own[name], "long_name": told[name]} for name in self.outputs_}
            return {**own, **stds, **EXTRAPOLATED}

        return self._labels().dataset(("predict", return_std, extrapolate), named, {**values, **flags}, attrs)

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
        mean, std = self._answers(points, return_std, extrapolate)
        return (mean.T, std.T) if std is not None else mean.T

    def gradient(
        self, points: Queries, return_std: bool = False, *, level: float = NOMINAL, extrapolate: bool = False
    ) -> xr.Dataset:
        """Return d output/d input at points, analytically, in physical units.

        Parameters and errors as for `predict` and `interval`. Returns a Dataset with `<output>` over (`input`, the
        points' dimensions); the coordinates `input` and `input_units` name the inputs and their units. With
        `return_std` it has, of the derivatives, `<output>_std`, the standard deviation, and `<output>_lower` and
        `<output>_upper`, the ends of the interval at `level`. They rest on the process's own variance of its
        derivatives, stretched as `calibrate` stretches that of its values, and on the distribution of the values.
        """
        self._require_fitted()
        self.check_level(level)
        named = named_points(points, self.inputs_)
        if not extrapolate:
            require_inside(named.X, self.inputs_)
        slopes = self._physical_slopes(named.X, self._slopes)
        parts = {("", "derivative"): slopes}
        if return_std:
            std = self._physical_slopes(named.X, self._slope_stds)
            parts["_std", "standard deviation of the derivative"] = std
            for end, away in zip(("lower", "upper"), self.distribution.ends(level), strict=True):
                parts[f"_{end}", f"{end} end of the {100 * level:g} % interval of the derivative"] = (
                    slopes + away[:, None] * std
                )
        coords = {
            "input": [one.name for one in self.inputs_],
            "input_units": ("input", [i.units for i in self.inputs_]),
        }
        answer = {}
        for (suffix, what), values in parts.items():
            for k, name in enumerate(self.outputs_):
                attrs = self.attrs_[name]
                derivative = {"long_name": f"{what} of {attrs.get('long_name', name)} with respect to the input"}
                derivative |= {"units": f"({attrs['units']}) / input_units"} if "units" in attrs else {}
                each = values[:, k].reshape(-1, *named.shape)
                answer[f"{name}{suffix}"] = xr.Variable(("input", *named.dims), each, derivative)
        flags = {name: (flag, EXTRAPOLATED[name]) for name, flag in self._flags(named, extrapolate).items()}
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
        """Make means and distributions right on held-out cases: marginally, and in slabs and corners of the box.

        The means of a grid on Chebyshev-Gauss levels are corrected by what the cases tell of their error (module
        `correction`); others stay as they are. The distributions are made to hold at every level (module `conformal`).

        Parameters
        ----------
        dataset : Dataset
            Held-out cases, inputs and true outputs over one dimension; 10,000 spread over the box are a good number,
            3,000 leave corners of two inputs about 5 % short, and 500 give the right marginal coverage. They must not
            serve for validation as well.

        Raises
        ------
        ValueError
            Missing variables, NaN, a case outside the box, or fewer than 40 cases.
        """
        points, truth = self.cases(dataset)
        named = named_points(points, self.inputs_)
        require_inside(named.X, self.inputs_)
        if len(named.X) < MINIMUM:
            raise ValueError(
                f"calibration needs at least {MINIMUM} cases, got {len(named.X)}; about 10,000 make it local"
            )
        t = unit_coordinates(self.inputs_, named.X)
        like = named.labelled(np.zeros(len(named.X)), {})
        true = np.stack([named.flat(truth[name], like) for name in self.outputs_])
        bad = ~np.isfinite(true).all(axis=1)
        if bad.any():
            raise ValueError(f"output {self.outputs_[int(bad.argmax())]!r} is not finite in a case of the calibration")
        blocks, plain = list(_slices(t.shape[1])), self.uncalibrated()
        mean = np.concatenate([plain._mean_variance(t[:, block], None)[0] for block in blocks], axis=1)
        single = np.repeat(np.eye(self.parts)[..., None], len(self.outputs_), axis=2)  # weights of one part alone
        parts = [
            np.concatenate([self._variance(t[:, block], weights) for block in blocks], axis=1) for weights in single
        ]
        groups = sharing(t)
        self.calibration_ = calibrate(self._corrected(dataset, true - mean, t, groups), parts, t, groups)
        return self

    def uncalibrated(self) -> Self:
        """Return the model without what `calibrate` has learnt."""
        plain = copy(self)
        plain.calibration_ = None
        return plain

    def _corrected(self, dataset: xr.Dataset, errors: Array, t: Array, groups: NDArray[np.intp]) -> Array:
        """Learn to correct the mean from errors, true minus predicted (p, n); return what is left of each left out.

        The data set of the cases may hold more than the outputs.
        """
        return errors

    def _physical_slopes(self, X: Array, scaled: Callable[[Array], Array]) -> Array:
        """Turn derivatives in scaled coordinates into those in physical inputs, at points (n, d): (d, p, n)."""
        slopes = np.empty((len(self.inputs_), len(self.outputs_), len(X)))
        for block in _slices(len(X)):
            slopes[..., block] = scaled(unit_coordinates(self.inputs_, X[block]))
        chain = np.stack([one.unit_slope(X[:, k]) for k, one in enumerate(self.inputs_)])
        return np.asarray(slopes * chain[:, None, :])

    def _slope_stds(self, t: Array) -> Array:
        std = np.sqrt(np.maximum(self._slope_variances(t, self._weights()), 0))
        return std if self.calibration_ is None else np.asarray(std * self.calibration_.stretch(t))

    def _weights(self) -> Array:
        return np.ones((self.parts, len(self.outputs_))) if self.calibration_ is None else self.calibration_.weights

    def _require_fitted(self) -> None:
        if not hasattr(self, "inputs_"):
            raise NotFittedError(f"this {type(self).__name__} is not fitted yet; call fit first")

    def _asked(
        self, points: Queries, with_std: bool, extrapolate: bool
    ) -> tuple[Points, list[Array], dict[str, Flags]]:
        self._require_fitted()
        named = named_points(points, self.inputs_)
        parts = self._answers(named.X, with_std, extrapolate)
        return named, [part for part in parts if part is not None], self._flags(named, extrapolate)

    def _flags(self, named: Points, extrapolate: bool) -> dict[str, Flags]:
        """Which points lie outside, with `extrapolate`, under the name that answers give it."""
        return {"extrapolated": np.asarray(outside(named.X, self.inputs_).any(axis=1))} if extrapolate else {}

    def _single(self) -> Single | None:
        """Return the short way of one query alone, None where there is none."""
        return None

    def _answers(self, X: Array, return_std: bool, extrapolate: bool) -> tuple[Array, Array | None]:
        """Means and standard deviations at points (n, d), (p, n) each; OutOfBoxError unless `extrapolate`."""
        single = self._single() if len(X) == 1 else None
        found = single(X[0].tolist(), return_std) if single else None
        if found is not None:
            mean, std = found[0][:, None], None if found[1] is None else found[1][:, None]
        else:
            if not extrapolate:
                require_inside(X, self.inputs_)
            mean, std = self._blocks(X, return_std)
        return mean, None if std is None else np.where(std < SMALLEST, 0.0, std)

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
