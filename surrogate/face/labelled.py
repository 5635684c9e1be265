"""Answers by name: means, standard deviations and derivatives as labelled arrays, where the model has answers."""

from collections.abc import Mapping
from copy import copy
from typing import Any, Literal, Self, overload

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Array, Flags, unmasked
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.labels import Attrs, Labels
from surrogate.data.points import Points, Queries, named_points, outside, require_inside
from surrogate.face.physical import Physical
from surrogate.face.region import Region

# Standard deviations below are zero: rounding that keeps logarithms finite, as of an output that is 0 everywhere.
SMALLEST = float(np.finfo(np.float64).tiny ** 0.25)
#: Attributes of the variable that tells where an answer is outside of the trained box.
EXTRAPOLATED = {"extrapolated": {"long_name": "outside the trained box"}}


class Labelled(Physical):
    """A model asked at labelled points, or at plain ones, (n, d), in the physical units of its inputs.

    Attributes
    ----------
    region_ : Region or None
        Where in the box it has answers; None where that is all of it.
    """

    region_: Region | None = None
    _made_labels: Labels | None = None

    @property
    def box(self) -> Mapping[str, Input]:
        """The trained box: name -> Input, in order."""
        self._require_fitted()
        return {own.name: own for own in self.inputs_}

    def predict(self, points: Queries, return_std: bool = True, *, extrapolate: bool = False) -> xr.Dataset:
        """Predict every output, with its standard deviation, at points.

        Parameters
        ----------
        points : mapping, Dataset, DataFrame or array
            One entry per input, in physical units: a scalar, a DataArray of any dimensions, or a plain sequence, which
            becomes a dimension named after its input; dimensions broadcast, so sequences span the full factorial. A
            DataFrame with a column an input, or a list of mappings, is a table: its rows lie along dimension `case`.
            An array is (n, d) in the order of the inputs: points along dimension `point`.
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
        points = np.asarray(unmasked(X), dtype=np.float64)
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
        points = np.asarray(unmasked(X), dtype=np.float64)
        self.require_answers(points)
        return np.ascontiguousarray(self.physical_slopes(points, self.slopes).T)

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

    def _labels(self) -> Labels:
        if self._made_labels is None or self._made_labels.attrs is not self.attrs_:
            self._made_labels = Labels(self.attrs_)
        return self._made_labels

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
