"""Surrogates that are learnt over groups of inputs and queried by the inputs."""

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import ClassVar, Self

import numpy as np
import xarray as xr
from typing_extensions import override

from approximation.arrays import Array
from surrogate.data.inputs import Input, stored_inputs, unit_coordinates
from surrogate.data.points import EVEN, named_points
from surrogate.face.model import GaussianProcess
from surrogate.gp.gridgp import KERNEL, GridGP
from surrogate.transforms.groups import Grouping, Scales, Scaling
from surrogate.transforms.transformed import Transformed


class GroupedGP(Transformed):
    """A grid Gaussian process of scaled outputs over groups of inputs, queried by the inputs.

    The process learns the outputs of `Scales.transform` over the groups' axes; means, standard deviations, intervals,
    gradients and the box are those of the outputs by the inputs.

    Parameters
    ----------
    grouping : Grouping
        Inputs, axes and scales; its `scalings` name the outputs.
    hyperparameters, compression
        As for `GridGP`, of the process over the axes.
    process : callable, optional
        Returns another process over the axes, not fitted, such as a `CrossGP`, from the names of the outputs.

    Attributes
    ----------
    reduced_ : GaussianProcess
        The process over the axes, which `calibrate` corrects and calibrates on cases in the inputs' box.

    Examples
    --------
    The period of a pendulum over its length and gravity, from three cases:

    >>> import numpy as np, xarray as xr
    >>> from surrogate import Group, GroupedGP, Grouping, Input, Scaling
    >>> length, gravity, swing = Input("length", 0.1, 2, "log"), Input("gravity", 1, 20, "log"), Input("swing", 0, 0.5)
    >>> grouping = Grouping(
    ...     (length, gravity, swing), (Group(Input("relative_length", 0.005, 2, "log"), {"length": 1, "gravity": -1}),
    ...     Group(swing, {"swing": 1})), {"period": Scaling({"length": 0.5, "gravity": -0.5})})
    >>> axes = xr.Dataset(coords={axis.name: axis.levels(n) for axis, n in zip(grouping.axes, (2, 6))})
    >>> cases = axes.assign_coords(length=axes.relative_length * 9.81, gravity=9.81)  # any that have these values
    >>> period = 2 * np.pi * np.sqrt(cases.length / cases.gravity) * (1 + cases.swing**2 / 16)
    >>> model = GroupedGP(grouping).fit(cases.assign(period=period))
    >>> round(float(model.predict({"length": 1.0, "gravity": 1.62, "swing": 0.2}).period), 6)
    4.948878
    """

    engine: ClassVar[str] = "grouped"
    MEMBERS = CALIBRATED = ("reduced",)
    reduced_: GaussianProcess
    grouping: Grouping
    _scales: Scales

    def __init__(
        self,
        grouping: Grouping,
        hyperparameters: Mapping[str, float] | None = None,
        compression: float = 1e-12,
        process: Callable[[Sequence[str]], GridGP] | None = None,
    ) -> None:
        self.grouping = grouping
        self.process = process
        self.hyperparameters = hyperparameters
        self.compression = compression

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a complete factorial over the axes, or to the data set of another process.

        Parameters
        ----------
        X : Dataset
            Dimensions are the groups' axes with their levels as coordinates, or one dimension of places with the axes
            as coordinates. Variables are the outputs; every input is a variable or coordinate: any cases with these
            values of the groups.

        Raises
        ------
        ValueError
            As `GridGP.fit`; a missing input or output; the logarithm of an output that changes sign; inputs that do not
            have the axes' values.
        """
        names = tuple(self.grouping.scalings)
        for name in (*names, *(input_.name for input_ in self.grouping.inputs)):
            if name not in X.variables:
                raise ValueError(f"{name!r} is not in the data set; it has {', '.join(map(str, X.variables))}")
        self._check_axes(X)
        axes = self.grouping.axes
        data = self.grouping.reduced(X, names).assign_coords({axis.name: X[axis.name] for axis in axes})
        plain = GridGP(axes, names, self.hyperparameters, self.compression)
        process = plain if self.process is None else self.process(names)
        self.reduced_, self.inputs_ = process.fit(data), self.grouping.inputs
        self.cases_ = self.reduced_.cases_
        self._lay_out()
        return self

    def _lay_out(self) -> None:
        if self.reduced_.inputs_ != self.grouping.axes or set(self.reduced_.outputs_) != {*self.grouping.scalings}:
            raise ValueError("the process over the axes has other inputs or outputs")
        self.outputs_, self.attrs_ = self.reduced_.outputs_, self.reduced_.attrs_
        self.calibration_ = self.reduced_.calibration_
        outer = None if self.calibration_ is None else self.calibration_.outer
        if outer is not None and len(outer.slabs) != len(self.grouping.inputs):
            raise ValueError("the calibration's outer guard has other inputs")
        self._scales = Scales(self.grouping, self.outputs_)

    def _check_axes(self, X: xr.Dataset) -> None:
        columns = xr.broadcast(*(X[input_.name].reset_coords(drop=True) for input_ in self.grouping.inputs))
        like, points = columns[0], np.stack([column.values.ravel() for column in columns], axis=1)
        for axis, values in zip(self.grouping.axes, self.grouping.axis_values(points).T, strict=True):
            if axis.name not in X.dims and axis.name not in X.coords:
                raise ValueError(f"axis {axis.name!r} is no dimension of the data set")
            said = X[axis.name].broadcast_like(like).transpose(*like.dims).values.ravel()
            if np.abs(axis.to_unit(values) - axis.to_unit(said)).max() > 1e-8:
                raise ValueError(f"the inputs of the data set do not have its values of the axis {axis.name!r}")

    def calibrate(self, dataset: xr.Dataset) -> Self:
        """Correct means and calibrate distributions over the axes, as `GridGP.calibrate`, on cases in the box."""
        points, truth = self.cases(dataset)
        cases = xr.Dataset({**{name: column.reset_coords(drop=True) for name, column in points.items()}, **truth})
        named = named_points(points, self.inputs_)
        axes = {
            axis.name: (named.dims, values.reshape(named.shape))
            for axis, values in zip(self.grouping.axes, self.grouping.axis_values(named.X).T, strict=True)
        }
        reduced = self.grouping.reduced(cases, self.outputs_).assign(axes)
        if EVEN in dataset:
            reduced = reduced.assign({EVEN: dataset[EVEN].reset_coords(drop=True)})
        self.reduced_.calibrate_under(reduced, unit_coordinates(self.inputs_, named.X))
        self.calibration_ = self.reduced_.calibration_
        return self

    @override
    def _narrowed(self, outputs: Sequence[str]) -> tuple[Self, Sequence[str]]:
        part = copy(self)
        part.grouping = self.grouping.only(outputs)
        return part, outputs

    @override
    def thinned(self, errors: Mapping[str, float]) -> Self:
        """Return a cheaper model by the allowed errors of outputs that are learnt without scale or logarithm."""
        plain = {name: error for name, error in errors.items() if self.grouping.scalings.get(name) == Scaling()}
        return self.over({"reduced": self.reduced_.thinned(plain)}) if plain else self

    def state(self) -> xr.Dataset:
        """Return the groups; the process over the axes is stored as the member `reduced`."""
        return self.grouping.state(self.outputs_).assign_attrs(kernel=KERNEL, compression=self.compression)

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        attrs = stored.attrs
        if attrs["kernel"] != KERNEL:
            raise ValueError(f"unknown kernel {attrs['kernel']!r}")
        grouping = Grouping.restore(stored, stored_inputs(stored, "reduced_"), inputs, tuple(outputs))
        model = cls(grouping, None, float(attrs["compression"]))
        model.inputs_ = inputs
        return model

    # -- answers -------------------------------------------------------------------------------------------------------
    @override
    def calibrated_at(self, X: Array) -> Array:
        return self.reduced_.calibrated_at(self.grouping.axis_values(X))

    @override
    def mean_std(self, X: Array, with_std: bool) -> tuple[Array, Array]:
        learnt, spread = self.reduced_.mean_std(self.grouping.axis_values(X), with_std)
        mean = self._scales.untransform(learnt, X)
        return mean, spread * self._scales.sizes(X, mean) * self._guarded(X) if with_std else spread

    def _guarded(self, X: Array) -> Array | float:
        """Return the factors (p, n) on calibrated deviations at points (n, d), by their position in the box."""
        outer = None if self.calibration_ is None else self.calibration_.outer
        return 1.0 if outer is None else np.exp(outer.at(np.clip(unit_coordinates(self.inputs_, X), -1, 1)).T)

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array]:
        X = self.physical(t)
        axes = unit_coordinates(self.grouping.axes, self.grouping.axis_values(X))
        learnt, variance = self.reduced_.mean_variance(axes, weights)
        mean = self._scales.untransform(learnt, X)
        return mean, variance if weights is None else variance * self._scales.sizes(X, mean) ** 2

    @override
    def slopes(self, t: Array) -> Array:
        X = self.physical(t)
        mean = self.mean_std(X, False)[0]
        along = self._chained(
            X, self.reduced_.physical_slopes(self.grouping.axis_values(X), self.reduced_.slopes), mean
        )
        added = self._scales.added_slopes(X) * self._scales.sizes(X, mean)
        return np.asarray((along.sum(axis=1) + self._scales.steepness(X) * mean + added) / self.unit_slopes(X))

    def slope_stds(self, t: Array) -> Array:
        """Return calibrated deviations of the derivatives, (d, p, B), with independent errors of axes and scale."""
        X = self.physical(t)
        mean, std = self.mean_std(X, True)
        stds = self.reduced_.physical_slopes(self.grouping.axis_values(X), self.reduced_.slope_stds)
        return self._together(X, stds * self._guarded(X), mean, std)

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        X = self.physical(t)

        def stds(axes: Array) -> Array:
            return np.sqrt(np.maximum(self.reduced_.slope_variances(axes, weights), 0))

        slopes = self.reduced_.physical_slopes(self.grouping.axis_values(X), stds)
        mean, variance = self.mean_variance(t, weights)
        return self._together(X, slopes, mean, np.sqrt(variance)) ** 2

    def _together(self, X: Array, slopes: Array, mean: Array, std: Array) -> Array:
        squares = (self._chained(X, slopes, mean) ** 2).sum(axis=1) + (self._scales.steepness(X) * std) ** 2
        return np.asarray(np.sqrt(squares) / self.unit_slopes(X))

    def _chained(self, X: Array, slopes: Array, mean: Array) -> Array:
        """Return derivatives of outputs by the inputs through every axis: (axes, p, n) -> (d, axes, p, n)."""
        chain = self.grouping.jacobian(X).transpose(1, 0, 2)[:, :, None]
        return np.asarray(chain * slopes * self._scales.sizes(X, mean))
