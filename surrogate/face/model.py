"""Base class of all surrogates: labelled answers with intervals, and their calibration."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping, Sequence
from copy import copy
from functools import partial
from html import escape
from typing import Any, ClassVar, Literal, Self, overload

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Array, Flags, Indices, blocks, unmasked
from surrogate.data.inputs import Input, physical_points, unit_coordinates
from surrogate.data.points import EVEN, Points, Queries, named_points, outside, require_inside
from surrogate.intervals.calibration import MINIMUM, Calibration
from surrogate.intervals.conformal import calibrate
from surrogate.intervals.copula import ends
from surrogate.intervals.distribution import NOMINAL, Distribution, Normal
from surrogate.intervals.guard import sharing

BLOCK = 2048  # queries that are answered at a time: intermediate arrays stay in cache
# Smaller standard deviations count as zero: they come from bounds that keep logarithms finite.
SMALLEST = float(np.finfo(np.float64).tiny ** 0.25)
NAMED = 12  # most outputs that `print` names


class GaussianProcess(ABC):
    """Base of the surrogates: several outputs over named inputs, each a distribution at every point.

    Subclasses fit to a data set and implement the abstract methods, which answer at B points in scaled coordinates,
    (d, B). This class checks, labels and scales. `surrogate.FactorialRegressor` is an estimator of scikit-learn.

    Attributes
    ----------
    inputs_ : tuple of Input
    outputs_ : tuple of str
    attrs_ : dict
        `units` and `long_name` of every output.
    calibration_ : Calibration or None
        Result of `calibrate`; None before.
    level_ : float
        Default level of intervals.
    cases_ : int
        Number of training cases.
    made_from_ : str
        The caller's note of the model's origin, stored in its file; empty by default.

    Examples
    --------
    >>> from surrogate import GridGP, Input
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

    Held-out cases correct means and calibrate intervals:

    >>> rng = np.random.default_rng(0)
    >>> cases = xr.Dataset({"x": ("case", rng.uniform(0, 1, 300)), "y": ("case", rng.uniform(1, 2, 300))})
    >>> cases = cases.assign(f=np.exp(cases.x) * cases.y, g=cases.x + cases.y)
    >>> model.score(cases) > 0.999999, sorted(model.cases(cases)[1])
    (True, ['f', 'g'])
    >>> median = model.calibrate(cases).quantile({"x": 0.2, "y": 1.5}, 0.5)
    >>> bool(abs(median["f"] - 1.5 * np.exp(0.2)) < 1e-6)
    True
    >>> lower, upper = model.interval_array(np.array([[0.2, 1.5]]))
    >>> bool((lower < upper).all()), model.calibrated, model.distribution.cases
    (True, True, 300)
    >>> least, most = model.ends_of_sum(np.array([[0.2, 1.5]]), np.array([[1.0, -1.0]]))  # of f - g
    >>> bool(least < 0 < most)
    True
    >>> model.has_answers(np.array([[0.2, 1.5], [0.2, 3.0]])).tolist()
    [True, False]
    >>> model.check_level(0.9)
    >>> model.only(["g"]).outputs_, model.thinned({"f": 1e-3}).outputs_, model.uncalibrated().calibration_
    (('g',), ('f', 'g'), None)
    """

    engine: ClassVar[str]  # name of the kind in files
    MEMBERS: ClassVar[tuple[str, ...]] = ()
    inputs_: tuple[Input, ...]
    outputs_: tuple[str, ...]
    attrs_: dict[str, dict[str, str]]
    cases_: int
    made_from_: str = ""
    calibration_: Calibration | None
    level_: float = NOMINAL
    # The `attrs_`, and the first answer at one point of each kind, which is copied for later ones: to check the names,
    # shapes and coordinates of an answer costs more than the answer.
    _forms: tuple[dict[str, dict[str, str]], dict[Hashable, xr.Dataset]] | None = None

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a data set that holds inputs and outputs."""
        raise NotImplementedError(f"a {type(self).__name__} is not fitted to a data set")

    @property
    @abstractmethod
    def parts(self) -> int:
        """Number of parts whose sum is the variance."""

    @abstractmethod
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array]:
        """Return means and variances, (p, B) each; variances are zero without `weights`, (parts, p), of their parts."""

    @abstractmethod
    def slopes(self, t: Array) -> Array:
        """Return the derivatives of the means by the scaled coordinates, (d, p, B)."""

    @abstractmethod
    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the variances of the derivatives, (d, p, B), with weights of their parts, (parts, p)."""

    @abstractmethod
    def state(self) -> xr.Dataset:
        """Return the contents of the model's file besides inputs, outputs, probes and calibration."""

    @classmethod
    @abstractmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the model of a `state`, with the `attrs_` of its outputs; ValueError names what is inconsistent."""

    def only(self, outputs: Sequence[str]) -> Self:
        """Return a cheaper model with these outputs and as few others as possible."""
        return self

    def thinned(self, errors: Mapping[str, float]) -> Self:
        """Return a cheaper model; `errors` are allowed root-mean-square errors of outputs over the cases."""
        return self

    def corrected(self, dataset: xr.Dataset, errors: Array, t: Array, groups: Indices) -> Array:
        """Learn to correct the means from held-out cases; return the errors left of each case, left out, (p, n).

        errors: (p, n), true minus predicted at t, (d, n); groups: (n,), of cases that share coordinates.
        """
        return errors

    @property
    def members(self) -> Mapping[str, "GaussianProcess"]:
        """The models that this one wraps, by the names of `MEMBERS`; they are stored in its file."""
        return {}

    def over(self, members: Mapping[str, "GaussianProcess"]) -> Self:
        """Return a copy that wraps other members; ValueError unless they fit."""
        return self

    @property
    def calibrated(self) -> bool:
        """Return True if the intervals rest on held-out cases."""
        return self.calibration_ is not None

    def __str__(self) -> str:
        if not hasattr(self, "inputs_"):
            return f"{type(self).__name__}, not fitted yet"
        kind, outputs, intervals = self._in_words()
        wide = max(len(input_.name) for input_ in self.inputs_)
        ranges = [f"  {input_.name:<{wide}}  {input_.range_text()}, {input_.scale}" for input_ in self.inputs_]
        return "\n".join([kind, "inputs:", *ranges, f"outputs: {outputs}", f"intervals: {intervals}"])

    def _repr_html_(self) -> str:
        """Return HTML for a notebook: the text of `print`, with the box as a table."""
        if not hasattr(self, "inputs_"):
            return f"<p><b>{type(self).__name__}</b>, not fitted yet</p>"
        import pandas as pd  # notebooks only

        kind, outputs, intervals = self._in_words()
        rows = [(input_.name, input_.low, input_.high, input_.units, input_.scale) for input_ in self.inputs_]
        box = pd.DataFrame(rows, columns=["input", "low", "high", "unit", "scale"])
        table = box.to_html(index=False, border=0)
        return f"<p><b>{kind}</b>: {escape(outputs)}; intervals {intervals}</p>{table}"

    def _in_words(self) -> tuple[str, str, str]:
        """Return the model's kind with its counts, its outputs with their units, and its calibration as texts."""
        units = {name: f" [{self.attrs_[name]['units']}]" for name in self.outputs_ if self.attrs_[name].get("units")}
        outputs = ", ".join(f"{name}{units.get(name, '')}" for name in self.outputs_[:NAMED])
        unnamed = len(self.outputs_) - NAMED
        counts = f"{len(self.outputs_)} outputs over {len(self.inputs_)} inputs, trained on {self.cases_:,} cases"
        held = "not calibrated"
        if self.calibration_ is not None:
            held = f"calibrated on {self.calibration_.distribution.cases:,} cases"
        return f"{type(self).__name__} of {counts}", outputs + (f" and {unnamed} more" if unnamed > 0 else ""), held

    def score(self, X: xr.Dataset, y: xr.Dataset | None = None) -> float:
        """Return the coefficient of determination R2 averaged over the outputs.

        Parameters
        ----------
        X : Dataset
            Cases with inputs and outputs: the kind of data set that `fit` takes, or scattered cases.
        y : Dataset, optional
            The outputs, when X holds the inputs only.
        """
        from sklearn.metrics import r2_score  # slow to import

        points, truth = self.cases(X if y is None else X.merge(y, join="exact"))
        named = named_points(points, self.inputs_)
        return float(r2_score(named.stacked(truth, self.outputs_).T, self.predict_array(named.X)))

    def cases(self, dataset: xr.Dataset) -> tuple[dict[str, xr.DataArray], xr.Dataset]:
        """Return points and true outputs of a data set of cases; ValueError for a missing input or output."""
        self._require_fitted()
        for name in [input_.name for input_ in self.inputs_] + list(self.outputs_):
            if name not in dataset.variables:
                raise ValueError(f"{name!r} is not in the data set; it has {', '.join(map(str, dataset.variables))}")
        return {input_.name: dataset[input_.name] for input_ in self.inputs_}, dataset[list(self.outputs_)]

    def calibrate(self, dataset: xr.Dataset) -> Self:
        """Correct the means, and calibrate the distributions in all parts of the box, on held-out cases.

        Only means of grids on Chebyshev-Gauss levels are corrected (module `correction`). The distributions hold at
        every level (module `conformal`).

        Parameters
        ----------
        dataset : Dataset
            Held-out cases, inputs and true outputs over one dimension; 10,000 spread over the box are a good number,
            3,000 leave corners of two inputs about 5 % short, and 500 give the right marginal coverage. They must not
            serve for validation as well. The optional variable `evenly_drawn` is 1 for cases that are spread evenly
            and 0 for those that are drawn towards the ends of the box.

        Raises
        ------
        ValueError
            Missing variables, NaN, a case outside the box, or fewer than 40 cases.
        """
        return self.calibrate_under(dataset, None)

    def calibrate_under(self, dataset: xr.Dataset, outer: Array | None) -> Self:
        """Calibrate as `calibrate` does; outer, (e, n): scaled inputs, at the cases, of a model that wraps this one."""
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
        true = named.stacked(truth, self.outputs_)
        bad = ~np.isfinite(true).all(axis=1)
        if bad.any():
            raise ValueError(f"output {self.outputs_[int(bad.argmax())]!r} is not finite in a case of the calibration")
        mean = self.uncalibrated().means(t)
        single = np.repeat(np.eye(self.parts)[..., None], len(self.outputs_), axis=2)  # weights of one part alone
        parts = [in_blocks(t, partial(self.variance, weights=weights)) for weights in single]
        groups = sharing(t)
        left = self.corrected(dataset, true - mean, t, groups)
        self.calibration_ = calibrate(left, parts, t, groups, even, outer)
        return self

    def uncalibrated(self) -> Self:
        """Return the model without the results of `calibrate`."""
        plain = copy(self)
        plain.calibration_ = None
        return plain

    @property
    def box(self) -> Mapping[str, Input]:
        """The trained box: inputs by name, in order."""
        self._require_fitted()
        return {input_.name: input_ for input_ in self.inputs_}

    def predict(self, points: Queries, return_std: bool = True, *, extrapolate: bool = False) -> xr.Dataset:
        """Predict every output, with its standard deviation, at points.

        Parameters
        ----------
        points : mapping, Dataset, DataFrame or array
            One entry per input, in physical units: a scalar, a DataArray of any dimensions, or a plain sequence, which
            becomes a dimension named after its input; dimensions broadcast, so sequences span the full factorial. A
            DataFrame with one column per input, a mapping of Series with one index, or a list of mappings is a table
            with rows along dimension `case`. An array is (n, d) in the order of the inputs: points along `point`.
        return_std : bool
            Add `<output>_std`, half of the central 68 % of the predictive distribution, which is not Gaussian: see
            `interval` for the 95 % interval.
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
        named, mean, std = self._asked(points, return_std, extrapolate)
        deviations = {("_std", "standard deviation of {}"): std} if return_std else {}
        return self._labelled(named, {("", "{}"): mean, **deviations}, extrapolate)

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
        """Return means or, with `return_std`, means and standard deviations at plain points, (n, p) each.

        Parameters
        ----------
        X : ndarray, shape (n, d), points in physical units
        return_std, extrapolate
            As for `predict`.

        Raises
        ------
        OutOfBoxError
            A point is outside of the box, or NaN, without `extrapolate`.
        ValueError
            The points have a wrong shape.
        """
        mean, std = self._answers(self._plain(X), return_std, extrapolate)
        return (mean.T, std.T) if return_std else mean.T

    def _plain(self, X: NDArray[np.floating[Any]]) -> Array:
        """Return plain points, (n, d), with NaN in masked cells; ValueError for another shape."""
        points = np.asarray(unmasked(X), dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != len(self.inputs_):
            raise ValueError(f"points must have shape (n, {len(self.inputs_)}), got {points.shape}")
        return points

    def gradient(
        self, points: Queries, return_std: bool = False, *, level: float | None = None, extrapolate: bool = False
    ) -> xr.Dataset:
        """Return d output/d input at points, analytically, in physical units; errors as for `predict` and `interval`.

        Parameters
        ----------
        points, extrapolate
            As for `predict`.
        return_std : bool
            Add standard deviations and intervals of the derivatives.
        level : float, probability of the intervals; None: `level_`

        Returns
        -------
        xarray.Dataset
            `<output>` over (`input`, the points' dimensions); the coordinates `input` and `input_units` name the inputs
            and their units. With `return_std` also `<output>_std`, `<output>_lower` and `<output>_upper` of the
            derivatives, from the process's variance of its derivatives and the calibration of its values.
        """
        self._require_fitted()
        level = self.checked_level(level)
        named = named_points(points, self.inputs_)
        if not extrapolate:
            require_inside(named.X, self.inputs_)
        slopes = self.physical_slopes(named.X, self.slopes).swapaxes(0, 1)
        parts = {("", "derivative of {} with respect to the input"): slopes}
        if return_std:
            std = self.physical_slopes(named.X, self.slope_stds).swapaxes(0, 1)
            parts["_std", "standard deviation of the derivative of {} with respect to the input"] = std
            parts |= self._ends(level, slopes, std, "the derivative of {} with respect to the input")
        coords = {
            "input": [input_.name for input_ in self.inputs_],
            "input_units": ("input", [i.units for i in self.inputs_]),
        }
        answer = self._labelled(named, parts, extrapolate, ("input",), "({}) / input_units")
        return answer.assign_coords(coords)

    def gradient_array(self, X: NDArray[np.floating[Any]]) -> Array:
        """Return derivatives of the means at plain points, (n, d): (n, n_outputs, d); OutOfBoxError outside the box."""
        points = self._plain(X)
        require_inside(points, self.inputs_)
        return np.ascontiguousarray(self.physical_slopes(points, self.slopes).T)

    def has_answers(self, X: Array) -> Flags:
        """Return which physical points, (n, d), are in the box; (n,)."""
        return np.asarray(~outside(X, self.inputs_).any(axis=1))

    def _require_fitted(self) -> None:
        if not hasattr(self, "inputs_"):
            from sklearn.exceptions import NotFittedError  # slow to import

            raise NotFittedError(f"this {type(self).__name__} is not fitted yet; call fit first")

    def _asked(self, points: Queries, with_std: bool, extrapolate: bool) -> tuple[Points, Array, Array]:
        """Return query points with their means and, if wanted, standard deviations, (p, n) each."""
        self._require_fitted()
        named = named_points(points, self.inputs_)
        return named, *self._answers(named.X, with_std, extrapolate)

    def _labelled(
        self,
        named: Points,
        parts: Mapping[tuple[str, str], Array],
        extrapolate: bool,
        leading: tuple[str, ...] = (),
        units: str = "{}",
    ) -> xr.Dataset:
        """Return the parts of an answer, (p, ..., n), as a data set; keys: ends of their names, formats of long names.

        leading: dimensions before those of the points; units: format of the parts' units, for those of an output.
        """
        values = {
            f"{name}{suffix}": rows.reshape((*rows.shape[:-1], *named.shape))
            for name, *columns in zip(self.outputs_, *parts.values(), strict=True)
            for (suffix, _), rows in zip(parts, columns, strict=True)
        }
        if extrapolate:
            values["extrapolated"] = ~self.has_answers(named.X).reshape(named.shape)
        if self._forms is None or self._forms[0] is not self.attrs_:
            self._forms = self.attrs_, {}
        forms, kind = self._forms[1], (*parts, extrapolate)
        if named.dims or leading or kind not in forms:
            attrs = {"extrapolated": {"long_name": "outside the trained box"}}
            for name, known in self.attrs_.items():
                for suffix, meaning in parts:
                    said = {} if meaning == "{}" else {"long_name": meaning.format(known.get("long_name", name))}
                    said |= {"units": units.format(known["units"])} if "units" in known else {}
                    attrs[f"{name}{suffix}"] = {**known, **said}
            dims = (*leading, *named.dims)  # `extrapolated` has no leading ones
            variables = {
                name: xr.Variable(dims[len(dims) - array.ndim :], array, attrs[name]) for name, array in values.items()
            }
            answer = xr.Dataset(variables, named.coords)
            if dims:
                return answer
            forms[kind] = answer
        copied = forms[kind].copy(data=values)
        for label, coordinate in named.coords.items():
            copied.variables[label].values = coordinate.values
        return copied

    def _answers(self, X: Array, return_std: bool, extrapolate: bool) -> tuple[Array, Array]:
        """Return means and standard deviations at points (n, d), (p, n) each; OutOfBoxError unless `extrapolate`."""
        if not extrapolate:
            require_inside(X, self.inputs_)
        mean, std = self.all_mean_std(X, return_std)
        return mean, np.where(std < SMALLEST, 0.0, std)

    def interval(self, points: Queries, level: float | None = None, *, extrapolate: bool = False) -> xr.Dataset:
        """Return the ends of the central interval that contains the true output with probability `level`.

        Before `calibrate` it is the process's own interval, which may be wrong.

        Parameters
        ----------
        points, extrapolate
            As for `predict`.
        level : float, optional
            0 < level < 1, by default `level_`; n calibration cases allow levels up to 1 - 2/(n + 1), at most 0.999.

        Returns
        -------
        Dataset
            `<output>_lower` and `<output>_upper` over the broadcast dimensions.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict`; a level beyond what the calibration cases allow.

        Examples
        --------
        >>> import numpy as np, xarray as xr
        >>> from surrogate import GridGP, Input
        >>> x, y = Input("x", 0, 1), Input("y", 0, 1)
        >>> def truth(x, y):
        ...     return np.exp(x * y) / (1 + x)
        >>> grid = xr.Dataset(coords={"x": x.levels(6), "y": y.levels(4)})
        >>> model = GridGP(inputs=[x, y]).fit(grid.assign(f=truth(grid.x, grid.y)))
        >>> rng = np.random.default_rng(0)
        >>> cases = xr.Dataset({name: ("case", rng.uniform(size=500)) for name in "xy"})
        >>> found = model.calibrate(cases.assign(f=truth(cases.x, cases.y))).interval({"x": 0.3, "y": 0.8}, level=0.9)
        >>> bool(found["f_lower"] <= truth(0.3, 0.8) <= found["f_upper"])
        True
        """
        level = self.checked_level(level)
        named, mean, std = self._asked(points, True, extrapolate)
        return self._labelled(named, self._ends(level, mean, std, "{}"), extrapolate)

    def _ends(self, level: float, mean: Array, std: Array, what: str) -> dict[tuple[str, str], Array]:
        """Return the ends of the interval about means (p, ..., n) for `_labelled`; what: format of the long names."""
        deviations = self.distribution.ends(level).reshape(2, -1, *[1] * (mean.ndim - 1))
        return {
            (f"_{end}", f"{end} end of the {100 * level:g} % interval of {what}"): mean + score * std
            for end, score in zip(("lower", "upper"), deviations, strict=True)
        }

    def quantile(self, points: Queries, q: float | Sequence[float], *, extrapolate: bool = False) -> xr.Dataset:
        """Return the values that the true output does not exceed with probability q.

        Parameters
        ----------
        points, extrapolate
            As for `predict`.
        q : float or sequence of float
            Probabilities within the range of the levels of `interval`.

        Returns
        -------
        Dataset
            `<output>` over the broadcast dimensions; with a sequence, over `quantile` before them.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict`; a probability beyond what the calibration cases allow.
        """
        probabilities = np.atleast_1d(np.asarray(q, dtype=np.float64))
        if probabilities.ndim != 1:
            raise ValueError(
                f"q must be a number or a sequence of numbers, got an array of {probabilities.ndim} dimensions"
            )
        most = (1 + self.distribution.highest_level()) / 2
        for probability in probabilities[~((1 - most <= probabilities) & (probabilities <= most))]:
            raise ValueError(f"q {probability:g} is not between {1 - most:.4g} and {most:.10g}{self._told()}")
        named, mean, std = self._asked(points, True, extrapolate)
        values = mean[:, None] + self.distribution.quantile(probabilities).T[..., None] * std[:, None]
        coordinate = ("quantile", probabilities, {"long_name": "probability of no more"})
        quantiles = self._labelled(named, {("", "{}"): values}, extrapolate, ("quantile",))
        quantiles = quantiles.assign_coords(quantile=coordinate)
        return quantiles if np.ndim(q) else quantiles.isel(quantile=0)

    def ends_of_sum(self, X: NDArray[np.floating[Any]], weights: Array, level: float | None = None) -> Array:
        """Return the ends of the interval of a weighted sum of outputs at points, less its mean.

        Parameters
        ----------
        X : ndarray, shape (n, d)
            Plain points.
        weights : ndarray, shape (n, n_outputs)
            Signed weights, such as the derivatives of a function of the outputs.
        level : float, optional
            As for `interval`.

        Returns
        -------
        ndarray, shape (2,)
            From the joint distribution of errors (module `copula`); without a calibration, the sum of the ends.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict_array` and `interval`.
        """
        _, std = self.predict_array(X, return_std=True)
        copula = None if self.calibration_ is None else self.calibration_.copula
        known = self.calibrated_at(np.asarray(X, dtype=np.float64))
        return ends(self.distribution, copula, self.checked_level(level), (weights * std).T, known)

    def interval_array(
        self, X: NDArray[np.floating[Any]], level: float | None = None, *, extrapolate: bool = False
    ) -> tuple[Array, Array]:
        """Return the lower and upper ends of `interval` at plain points, (n, p) each.

        Parameters
        ----------
        X : ndarray, shape (n, d), points in physical units
        level, extrapolate
            As for `interval`.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict_array` and `interval`.
        """
        level = self.checked_level(level)
        mean, std = self.predict_array(X, return_std=True, extrapolate=extrapolate)
        lower, upper = (mean + deviations * std for deviations in self.distribution.ends(level))
        return lower, upper

    def all_mean_std(self, X: Array, with_std: bool) -> tuple[Array, Array]:
        """Return `mean_std` at any number of points (n, d), block by block: (p, n) each."""
        mean = np.empty((len(self.outputs_), len(X)))
        std = np.empty_like(mean)
        for block in blocks(len(X), BLOCK):
            mean[:, block], std[:, block] = self.mean_std(X[block], with_std)
        return mean, std

    def mean_std(self, X: Array, with_std: bool) -> tuple[Array, Array]:
        """Return means and, if wanted, calibrated standard deviations at physical points (B, d): (p, B) each."""
        t, calibration = unit_coordinates(self.inputs_, X), self.calibration_ if with_std else None
        mean, variance = self.mean_variance(t, self._weights() if with_std else None)
        return mean, np.sqrt(variance) if calibration is None else calibration.std(variance, t)

    def means(self, t: Array) -> Array:
        """Return the means at any number of scaled coordinates (d, n), block by block: (p, n)."""
        return in_blocks(t, lambda block: self.mean_variance(block, None)[0])

    def calibrated_at(self, X: Array) -> Array:
        """Return the scaled coordinates, (e, n), of physical points (n, d) in which the calibration is expressed."""
        return unit_coordinates(self.inputs_, X)

    def variance(self, t: Array, weights: Array) -> Array:
        """Return the variance of `mean_variance`, (p, B)."""
        return self.mean_variance(t, weights)[1]

    def physical_slopes(self, X: Array, scaled: Callable[[Array], Array]) -> Array:
        """Return derivatives by physical inputs at X (n, d): (d, p, n); scaled: derivatives (d, p, B) at (d, B)."""
        slopes = np.empty((len(self.inputs_), len(self.outputs_), len(X)))
        for block in blocks(len(X), BLOCK):
            slopes[..., block] = scaled(unit_coordinates(self.inputs_, X[block]))
        return np.asarray(slopes * self.unit_slopes(X))

    def unit_slopes(self, X: Array) -> Array:
        """Return the derivatives of the scaled coordinates by the inputs at physical points (n, d): (d, 1, n)."""
        return np.stack([input_.unit_slope(X[:, k]) for k, input_ in enumerate(self.inputs_)])[:, None]

    def physical(self, t: Array) -> Array:
        """Return the physical points of scaled coordinates, (d, n): (n, d)."""
        return physical_points(self.inputs_, t)

    def slope_stds(self, t: Array) -> Array:
        """Return the calibrated standard deviations of the derivatives by scaled coordinates (d, B): (d, p, B)."""
        std = np.sqrt(np.maximum(self.slope_variances(t, self._weights()), 0))
        return std if self.calibration_ is None else np.asarray(std * self.calibration_.stretch(t))

    @property
    def distribution(self) -> Distribution:
        """Distribution of (truth - mean) / std: that of the calibration cases, or standard normal without any."""
        return Normal() if self.calibration_ is None else self.calibration_.distribution

    def checked_level(self, level: float | None) -> float:
        """Return the level, by default `level_`; ValueError as `check_level`."""
        chosen = self.level_ if level is None else level
        self.check_level(chosen)
        return chosen

    def check_level(self, level: float) -> None:
        """Raise ValueError, with the allowed range, for a level beyond what the calibration cases allow."""
        most = self.distribution.highest_level()
        if not 0 < level <= most:
            raise ValueError(f"level {level:g} is not between 0 and {most:.10g}{self._told()}")

    def _told(self) -> str:
        """Return the end of a message that names the source of the bounds of levels."""
        if self.calibration_ is None:
            return ""
        return f", all that {self.calibration_.distribution.cases} calibration cases tell"

    def _weights(self) -> Array:
        return np.ones((self.parts, len(self.outputs_))) if self.calibration_ is None else self.calibration_.weights


def in_blocks(t: Array, evaluate: Callable[[Array], Array]) -> Array:
    """Evaluate a function at scaled coordinates t, (d, n), in blocks: (p, n)."""
    return np.concatenate([evaluate(t[:, block]) for block in blocks(t.shape[1], BLOCK)], axis=1)
