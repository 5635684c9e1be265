"""Inversion of measured outputs: the posterior of a few inputs by adaptive quadrature.

Errors of measurement are independent and Gaussian, the model's variance is added, and the prior is uniform in the
scaled inputs. Cells of the box with negligible posterior are dropped, others halved until the outputs change little
within a cell compared with their errors. The errors of a coarse cell include that change, so that no narrow peak is
missed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Array, Flags, Indices
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.intervals.distribution import NOMINAL

_FIRST = {1: 256, 2: 48, 3: 16}  # first cells along an input, by the number of inputs
_FINE = 0.12  # half of the outputs' largest change within a cell, in standard deviations
_NEGLIGIBLE = 14.0  # drop of the log-posterior below its largest value
_ROUNDS = 60
_MOST_CELLS = 400_000
_HOPELESS = 1e15  # misfit beyond which rounding makes all cells equal

#: Errors of measurement, in any unit, whose squares neither overflow nor vanish.
SMALLEST_ERROR, LARGEST_ERROR = 1e-150, 1e150


@dataclass(frozen=True)
class Estimate:
    """Posterior of k inferred inputs, in their units; NaN where a misfit beyond 1e15 says that nothing fits."""

    mean: Array  # shape (k,)
    low: Array  # shape (k,); ends of the central interval
    high: Array
    misfit: float  # least sum of squared deviations over variances: about 10 for two measurements means disagreement


class Inversion:
    """Infers one to three inputs of a model from measured outputs; `known` holds the values of all other inputs."""

    def __init__(
        self, model: GaussianProcess, infer: Sequence[str], measured: Sequence[str], known: Mapping[str, float]
    ) -> None:
        for name in [*infer, *known]:
            if name not in model.box:
                raise ValueError(f"{name!r} is not an input of the model; it has {', '.join(model.box)}")
        for name in model.box:
            if (name in infer) + (name in known) != 1:
                raise ValueError(f"{name!r} must be either inferred or given")
        for name in measured:
            if name not in model.outputs_:
                raise ValueError(f"{name!r} is not an output of the model")
        if len(infer) not in _FIRST or not measured:
            raise ValueError(f"one to three inputs can be inferred, from one or more outputs, not {len(infer)}")
        self._model, self._at = model, dict(known)
        self._inputs: list[Input] = [model.box[name] for name in infer]
        self._columns = [list(model.outputs_).index(name) for name in measured]

    def estimate(self, values: Array, errors: Array, level: float = NOMINAL) -> Estimate:
        """Return the posterior of the inputs from measured values (m,) and standard deviations of their errors (m,)."""
        if np.ma.is_masked(values) or np.ma.is_masked(errors):
            raise ValueError("measured values and errors must not be masked; leave these outputs out")
        if not np.isfinite(values).all() or not ((errors >= SMALLEST_ERROR) & (errors <= LARGEST_ERROR)).all():
            raise ValueError(
                f"measured values must be finite, their errors within {SMALLEST_ERROR:g} to {LARGEST_ERROR:g}"
            )
        cells = self._first
        for _ in range(_ROUNDS):
            density, far = _log_density(cells, values, errors**2 + cells.std**2 + cells.change.sum(1) ** 2)
            if far > _HOPELESS:  # all cells would be halved without end
                unknown = np.full(len(self._inputs), np.nan)
                return Estimate(unknown, unknown, unknown, far)
            cells = cells.only(density >= density.max() - _NEGLIGIBLE)
            changes = (cells.change / np.hypot(errors, cells.std)[:, None]).max(-1)
            coarse = changes.sum(-1) > _FINE
            if not coarse.any() or len(cells.centre) > _MOST_CELLS:
                break
            halves = self._halved(cells.only(coarse), changes[coarse].argmax(-1))
            cells = cells.only(~coarse).joined(halves)
        density, misfit = _log_density(cells, values, errors**2 + cells.std**2)
        weights = np.exp(density - density.max()) * np.prod(cells.half, axis=-1)
        return self._summary(cells, weights / weights.sum(), misfit, level)

    @cached_property
    def _first(self) -> "_Cells":
        """A uniform grid of cells; neighbouring cells give the change of the outputs within a cell."""
        k, count = len(self._inputs), _FIRST[len(self._inputs)]
        axis = (np.arange(count) + 0.5) * 2 / count - 1
        centre = np.stack([grid.ravel() for grid in np.meshgrid(*[axis] * k, indexing="ij")], -1)
        mean, std = self._forward(centre)
        grid = mean.reshape(*[count] * k, -1)
        change = [np.abs(np.gradient(grid, axis=along)).reshape(mean.shape) / 2 for along in range(k)]
        return _Cells(centre, np.full(centre.shape, 1 / count), mean, std, np.stack(change, 1))

    def _halved(self, parents: "_Cells", along: Indices) -> "_Cells":
        """Return all cells halved along an input each, (n,); outputs change within a child as from the parent to it."""
        rows = np.arange(len(along))
        half = parents.half.copy()
        half[rows, along] /= 2
        centre = np.repeat(parents.centre, 2, axis=0)
        centre[2 * rows, along] -= half[rows, along]
        centre[2 * rows + 1, along] += half[rows, along]
        mean, std = self._forward(centre)
        change = parents.change.copy()
        change[rows, along] = np.abs(mean.reshape(len(along), 2, -1) - parents.mean[:, None]).max(1)
        return _Cells(centre, np.repeat(half, 2, axis=0), mean, std, np.repeat(change, 2, axis=0))

    def _forward(self, centre: Array) -> tuple[Array, Array]:
        """Return means and deviations of the measured outputs, (n, m), at scaled inferred inputs (n, k)."""
        places = {input_.name: input_.from_unit(centre[:, k]) for k, input_ in enumerate(self._inputs)}
        columns = [places.get(name, np.full(len(centre), self._at.get(name, np.nan))) for name in self._model.box]
        mean, std = self._model.predict_array(np.stack(columns, -1), return_std=True)
        return mean[:, self._columns], std[:, self._columns]

    def _summary(self, cells: "_Cells", weights: Array, misfit: float, level: float) -> Estimate:
        rows = []
        for k, input_ in enumerate(self._inputs):
            centre, half = cells.centre[:, k], cells.half[:, k]
            ends = [input_.from_unit(_quantile(centre, half, weights, p)) for p in ((1 - level) / 2, (1 + level) / 2)]
            rows.append([float(weights @ input_.from_unit(centre)), *map(float, ends)])
        mean, low, high = np.array(rows).T
        return Estimate(mean, low, high, misfit)


@dataclass(frozen=True)
class _Cells:
    """Boxes in the scaled inputs, and the outputs in them."""

    centre: Array  # shape (n, k)
    half: Array  # shape (n, k); half widths
    mean: Array  # shape (n, m); outputs at the centres
    std: Array  # shape (n, m)
    change: Array  # shape (n, k, m); half of the outputs' change along each input

    def only(self, chosen: Flags) -> "_Cells":
        """Return the chosen cells."""
        return _Cells(*(array[chosen] for array in vars(self).values()))

    def joined(self, other: "_Cells") -> "_Cells":
        """Return these and the other cells."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return _Cells(*(np.concatenate(pair) for pair in pairs))


def _log_density(cells: _Cells, values: Array, variance: Array) -> tuple[Array, float]:
    """Return the log-posterior density of every cell, (n,), up to a constant, and the least misfit."""
    with np.errstate(over="ignore"):  # an infinite misfit counts as hopeless
        square = (values - cells.mean) ** 2 / variance
    return -0.5 * (square + np.log(variance)).sum(-1), float(square.sum(-1).min())


def _quantile(centre: Array, half: Array, weights: Array, share: float) -> float:
    """Return the quantile of a mixture of uniform cells, by bisection."""
    low, high = float((centre - half).min()), float((centre + half).max())
    for _ in range(60):
        middle = (low + high) / 2
        below = float(weights @ np.clip((middle - centre + half) / (2 * half), 0, 1))
        low, high = (middle, high) if below < share else (low, middle)
    return (low + high) / 2
