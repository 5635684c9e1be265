"""From measured outputs back to inputs: the posterior of a few inputs, by quadrature that closes in on it.

With independent Gaussian errors of the measurements, the model's own variance added to theirs, and a prior that is
uniform in the scaled inputs (log-uniform on a log scale), the posterior is evaluated on a tensor grid. The grid closes
in on where the posterior is not negligible; while it is coarse, the errors are widened by what the outputs change
within a cell, so that no narrow peak is stepped over.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from surrogate.inputs import Input
from surrogate.model import GaussianProcess

Array = NDArray[np.float64]

_FIRST = {1: 513, 2: 129, 3: 41}  # nodes an input of the first grid, by the number of inputs
_NEXT = {1: 129, 2: 41, 3: 21}
_NEGLIGIBLE = 14.0  # drop of the log-posterior below its largest value
_SHARE = 0.6  # a grid that would keep this share of every range has closed in
_ROUNDS = 40


@dataclass(frozen=True)
class Estimate:
    """What measurements say about some inputs.

    Attributes
    ----------
    mean, low, high
        Posterior mean and ends of the central interval of every input, in its units; (k,).
    misfit
        Least sum of squared deviations over variances: beyond about 10 for two measurements, model and measurement do
        not agree anywhere in the box.
    """

    mean: Array
    low: Array
    high: Array
    misfit: float


class Inversion:
    """Infers inputs of a model from measured outputs.

    Parameters
    ----------
    model : GaussianProcess
        The forward model.
    infer : sequence of str
        One to three inputs to infer.
    measured : sequence of str
        Outputs that are measured.
    at : mapping
        Values of the other inputs.

    Raises
    ------
    ValueError
        An input or output that is unknown, missing or given twice.
    """

    def __init__(
        self, model: GaussianProcess, infer: Sequence[str], measured: Sequence[str], at: Mapping[str, float]
    ) -> None:
        for name in [*infer, *at]:
            if name not in model.box:
                raise ValueError(f"{name!r} is not an input of the model; it has {', '.join(model.box)}")
        for name in model.box:
            if (name in infer) + (name in at) != 1:
                raise ValueError(f"{name!r} must be either inferred or given")
        for name in measured:
            if name not in model.outputs_:
                raise ValueError(f"{name!r} is not an output of the model")
        if len(infer) not in _FIRST or not measured:
            raise ValueError(f"one to three inputs can be inferred, from one or more outputs, not {len(infer)}")
        self._model, self._at = model, dict(at)
        self._inputs: list[Input] = [model.box[name] for name in infer]
        self._columns = [list(model.outputs_).index(name) for name in measured]

    def estimate(self, values: Array, errors: Array, level: float = 0.95) -> Estimate:
        """Return the posterior of the inputs.

        Parameters
        ----------
        values, errors : ndarray, shape (m,)
            Measured values and standard deviations of their errors, in the outputs' units and order.
        level : float
            Probability of the central interval.
        """
        axes, forward = self._first
        for _ in range(_ROUNDS):
            log, misfit = _posterior(forward, values, errors)
            kept = [_support(log, k) for k in range(len(axes))]
            widths = [
                (axis[high] - axis[low]) / (axis[-1] - axis[0]) for axis, (low, high) in zip(axes, kept, strict=True)
            ]
            settled = not forward.coarse(errors) and all(width > _SHARE for width in widths)
            if settled:
                break
            ends = [(axis[low], axis[high]) for axis, (low, high) in zip(axes, kept, strict=True)]
            axes = [np.linspace(low, high, _NEXT[len(axes)]) for low, high in ends]
            forward = self._forward(axes)
        return self._summary(axes, log, misfit, level)

    @cached_property
    def _first(self) -> "tuple[list[Array], _Forward]":
        axes = [np.linspace(-1.0, 1.0, _FIRST[len(self._inputs)]) for _ in self._inputs]
        return axes, self._forward(axes)

    def _forward(self, axes: Sequence[Array]) -> "_Forward":
        grids = np.meshgrid(*axes, indexing="ij")
        places = {one.name: one.from_unit(t.ravel()) for one, t in zip(self._inputs, grids, strict=True)}
        columns = [
            places[name] if name in places else np.full(grids[0].size, self._at[name]) for name in self._model.box
        ]
        mean, std = self._model.predict_array(np.stack(columns, -1), return_std=True)
        shape = (*grids[0].shape, len(self._columns))
        return _Forward(mean[:, self._columns].reshape(shape), std[:, self._columns].reshape(shape))

    def _summary(self, axes: Sequence[Array], log: Array, misfit: float, level: float) -> Estimate:
        density = np.exp(log - log.max())
        rows = []
        for k, (axis, one) in enumerate(zip(axes, self._inputs, strict=True)):
            marginal = density
            for other in reversed([j for j in range(len(axes)) if j != k]):
                marginal = np.trapezoid(marginal, axes[other], axis=other)
            steps = np.array([(a + b) / 2 for a, b in pairwise(marginal)]) * np.diff(axis)
            cumulative = np.concatenate([[0.0], np.cumsum(steps)])
            cumulative /= cumulative[-1]
            low, high = (_quantile(axis, marginal, cumulative, p) for p in ((1 - level) / 2, (1 + level) / 2))
            mean = np.trapezoid(marginal * one.from_unit(axis), axis) / np.trapezoid(marginal, axis)
            rows.append((float(mean), float(one.from_unit(low)), float(one.from_unit(high))))
        mean_, low_, high_ = np.array(rows).T
        return Estimate(mean_, low_, high_, misfit)


@dataclass(frozen=True)
class _Forward:
    """Outputs on a grid, (..., m) each: mean, standard deviation."""

    mean: Array
    std: Array

    @cached_property
    def change(self) -> Array:
        """Largest half change of an output to a neighbouring node, along any input."""
        parts = []
        for axis in range(self.mean.ndim - 1):
            steps = np.abs(np.diff(self.mean, axis=axis)) / 2
            edge = np.zeros_like(np.take(steps, [0], axis))
            parts.append(np.maximum(np.concatenate([steps, edge], axis), np.concatenate([edge, steps], axis)))
        return np.asarray(sum(parts))

    def coarse(self, errors: Array) -> bool:
        """Whether errors are small beside what the outputs change within a cell."""
        widened = np.median(self.change, axis=tuple(range(self.change.ndim - 1)))
        return bool(np.any(widened > errors))


def _posterior(forward: _Forward, values: Array, errors: Array) -> tuple[Array, float]:
    """Log-posterior on the grid up to a constant, and the least misfit; on a coarse grid with widened errors."""
    variance = errors**2 + forward.std**2
    if forward.coarse(errors):
        variance = variance + forward.change**2
    square = (values - forward.mean) ** 2 / variance
    return -0.5 * (square + np.log(variance)).sum(-1), float(square.sum(-1).min())


def _support(log: Array, axis: int) -> tuple[int, int]:
    """First and last node of an axis where the posterior is not negligible, with one more on either side."""
    others = tuple(k for k in range(log.ndim) if k != axis)
    inside = np.flatnonzero(log.max(others) > log.max() - _NEGLIGIBLE)
    return max(int(inside[0]) - 1, 0), min(int(inside[-1]) + 1, log.shape[axis] - 1)


def _quantile(axis: Array, density: Array, cumulative: Array, share: float) -> float:
    """Where the cumulative of a piecewise linear density reaches a share."""
    k = min(int(np.searchsorted(cumulative, share, "right")) - 1, len(axis) - 2)
    total = np.trapezoid(density, axis)
    a, b, h = density[k] / total, density[k + 1] / total, axis[k + 1] - axis[k]
    rest, slope = share - cumulative[k], (b - a) / h
    root = np.sqrt(max(a * a + 2 * slope * rest, 0.0))
    return float(axis[k] + (2 * rest / (a + root) if a + root > 0 else 0.0))
