"""The face that all surrogates share: named, labelled inputs and outputs."""

from collections.abc import Mapping
from copy import copy
from functools import partial
from typing import Any, ClassVar, Literal, Self, overload

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Array, Flags
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.labels import Attrs
from surrogate.data.points import EVEN, Points, Queries, named_points, outside, require_inside
from surrogate.face.physical import Physical, in_blocks
from surrogate.face.region import Region
from surrogate.face.summary import page, text
from surrogate.intervals.calibration import MINIMUM
from surrogate.intervals.conformal import calibrate
from surrogate.intervals.predictive import EXTRAPOLATED, Predictive
from surrogate.intervals.sharing import sharing

# Standard deviations below are zero: rounding that keeps logarithms finite, as of an output that is 0 everywhere.
SMALLEST = float(np.finfo(np.float64).tiny ** 0.25)


class GaussianProcess(Physical, Predictive):
    """Base of the surrogates: several outputs over named inputs, each a distribution at every point.

    Subclasses fit on a data set and answer at scaled coordinates (`Core`); this class checks, labels and scales. They
    are no estimators of scikit-learn, which take plain arrays: `surrogate.FactorialRegressor` is one, over them.

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
    cases_ : int
        Number of cases that it was trained on.
    region_ : Region or None
        Where in the box it has answers; None where that is all of it.
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
    >>> least, most = model.ends_of_sum(np.array([[0.2, 1.5]]), np.array([[1.0, -1.0]]))  # of f - g
    >>> bool(least < 0 < most), model.everywhere() is model, model.within(None).region_
    (True, True, None)
    >>> float(model.reached(np.array(1.0), np.array(0.1), np.array(-2.0)))
    0.8
    >>> model.require_answers(np.array([[0.2, 1.5]]))
    >>> model.has_answers(np.array([[0.2, 1.5], [0.2, 3.0]])).tolist()
    [True, False]
    >>> model.check_level(0.9)
    >>> model.calibrate_under(cases, np.stack([cases.x, cases.y - 1])).calibrated  # by inputs of another
    True
    >>> model.only(["g"]).outputs_, model.thinned({"f": 1e-3}).outputs_, model.uncalibrated().calibration_
    (('g',), ('f', 'g'), None)
    """

    MEMBERS: ClassVar[tuple[str, ...]] = ()
    made_from_: str = ""
    region_: Region | None = None

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a data set that holds inputs and outputs."""
        raise NotImplementedError(f"a {type(self).__name__} is not fitted to a data set")

    @property
    def members(self) -> Mapping[str, "GaussianProcess"]:
        """Models that it is made of, by the names of `MEMBERS`: a file holds them too."""
        return {}

    def over(self, members: Mapping[str, "GaussianProcess"]) -> Self:
        """Return the same over other models than those that it is made of; ValueError unless they fit."""
        return self

    @property
    def calibrated(self) -> bool:
        """Whether its intervals rest on held-out cases."""
        return self.calibration_ is not None

    @property
    def box(self) -> Mapping[str, Input]:
        """The trained box: name -> Input, in order."""
        self._require_fitted()
        return {own.name: own for own in self.inputs_}

    def __str__(self) -> str:
        return text(self) if hasattr(self, "inputs_") else f"{type(self).__name__}, not fitted yet"

    def _repr_html_(self) -> str:
        """What a notebook shows: what `print` says, the box as a table."""
        return page(self) if hasattr(self, "inputs_") else f"<p><b>{type(self).__name__}</b>, not fitted yet</p>"

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
        """Predict at plain points: (n, p), or two of them with `return_std`.

        Parameters
        ----------
        X : ndarray, shape (n, d), points in physical units
        return_std : bool, whether the standard deviations are wanted too
        extrapolate : bool, whether points may be outside of the box

        Raises
        ------
        OutOfBoxError
            A point is outside of the box, or NaN, without `extrapolate`.
        ValueError
            The points have a wrong shape.
        """
        points = np.asarray(X, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != len(self.inputs_):
            raise ValueError(f"points must have shape (n, {len(self.inputs_)}), got {points.shape}")
        mean, std = self._answers(points, return_std, extrapolate)
        return (mean.T, std.T) if std is not None else mean.T

    def gradient(
        self, points: Queries, return_std: bool = False, *, level: float | None = None, extrapolate: bool = False
    ) -> xr.Dataset:
        """Return d output/d input at points, analytically, in physical units.

        Errors as for `predict` and `interval`.

        Parameters
        ----------
        points : mapping, Dataset, DataFrame or array, as of `predict`
        return_std : bool, whether standard deviations and intervals of the derivatives are wanted
        level : float, probability of the intervals; None: `level_`
        extrapolate : bool, whether points may be outside of the box

        Returns
        -------
        xarray.Dataset
            `<output>` over (`input`, the points' dimensions); the coordinates `input` and `input_units` name the inputs
            and their units. With `return_std`, of the derivatives, `<output>_std`, the standard deviation, and
            `<output>_lower` and `<output>_upper`, the ends of the interval. They rest on the process's own variance of
            its derivatives, stretched as `calibrate` stretches that of its values, and on the distribution of the
            values.
        """
        self._require_fitted()
        level = self.checked_level(level)
        named = named_points(points, self.inputs_)
        if not extrapolate:
            self.require_answers(named.X)
        slopes = self.physical_slopes(named.X, self.slopes)
        parts = {("", "derivative"): slopes}
        if return_std:
            std = self.physical_slopes(named.X, self.slope_stds)
            parts["_std", "standard deviation of the derivative"] = std
            for end, away in zip(("lower", "upper"), self.distribution.ends(level), strict=True):
                parts[f"_{end}", f"{end} end of the {100 * level:g} % interval of the derivative"] = (
                    slopes + away[:, None] * std
                )
        coords = {
            "input": [own.name for own in self.inputs_],
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
        self.require_answers(points)
        return np.ascontiguousarray(self.physical_slopes(points, self.slopes).T)

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
        for name in [own.name for own in self.inputs_] + list(self.outputs_):
            if name not in dataset.variables:
                raise ValueError(f"{name!r} is not in the data set; it has {', '.join(map(str, dataset.variables))}")
        return {own.name: dataset[own.name] for own in self.inputs_}, dataset[list(self.outputs_)]

    def calibrate(self, dataset: xr.Dataset) -> Self:
        """Make means and distributions right on held-out cases: marginally, and in slabs and corners of the box.

        The means of a grid on Chebyshev-Gauss levels are corrected by what the cases tell of their error (module
        `correction`); others stay as they are. The distributions are made to hold at every level (module `conformal`).

        Parameters
        ----------
        dataset : Dataset
            Held-out cases, inputs and true outputs over one dimension; 10,000 spread over the box are a good number,
            3,000 leave corners of two inputs about 5 % short, and 500 give the right marginal coverage. They must not
            serve for validation as well. Where some are drawn towards the ends of the box, the variable
            `evenly_drawn`, over the same dimension, is 1 for those that are spread evenly and 0 for these; -1 for
            cases that were asked for near one another: intervals about these have a scale of their own.

        Raises
        ------
        ValueError
            Missing variables, NaN, a case outside the box, or fewer than 40 cases.
        """
        return self.calibrate_under(dataset, None)

    def calibrate_under(self, dataset: xr.Dataset, outer: Array | None) -> Self:
        """As `calibrate`, for a model that stands on this one.

        Parameters
        ----------
        dataset
            As for `calibrate`.
        outer : ndarray, shape (e, n), or None
            Scaled coordinates of the cases in the inputs by which that model is asked.
        """
        points, truth = self.cases(dataset)
        named = named_points(points, self.inputs_)
        require_inside(named.X, self.inputs_)
        drawn = np.ones(len(named.X)) if EVEN not in dataset else dataset[EVEN].values.ravel()
        even = drawn > 0
        if np.count_nonzero(even) < MINIMUM:
            raise ValueError(
                f"calibration needs at least {MINIMUM} cases, got {np.count_nonzero(even)}; about 10,000 make it local"
            )
        t = unit_coordinates(self.inputs_, named.X)
        like = named.labelled(np.zeros(len(named.X)), {})
        true = np.stack([named.flat(truth[name], like) for name in self.outputs_])
        bad = ~np.isfinite(true).all(axis=1)
        if bad.any():
            raise ValueError(f"output {self.outputs_[int(bad.argmax())]!r} is not finite in a case of the calibration")
        plain = self.uncalibrated()
        mean = in_blocks(t, lambda block: plain.mean_variance(block, None)[0])
        single = np.repeat(np.eye(self.parts)[..., None], len(self.outputs_), axis=2)  # weights of one part alone
        parts = [in_blocks(t, partial(self.variance, weights=weights)) for weights in single]
        groups = sharing(t)
        left = self.corrected(dataset, true - mean, t, groups)
        self.calibration_ = calibrate(left, parts, t, groups, even, outer, drawn < 0)
        return self

    def uncalibrated(self) -> Self:
        """Return the model without what `calibrate` has learnt."""
        plain = copy(self)
        plain.calibration_ = None
        return plain

    def everywhere(self) -> Self:
        """Return the model with answers in all of its box, where cases are refused too; itself if none are."""
        return self if self.region_ is None else self.within(None)

    def within(self, region: Region | None) -> Self:
        """Return the model with answers in a region alone; None is all of its box."""
        model = copy(self)
        model.region_ = region
        return model

    def require_answers(self, X: Array) -> None:
        """Raise OutOfBoxError, naming input, value and what is allowed, unless it has answers at all points (n, d)."""
        require_inside(X, self.inputs_)
        if self.region_ is not None:
            self.region_.require(X, self.inputs_)

    def has_answers(self, X: Array) -> Flags:
        """Return at which physical points, (n, d), it has answers: in the box, and where no case is refused; (n,)."""
        inside = np.asarray(~outside(X, self.inputs_).any(axis=1))
        if self.region_ is not None and inside.any():
            inside[inside] = self.region_.inside(unit_coordinates(self.inputs_, X[inside]))
        return inside

    def _require_fitted(self) -> None:
        if not hasattr(self, "inputs_"):
            from sklearn.exceptions import NotFittedError  # slow to import

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
        return {"extrapolated": ~self.has_answers(named.X)} if extrapolate else {}

    def _answers(self, X: Array, return_std: bool, extrapolate: bool) -> tuple[Array, Array | None]:
        """Means and standard deviations at points (n, d), (p, n) each; OutOfBoxError unless `extrapolate`."""
        if self.region_ is not None and not extrapolate:
            self.require_answers(X)
        single = self.single() if len(X) == 1 else None
        answer = single(X[0].tolist(), return_std) if single else None
        if answer is not None:
            mean, std = answer[0][:, None], None if answer[1] is None else answer[1][:, None]
        else:
            if not extrapolate:
                require_inside(X, self.inputs_)
            mean, std = self.all_mean_std(X, return_std)
        return mean, None if std is None else np.where(std < SMALLEST, 0.0, std)
