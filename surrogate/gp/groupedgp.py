"""Surrogates over groups: fewer, better axes inside, the user's own inputs outside."""

from collections.abc import Mapping, Sequence
from copy import copy
from typing import ClassVar, Self

import numpy as np
import xarray as xr

from surrogate.data.arrays import Array
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.gp.gridgp import GridGP, Kernel
from surrogate.gp.grouping import Grouping, Scaling
from surrogate.gp.model import BLOCK, GaussianProcess


class GroupedGP(GaussianProcess):
    """A grid Gaussian process of scaled outputs over groups of inputs, asked by the inputs themselves.

    The process learns `Grouping.learnt` over the groups' axes; means, standard deviations, intervals, gradients and the
    box are those of the outputs by the inputs. Any set of outputs will do, as many as a curve has points: one data set
    over the axes serves all, and a `Scaling` each says by what product of powers it is multiplied.

    Parameters
    ----------
    grouping : Grouping
        Inputs, axes and scales; its `scalings` name the outputs.
    kernel, hyperparameters, compression
        As for `GridGP`, of the process over the axes.

    Attributes
    ----------
    core_ : GridGP
        The process over the axes; `calibrate` corrects and calibrates it, on cases in the user's box.

    Examples
    --------
    The period of a pendulum over its length and gravity, from three cases:

    >>> import numpy as np, xarray as xr
    >>> from surrogate import Group, GroupedGP, Grouping, Input, Scaling
    >>> length, gravity, swing = Input("length", 0.1, 2, "log"), Input("gravity", 1, 20, "log"), Input("swing", 0, 0.5)
    >>> grouping = Grouping(
    ...     (length, gravity, swing), (Group(Input("relative_length", 0.005, 2, "log"), {"length": 1, "gravity": -1}),
    ...     Group(swing, {"swing": 1})), {"period": Scaling({"length": 0.5, "gravity": -0.5})})
    >>> axes = xr.Dataset(coords={one.name: one.levels(n) for one, n in zip(grouping.axes, (2, 6))})
    >>> cases = axes.assign_coords(length=axes.relative_length * 9.81, gravity=9.81)  # any that have these values
    >>> period = 2 * np.pi * np.sqrt(cases.length / cases.gravity) * (1 + cases.swing**2 / 16)
    >>> model = GroupedGP(grouping).fit(cases.assign(period=period))
    >>> round(float(model.predict({"length": 1.0, "gravity": 1.62, "swing": 0.2}).period), 6)
    4.948878
    """

    engine: ClassVar[str] = "grouped"
    core_: GridGP

    grouping: Grouping

    def __init__(
        self,
        grouping: Grouping,
        kernel: Kernel = "chebyshev",
        hyperparameters: Mapping[str, float] | None = None,
        compression: float = 1e-12,
    ) -> None:
        self.grouping = grouping
        self.kernel = kernel
        self.hyperparameters = hyperparameters
        self.compression = compression

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a complete factorial over the axes.

        Parameters
        ----------
        X : Dataset
            Dimensions are the groups' axes with their levels as coordinates; variables are the outputs, and every input
            is a variable or coordinate over some of the dimensions: the cases that were solved, any with these values
            of the groups.

        Raises
        ------
        ValueError
            As `GridGP.fit`; a missing input or output; the logarithm of what changes sign; inputs that do not have the
            axes' values.
        """
        names = tuple(self.grouping.scalings)
        for name in (*names, *(one.name for one in self.grouping.inputs)):
            if name not in X.variables:
                raise ValueError(f"{name!r} is not in the data set; it has {', '.join(map(str, X.variables))}")
        self._check_axes(X)
        data = self.grouping.reduced(X, names).assign_coords({one.name: X[one.name] for one in self.grouping.axes})
        self.core_ = GridGP(
            self.kernel, self.grouping.axes, names, self.hyperparameters, compression=self.compression
        ).fit(data)
        self.inputs_, self.outputs_ = self.grouping.inputs, names
        self.attrs_, self.calibration_ = self.core_.attrs_, None
        return self

    def _check_axes(self, X: xr.Dataset) -> None:
        columns = xr.broadcast(*(X[one.name].reset_coords(drop=True) for one in self.grouping.inputs))
        points = np.stack([one.values.ravel() for one in columns], axis=1)
        found = self.grouping.coordinates(points)
        for one, column in zip(self.grouping.axes, found.T, strict=True):
            if one.name not in X.dims:
                raise ValueError(f"axis {one.name!r} is no dimension of the data set")
            said = X[one.name].broadcast_like(columns[0]).transpose(*columns[0].dims).values.ravel()
            if np.abs(one.to_unit(column) - one.to_unit(said)).max() > 1e-8:
                raise ValueError(f"the inputs of the data set do not have its values of the axis {one.name!r}")

    def calibrate(self, dataset: xr.Dataset) -> Self:
        """Make means and distributions right on held-out cases in the box, as `GridGP.calibrate`, over the axes."""
        points, truth = self.cases(dataset)
        cases = xr.Dataset({**{name: column.reset_coords(drop=True) for name, column in points.items()}, **truth})
        columns = xr.broadcast(*(cases[one.name] for one in self.inputs_))
        found = self.grouping.coordinates(np.stack([one.values.ravel() for one in columns], axis=1))
        axes = {
            one.name: (columns[0].dims, column.reshape(columns[0].shape))
            for one, column in zip(self.grouping.axes, found.T, strict=True)
        }
        reduced = self.grouping.reduced(cases, self.outputs_)
        self.core_.calibrate(reduced.assign(axes))
        self.calibration_ = self.core_.calibration_
        return self

    def uncalibrated(self) -> Self:
        """Return the model without what `calibrate` has learnt."""
        return self._over(self.core_.uncalibrated())

    def only(self, outputs: Sequence[str]) -> Self:
        """Return the model of some outputs; means agree within `compression`, and cost less to ask for."""
        part = self._over(self.core_.only(outputs))
        part.grouping = self.grouping.only(outputs)
        part.outputs_, part.attrs_ = part.core_.outputs_, part.core_.attrs_
        return part

    def thinned(self, errors: Mapping[str, float]) -> Self:
        """Return the model with root-mean-square errors of outputs that are learnt as they are; others keep theirs."""
        plain = {name for name, one in self.grouping.scalings.items() if one == Scaling()}
        return self._over(self.core_.thinned({name: error for name, error in errors.items() if name in plain}))

    def _over(self, core: GridGP) -> Self:
        part = copy(self)
        part.core_, part.calibration_ = core, core.calibration_
        return part

    def stored(self) -> xr.Dataset:
        """Return what a file must hold beside inputs, outputs and probes: the core's under `axis`, and the groups."""
        core = self.core_.stored().rename_dims(input="axis")
        return core.merge(self.grouping.state(self.outputs_))

    def state(self) -> xr.Dataset:
        """Return the same without the calibration."""
        return self.uncalibrated().stored()

    @classmethod
    def restored(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the calibrated model of a stored state; ValueError names what is inconsistent."""
        grouping = Grouping.restore(stored, inputs, tuple(outputs))
        plain = stored.drop_vars([name for name, one in stored.variables.items() if "input" in one.dims])
        core = GridGP.restored(plain.rename_dims(axis="input"), grouping.axes, outputs)
        model = cls(grouping, core.kernel, None, core.compression)
        model.inputs_, model.outputs_, model.attrs_ = inputs, tuple(outputs), outputs
        model.core_, model.calibration_ = core, core.calibration_
        return model

    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the model of a stored state without its calibration."""
        return cls.restored(stored, inputs, outputs).uncalibrated()

    @property
    def parts(self) -> int:
        """Number of parts of the variance: one an axis."""
        return self.core_.parts

    def _blocks(self, X: Array, return_std: bool) -> tuple[Array, Array | None]:
        mean = np.empty((len(self.outputs_), len(X)))
        std = np.empty_like(mean) if return_std else None
        for start in range(0, len(X), BLOCK):
            block = slice(start, start + BLOCK)
            learnt, spread = self.core_._blocks(self.grouping.coordinates(X[block]), return_std)
            mean[:, block] = self.grouping.told(learnt, X[block], self.outputs_)
            if std is not None and spread is not None:
                std[:, block] = spread * self._sizes(X[block], mean[:, block])
        return mean, std

    def _sizes(self, X: Array, mean: Array) -> Array:
        """What errors of the learnt outputs are multiplied by, (p, n): their scale, or the output of a logarithm."""
        signs = self.grouping.logarithms(self.outputs_)[:, None]
        return np.asarray(np.where(signs == 0, self.grouping.scales(X, self.outputs_), np.abs(mean)))

    def _physical(self, t: Array) -> Array:
        return np.stack([one.from_unit(row) for one, row in zip(self.inputs_, t, strict=True)], axis=1)

    def _core_coordinates(self, X: Array) -> Array:
        return unit_coordinates(self.grouping.axes, self.grouping.coordinates(X))

    def _mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        X = self._physical(t)
        learnt, variance = self.core_._mean_variance(self._core_coordinates(X), weights)
        mean = self.grouping.told(learnt, X, self.outputs_)
        return mean, None if variance is None else variance * self._sizes(X, mean) ** 2

    def _slopes(self, t: Array) -> Array:
        X = self._physical(t)
        mean = self._blocks(X, False)[0]
        along = self._chained(X, self.core_._physical_slopes(self.grouping.coordinates(X), self.core_._slopes), mean)
        steep = self.grouping.steepness(X, self.outputs_) * mean
        added = self.grouping.added_slopes(X, self.outputs_) * self._sizes(X, mean)
        return np.asarray((along.sum(axis=1) + steep + added) / self._unit_slopes(X))

    def _slope_stds(self, t: Array) -> Array:
        """Of the derivatives: those along the axes and of the scale, taken as independent."""
        X = self._physical(t)
        mean, std = self._blocks(X, True)
        own = self.core_._physical_slopes(self.grouping.coordinates(X), self.core_._slope_stds)
        return self._together(X, own, mean, np.zeros_like(mean) if std is None else std)

    def _slope_variances(self, t: Array, weights: Array) -> Array:
        X = self._physical(t)

        def stds(own: Array) -> Array:
            return np.sqrt(np.maximum(self.core_._slope_variances(own, weights), 0))

        own = self.core_._physical_slopes(self.grouping.coordinates(X), stds)
        mean, variance = self._mean_variance(t, weights)
        std = np.zeros_like(mean) if variance is None else np.sqrt(variance)
        return self._together(X, own, mean, std) ** 2

    def _together(self, X: Array, own: Array, mean: Array, std: Array) -> Array:
        squares = (self._chained(X, own, mean) ** 2).sum(axis=1)
        squares += (self.grouping.steepness(X, self.outputs_) * std) ** 2
        return np.asarray(np.sqrt(squares) / self._unit_slopes(X))

    def _chained(self, X: Array, own: Array, mean: Array) -> Array:
        """Derivatives by the inputs of what depends on every axis: (axes, p, n) -> (d, axes, p, n)."""
        chain = self.grouping.jacobian(X).transpose(1, 0, 2)[:, :, None]
        return np.asarray(chain * own * self._sizes(X, mean))

    def _unit_slopes(self, X: Array) -> Array:
        return np.stack([one.unit_slope(X[:, k]) for k, one in enumerate(self.inputs_)])[:, None]
