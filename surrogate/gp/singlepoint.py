"""One query alone on a Chebyshev grid: the same formulas as for blocks, laid out once, in few operations.

A block of queries spends its time in arithmetic; one query spends it in starting operations. Here the polynomials of
all factors stand in one vector, and every part of the answer is a gather from it and one product with a matrix.
"""

from collections.abc import Callable, Sequence
from itertools import combinations
from math import log
from typing import Protocol

import numpy as np
from scipy.special import eval_chebyt

from approximation.arrays import Array
from surrogate.data.inputs import Input
from surrogate.gp.correction import Correction
from surrogate.gp.factors import Factor
from surrogate.gp.tensortrain import TensorTrain
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.guard import SLABS, Guard


class Process(Protocol):
    """Attributes of `GridGP` from which one query alone is laid out."""

    inputs_: tuple[Input, ...]
    factors_: tuple[Factor, ...]
    order_: tuple[int, ...]
    train_: TensorTrain
    offset_: Array
    scale_: Array
    amplitude_: Array
    variance_: Array
    correction_: Correction | None
    calibration_: Calibration | None


class SinglePoint:
    """Means and standard deviations of all outputs at one point."""

    def __init__(self, model: Process) -> None:
        self._scaled = Scaled(model.inputs_)
        self._offset, self._scale = model.offset_, model.scale_
        self._rows = _Rows(model)
        self._lay_out_mean(model)
        self._lay_out_variance(model)
        self._correction = None if model.correction_ is None else _SingleCorrection(model.correction_, self._rows)
        self._stretch = None if model.calibration_ is None else _SingleStretch(model.calibration_, self._rows)

    def __call__(self, point: Sequence[float], with_std: bool) -> tuple[Array, Array | None] | None:
        """Return means and, where wanted, standard deviations, (p,) each; None for a point outside of the box."""
        t = self._scaled(point)
        if t is None:
            return None
        T = self._rows.polynomials(np.array(t))
        features = T[self._mean_rows]
        features -= self._damping * T[self._nodal_rows] * T[self._mirror_rows]
        state = features[self._slices[0]] @ self._cores[0]
        for core, place in zip(self._cores[1:], self._slices[1:], strict=True):
            state = (state[:, None] * features[place]).ravel() @ core
        mean = state * self._scale
        mean += self._offset
        if self._correction is not None:
            mean += self._correction(T)
        if not with_std:
            return mean, None
        variance = self._variance(T)
        if self._stretch is None:
            return mean, np.sqrt(variance)
        return mean, self._stretch(variance, t, T)

    def _lay_out_mean(self, model: Process) -> None:
        self._cores, self._slices, start = [], [], 0
        mean, mirror, nodal, damping = [], [], [], []
        for factor, core in zip(model.order_, model.train_.cores, strict=True):
            factor_kernel, first = model.factors_[factor], self._rows.first[factor]
            m = np.arange(core.shape[1])
            mean.append(first + m)
            mirror.append(first + np.maximum(factor_kernel.levels - m, 0))
            nodal.append(np.full(len(m), first + factor_kernel.levels))
            damping.append(2 * factor_kernel.damping[: len(m)])
            self._slices.append(slice(start, start := start + len(m)))
            self._cores.append(np.ascontiguousarray(core.reshape(-1, core.shape[2])))
        self._mean_rows, self._mirror_rows = np.concatenate(mean), np.concatenate(mirror)
        self._nodal_rows, self._damping = np.concatenate(nodal), np.concatenate(damping)

    def _lay_out_variance(self, model: Process) -> None:
        d = len(model.factors_)
        shares = np.zeros((2 * d, self._rows.count))
        for k, (factor, first) in enumerate(zip(model.factors_, self._rows.first, strict=True)):
            shares[k, first : first + len(factor.decay)] = factor.decay
            shares[d + k, first : first + len(factor.unknown)] = factor.unknown
        self._shares, self._amplitude = shares, model.amplitude_
        weights = np.ones_like(self._amplitude) if model.calibration_ is None else model.calibration_.weights
        self._weights = weights * (model.variance_ * model.scale_**2)

    def _variance(self, T: Array) -> Array:
        """Return `gridgp.unit_variance` at one point, with running products in place of the loop."""
        squares = T * T
        contributions = self._shares @ squares
        d = len(contributions) // 2
        contributions[d:] *= squares[self._rows.nodal]
        known = self._amplitude * contributions[:d, None]
        known += 1.0
        unknown = self._amplitude * contributions[d:, None]
        after = np.multiply.accumulate(known[:0:-1])[::-1]
        known -= unknown
        before = np.multiply.accumulate(known[:-1])
        unknown *= self._weights
        unknown[:-1] *= after
        unknown[1:] *= before
        return np.asarray(np.add.reduce(unknown))


class _Rows:
    """The polynomials of all factors in one vector, each factor's from T_0 on."""

    def __init__(self, model: Process) -> None:
        products = [] if model.correction_ is None else [model.correction_.indices]
        products += [] if model.calibration_ is None else [model.calibration_.trend_degree]
        sizes = [
            1 + max([2 * factor.levels - 1, *(int(degrees[:, k].max()) for degrees in products)])
            for k, factor in enumerate(model.factors_)
        ]
        self.first = np.cumsum([0, *sizes[:-1]])
        self.nodal = self.first + [factor.levels for factor in model.factors_]
        self.count = sum(sizes)
        self._degree = np.concatenate([np.arange(size) for size in sizes])
        self._factor = np.repeat(np.arange(len(sizes)), sizes)

    def polynomials(self, t: Array) -> Array:
        return np.asarray(eval_chebyt(self._degree, t[self._factor]))


class _SingleCorrection:
    """Return `Correction.values` at one point."""

    def __init__(self, correction: Correction, rows: _Rows) -> None:
        self._terms = np.ascontiguousarray((rows.first + correction.indices).T)
        self._nodal = rows.nodal
        d, m, p = correction.coefficients.shape
        self._matrix = np.ascontiguousarray(correction.coefficients.transpose(1, 0, 2).reshape(m, -1))
        self._shape = d, p

    def __call__(self, T: Array) -> Array:
        amplitudes = (np.multiply.reduce(T[self._terms]) @ self._matrix).reshape(self._shape)
        return np.asarray(T[self._nodal] @ amplitudes)


class _SingleStretch:
    """Return `Calibration.std` at one point: floor, local scale, guard of slabs and corners."""

    def __init__(self, calibration: Calibration, rows: _Rows) -> None:
        self._floor, self._trend, self._range = calibration.floor, calibration.trend, calibration.trend_range
        self._terms = np.ascontiguousarray((rows.first + calibration.trend_degree).T)
        self._guard = SingleGuard(calibration.guard)

    def __call__(self, variance: Array, t: Sequence[float], T: Array) -> Array:
        scale = np.multiply.reduce(T[self._terms]) @ self._trend
        np.maximum(scale, self._range[0], out=scale)
        np.minimum(scale, self._range[1], out=scale)
        scale += self._guard(t)
        return np.asarray(np.sqrt(variance + self._floor) * np.exp(scale))


class SingleGuard:
    """Return `Guard.at` at one point."""

    def __init__(self, guard: Guard) -> None:
        d, _, outputs = guard.slabs.shape
        pooled = np.zeros(outputs) if guard.pooled is None else guard.pooled
        parts = (guard.slabs.reshape(-1, outputs), guard.corners.reshape(-1, outputs), pooled[None])
        self._cells = np.concatenate(parts)
        self._pairs = {pair: SLABS * d + 9 * k for k, pair in enumerate(combinations(range(d), 2))}

    def __call__(self, t: Sequence[float]) -> Array:
        """Return the guard at scaled coordinates within the box, (p,)."""
        slab = [min(int((unit + 1) / 2 * SLABS), SLABS - 1) for unit in t]
        cells = [SLABS * k + number for k, number in enumerate(slab)]
        outer = [k for k, number in enumerate(slab) if number in (0, SLABS - 1)]
        if len(outer) > 1:
            edge = [2 if number else 0 for number in slab]
            cells += [self._pairs[i, j] + 3 * edge[i] + edge[j] for i, j in combinations(outer, 2)]
            cells.append(-1)
        return np.asarray(np.maximum.reduce(self._cells[cells]))


class Scaled:
    """Scaled coordinates of one point."""

    def __init__(self, inputs: Sequence[Input]) -> None:
        self._inputs = [_mapping(input_) for input_ in inputs]

    def __call__(self, point: Sequence[float]) -> list[float] | None:
        """Return the coordinates, (d,), within -1 to 1; None for a point outside of the box."""
        t = []
        for x, (low, high, distance, width) in zip(point, self._inputs, strict=True):
            if not low <= x <= high:
                return None
            t.append(min(max(2 * distance(x) / width - 1, -1.0), 1.0))
        return t


def _mapping(input_: Input) -> tuple[float, float, Callable[[float], float], float]:
    """The ends of an input; on its scale, the distance of a value from the lower end, and that of the upper end."""
    low, high = input_.low, input_.high
    if input_.scale == "log":
        return low, high, lambda x: log(x / low), log(high / low)
    if input_.scale == "logit":
        start = log(low / (1 - low))
        return low, high, lambda x: log(x / (1 - x)) - start, log(high / (1 - high)) - start
    return low, high, lambda x: x - low, high - low
