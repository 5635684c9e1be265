"""One query alone on a Chebyshev grid: the same formulas as for blocks, laid out once, in few operations.

A block of queries spends its time in arithmetic; one query spends it in starting operations. Here the polynomials of
all factors stand in one vector, and every part of the answer is a gather from it and one product with a matrix.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import log

import numpy as np
from scipy.special import eval_chebyt

from approximation.arrays import Array
from surrogate.data.inputs import Input
from surrogate.gp.correction import Correction
from surrogate.gp.factors import Factor
from surrogate.gp.tensortrain import TensorTrain
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.guard import SLABS, Guard

# 0 in the lowest slab, 2 in the highest, 1 between: places in the guard of corners.
_EDGE = np.array([0, *[1] * (SLABS - 2), 2])


@dataclass(frozen=True)
class Process:
    """Parts of a Chebyshev grid process, compared by identity."""

    # One a factor
    inputs: tuple[Input, ...]
    factors: tuple[Factor, ...]
    order: tuple[int, ...]  # Factors in the order of the train
    train: TensorTrain  # Coefficients of the standardised means
    # shape (p,); What takes them to the outputs
    offset: Array
    scale: Array
    amplitude: Array  # shape (d, p); Of every factor's kernel
    size: Array  # shape (p,); Variance of the process in units of the outputs
    # What held-out cases say; None where there were none
    correction: Correction | None
    calibration: Calibration | None


class SinglePoint:
    """Means and standard deviations of all outputs at one point."""

    def __init__(self, process: Process) -> None:
        self._inputs = [mapping(input_) for input_ in process.inputs]
        self._offset, self._scale = process.offset, process.scale
        self._rows = _Rows(process)
        self._lay_out_mean(process)
        self._lay_out_variance(process)
        self._correction = None if process.correction is None else _SingleCorrection(process.correction, self._rows)
        self._stretch = None if process.calibration is None else _SingleStretch(process.calibration, self._rows)

    def __call__(self, point: Sequence[float], with_std: bool) -> tuple[Array, Array | None] | None:
        """Return means and, where wanted, standard deviations, (p,) each; None for a point outside of the box."""
        t = []
        for x, (low, high, way, width) in zip(point, self._inputs, strict=True):
            if not low <= x <= high:
                return None
            unit = 2 * way(x) / width - 1
            t.append(min(max(unit, -1.0), 1.0))
        scaled = np.array(t)
        T = self._rows.polynomials(scaled)
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
        return mean, self._stretch(variance, scaled, T)

    def _lay_out_mean(self, process: Process) -> None:
        self._cores, self._slices, start = [], [], 0
        mean, mirror, nodal, damping = [], [], [], []
        for factor, core in zip(process.order, process.train.cores, strict=True):
            factor_kernel, first = process.factors[factor], self._rows.first[factor]
            m = np.arange(core.shape[1])
            mean.append(first + m)
            mirror.append(first + np.maximum(factor_kernel.levels - m, 0))
            nodal.append(np.full(len(m), first + factor_kernel.levels))
            damping.append(2 * factor_kernel.damping[: len(m)])
            self._slices.append(slice(start, start := start + len(m)))
            self._cores.append(np.ascontiguousarray(core.reshape(-1, core.shape[2])))
        self._mean_rows, self._mirror_rows = np.concatenate(mean), np.concatenate(mirror)
        self._nodal_rows, self._damping = np.concatenate(nodal), np.concatenate(damping)

    def _lay_out_variance(self, process: Process) -> None:
        d = len(process.factors)
        shares = np.zeros((2 * d, self._rows.count))
        for k, (factor, first) in enumerate(zip(process.factors, self._rows.first, strict=True)):
            shares[k, first : first + len(factor.decay)] = factor.decay
            shares[d + k, first : first + len(factor.unknown)] = factor.unknown
        self._shares, self._amplitude, self._size = shares, process.amplitude, process.size
        weights = np.ones_like(self._amplitude) if process.calibration is None else process.calibration.weights
        self._weights = weights * process.size

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

    def __init__(self, process: Process) -> None:
        products = [] if process.correction is None else [process.correction.indices]
        products += [] if process.calibration is None else [process.calibration.trend_degree]
        sizes = [
            1 + max([2 * factor.levels - 1, *(int(degrees[:, k].max()) for degrees in products)])
            for k, factor in enumerate(process.factors)
        ]
        self.first = np.cumsum([0, *sizes[:-1]])
        self.nodal = self.first + [factor.levels for factor in process.factors]
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
        d = len(rows.first)
        self._floor, self._trend, self._range = calibration.floor, calibration.trend, calibration.trend_range
        self._terms = np.ascontiguousarray((rows.first + calibration.trend_degree).T)
        self._i, self._j = np.array(list(combinations(range(d), 2)), dtype=np.intp).reshape(-1, 2).T
        guard = calibration.guard
        self._cells = np.concatenate([part.reshape(-1, part.shape[-1]) for part in (guard.slabs, guard.corners)])
        self._slabs = SLABS * np.arange(d)
        self._corners = SLABS * d + 9 * np.arange(len(self._i))

    def __call__(self, variance: Array, t: Array, T: Array) -> Array:
        slab = np.minimum(((t + 1) / 2 * SLABS).astype(np.intp), SLABS - 1)
        edge = _EDGE[slab]
        cells = np.concatenate((self._slabs + slab, self._corners + 3 * edge[self._i] + edge[self._j]))
        scale = np.multiply.reduce(T[self._terms]) @ self._trend
        np.maximum(scale, self._range[0], out=scale)
        np.minimum(scale, self._range[1], out=scale)
        scale += np.maximum.reduce(self._cells[cells])
        return np.asarray(np.sqrt(variance + self._floor) * np.exp(scale))


class SingleGuard:
    """Return `Guard.at` at one point."""

    def __init__(self, guard: Guard, inputs: Sequence[Input]) -> None:
        d, outputs = len(inputs), guard.slabs.shape[-1]
        pooled = np.zeros(outputs) if guard.pooled is None else guard.pooled
        parts = (guard.slabs.reshape(-1, outputs), guard.corners.reshape(-1, outputs), pooled[None])
        self._cells = np.concatenate(parts)
        self._inputs = [mapping(input_) for input_ in inputs]
        self._pairs = {pair: SLABS * d + 9 * k for k, pair in enumerate(combinations(range(d), 2))}

    def __call__(self, point: Sequence[float]) -> Array:
        """Return the guard at a point of the box, (p,)."""
        slab = []
        for x, (_, _, way, width) in zip(point, self._inputs, strict=True):
            slab.append(min(max(int(way(x) / width * SLABS), 0), SLABS - 1))
        cells = [SLABS * k + number for k, number in enumerate(slab)]
        outer = [k for k, number in enumerate(slab) if number in (0, SLABS - 1)]
        if len(outer) > 1:
            edge = [2 if number else 0 for number in slab]
            cells += [self._pairs[i, j] + 3 * edge[i] + edge[j] for i, j in combinations(outer, 2)]
            cells.append(-1)
        return np.asarray(np.maximum.reduce(self._cells[cells]))


def mapping(input_: Input) -> tuple[float, float, Callable[[float], float], float]:
    """The ends of an input; on its scale, the distance of a value from the lower end, and that of the upper end."""
    low, high = input_.low, input_.high
    if input_.scale == "log":
        return low, high, lambda x: log(x / low), log(high / low)
    if input_.scale == "logit":
        start = log(low / (1 - low))
        return low, high, lambda x: log(x / (1 - x)) - start, log(high / (1 - high)) - start
    return low, high, lambda x: x - low, high - low
