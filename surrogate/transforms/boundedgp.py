"""Outputs with bounds: their logarithm or logit is learnt, so that means and intervals stay within."""

from collections.abc import Mapping, Sequence
from copy import copy
from typing import ClassVar, Self

import numpy as np
import xarray as xr
from scipy.special import expit
from typing_extensions import override

from approximation.arrays import Array
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.transforms.transformed import Transformed

#: Lower and upper bound; an infinite one is none.
Bounds = tuple[float, float]


class BoundedGP(Transformed):
    """A Gaussian process of outputs between bounds, by a process that knows none.

    It learns log(y - low), -log(high - y), or the logit of an output between two bounds. Means are medians of what
    is so distributed, intervals and quantiles those of the process taken back, so that none goes beyond a bound.

    Parameters
    ----------
    free : GaussianProcess
        The process, not fitted.
    bounds : mapping of str to (float, float)
        Lower and upper bound of outputs; infinite, or an output that is not named: none.

    Attributes
    ----------
    free_ : GaussianProcess
        The process, fitted to logarithms and logits; `calibrate` calibrates it.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from surrogate import BoundedGP, GridGP, Input
    >>> x = Input("x", -1, 1)
    >>> grid = xr.Dataset(coords={"x": x.levels(6)})
    >>> model = BoundedGP(GridGP(inputs=[x]), {"share": (0, 1)}).fit(grid.assign(share=1 / (1 + np.exp(-9 * grid.x))))
    >>> round(float(model.predict({"x": 0.9}).share), 4), bool(model.interval({"x": 0.9}, 0.999).share_upper < 1)
    (0.9997, True)
    """

    engine: ClassVar[str] = "bounded"
    MEMBERS = CALIBRATED = ("free",)
    free_: GaussianProcess

    def __init__(self, free: GaussianProcess | None, bounds: Mapping[str, Bounds]) -> None:
        for name, (low, high) in bounds.items():
            if not low < high:
                raise ValueError(f"bounds of {name!r}: {low:g} must be less than {high:g}")
        self.free, self.bounds = free, {name: (float(low), float(high)) for name, (low, high) in bounds.items()}

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a data set that the process takes; ValueError as it, for a bound of no output, and a value beyond."""
        if self.free is None:
            raise ValueError("a model from a file is not fitted again")
        for name in self.bounds:
            if name not in X:
                raise ValueError(f"bounds of {name!r}, which is not in the data set")
        self.free_ = self.free.fit(self._linked(X))
        self.cases_ = self.free_.cases_
        self._lay_out()
        return self

    def _lay_out(self) -> None:
        free = self.free_
        for name in self.bounds:
            if name not in free.outputs_:
                raise ValueError(f"bounds of {name!r}, which is no output")
        self.inputs_, self.outputs_, self.attrs_ = free.inputs_, free.outputs_, free.attrs_
        self.calibration_ = free.calibration_

    def calibrate(self, dataset: xr.Dataset) -> Self:
        """Calibrate the process on held-out cases, on the scale on which it learns."""
        self.cases(dataset)
        self.free_.calibrate(self._linked(dataset))
        self._lay_out()
        return self

    def _linked(self, X: xr.Dataset) -> xr.Dataset:
        """The data set with what is learnt in place of outputs with bounds."""
        learnt = {name: X[name].copy(data=linked(name, X[name].values, *ends)) for name, ends in self.bounds.items()}
        return X.assign(learnt)

    def _bounds(self) -> tuple[Array, Array]:
        ends = np.array([self.bounds.get(name, (-np.inf, np.inf)) for name in self.outputs_]).reshape(-1, 2)
        return ends[:, 0], ends[:, 1]

    def _outputs(self, learnt: Array) -> Array:
        """Outputs of what is learnt, (p, ...) each."""
        out = learnt.copy()
        for k, (low, high) in enumerate(zip(*self._bounds(), strict=True)):
            if np.isfinite(low) and np.isfinite(high):
                out[k] = low + (high - low) * expit(learnt[k])
            elif np.isfinite(low):
                out[k] = low + np.exp(learnt[k])
            elif np.isfinite(high):
                out[k] = high - np.exp(-learnt[k])
        return out

    def _steepness(self, mean: Array) -> Array:
        """Derivatives of outputs by what is learnt at outputs (p, ...)."""
        out = np.ones_like(mean)
        for k, (low, high) in enumerate(zip(*self._bounds(), strict=True)):
            if np.isfinite(low) and np.isfinite(high):
                out[k] = (mean[k] - low) * (high - mean[k]) / (high - low)
            elif np.isfinite(low) or np.isfinite(high):
                out[k] = mean[k] - low if np.isfinite(low) else high - mean[k]
        return out

    @override
    def reached(self, mean: Array, std: Array, distance: Array) -> Array:
        steep = self._steepness(mean)
        changing = steep > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            learnt = np.stack([_link(y, low, high) for y, low, high in zip(mean, *self._bounds(), strict=True)])
            ends = self._outputs(learnt + distance * np.where(changing, std / steep, 0.0))
        return np.asarray(np.where(changing, ends, mean))

    # -- answers -------------------------------------------------------------------------------------------------------
    @override
    def calibrated_at(self, X: Array) -> Array:
        return self.free_.calibrated_at(X)

    @override
    def mean_std(self, X: Array, with_std: bool) -> tuple[Array, Array | None]:
        """Return medians and deviations to first order: (p, B) each."""
        learnt, std = self.free_.mean_std(X, with_std)
        mean = self._outputs(learnt)
        return mean, None if std is None else std * self._steepness(mean)

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        """Return medians and, with weights, raw variances to first order: (p, B) each."""
        learnt, variance = self.free_.mean_variance(t, weights)
        mean = self._outputs(learnt)
        return mean, None if variance is None else variance * self._steepness(mean) ** 2

    @override
    def slopes(self, t: Array) -> Array:
        return self.free_.slopes(t) * self._sizes(t)

    @override
    def slope_stds(self, t: Array) -> Array:
        return self.free_.slope_stds(t) * self._sizes(t)

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        return self.free_.slope_variances(t, weights) * self._sizes(t) ** 2

    def _sizes(self, t: Array) -> Array:
        return self._steepness(self._outputs(self.free_.mean_variance(t, None)[0]))

    def _narrowed(self, outputs: Sequence[str]) -> Self:
        part = copy(self)
        part.bounds = {name: ends for name, ends in self.bounds.items() if name in outputs}
        return part

    def _behind(self, outputs: Sequence[str]) -> Mapping[str, Sequence[str]]:
        return {"free": outputs}

    def _unchanged(self) -> set[str]:
        return set(self.outputs_) - set(self.bounds)

    def state(self) -> xr.Dataset:
        """Return the bounds; the process stands beside them, as `free`."""
        ends = np.stack(self._bounds(), axis=1)
        bounded = np.isfinite(ends)
        return xr.Dataset(
            {
                "bounded": (("output", "end"), bounded.astype(np.int8)),
                "bound": (("output", "end"), np.where(bounded, ends, 0.0)),
            }
        )

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        bounded, ends = (stored[name].transpose("output", "end").values for name in ("bounded", "bound"))
        if bounded.shape != (len(outputs), 2) or ends.shape != bounded.shape:
            raise ValueError("the bounds do not fit the outputs")
        low, high = np.where(bounded > 0, ends, [-np.inf, np.inf]).T.tolist()
        known = {name: (a, b) for name, a, b in zip(outputs, low, high, strict=True) if np.isfinite([a, b]).any()}
        return cls(None, known)


def linked(name: str, y: Array, low: float, high: float) -> Array:
    """Return what is learnt of an output."""
    bad = ~((low < y) & (y < high))
    if bad.any():
        raise ValueError(f"output {name!r} is {y[bad].flat[0]:g}, which is not between {low:g} and {high:g}")
    return _link(y, low, high)


def _link(y: Array, low: float, high: float) -> Array:
    """Return the unbounded values that the process learns for an output between bounds."""
    above = np.log(y - low) if np.isfinite(low) else 0.0
    below = np.log(high - y) if np.isfinite(high) else 0.0
    return np.asarray(above - below if np.isfinite([low, high]).any() else y + 0.0)
