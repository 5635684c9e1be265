"""Error of interpolation on Chebyshev-Gauss levels, learnt from held-out cases.

On the n zeros of T_n every aliased term is T_{n+k} + T_{n-k} = 2 T_n T_k (L. N. Trefethen, Approximation Theory and
Approximation Practice (2013), chapter 4). To leading order the error is sum_f T_{n_f}(t_f) g_f(t) with smooth
amplitudes g_f, which one linear regression finds.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from heapq import heappop, heappush
from typing import Self

import numpy as np
import scipy  # scipy.linalg, slow to import, when something is fitted
import xarray as xr
from numpy.typing import NDArray

from approximation import products
from approximation.arrays import Array, Indices
from approximation.products import additive, product
from surrogate.face.model import in_blocks
from surrogate.gp.factors import Features
from surrogate.intervals.guard import places

DEAREST = 1.5  # a degree of g_f costs half of the decay of the factor's kernel, and at most this
COST, LEAST_COST = 4.6, 1.5  # highest cost of a term's degrees; if the cases allow less than the second, no correction
CASES_A_TERM = 7  # held-out cases that a term needs
MOST_TERMS, MOST_CASES = 600, 20_000  # of a regression, which bound its memory and time
TOLERANCE = 1e-9  # relative size of the directions that the regression drops
UNKNOWN = 1e-3  # least share of a direction's information that must remain without a group of cases
# Where ordinary least squares leave more than this share of the median error, they spread the errors of a small part
# of the box over all of it. There a case weighs as a power of its scale: 1 would raise the largest errors by 40 %.
LEAST_GAIN = 0.5
WEIGHT_POWER = 0.25
SCALE_DEGREE = 6
SMALLEST_SCALE, SMALLEST = 1e-3, 1e-9  # lower bounds of scales over their median and of errors over the largest


@dataclass(frozen=True)
class Correction:
    """Correction of the mean: sum_f T_{n_f}(t_f) sum_a coefficients[f, a] prod_j T_{indices[a, j]}(t_j)."""

    levels: tuple[int, ...]  # number of levels n_f of every factor
    indices: Indices  # shape (m, d); degrees of the amplitudes' terms
    coefficients: Array  # shape (d, m, p); in units of the outputs

    def values(self, t: Array) -> Array:
        """Return the correction at scaled coordinates t, (d, B): (p, B)."""
        T = self._polynomials(t)
        amplitudes = (self._matrix @ product(self.indices, T)).reshape(len(t), -1, t.shape[1])
        return np.asarray(np.einsum("fpb,fb->pb", amplitudes, self._nodal(T)))

    def slopes(self, t: Array) -> Array:
        """Return the derivatives of `values` with respect to the scaled coordinates, (d, p, B)."""
        T = self._polynomials(t)
        S = products.derivatives(t, T)
        nodal, steep = self._nodal(T), self._nodal(S)
        amplitudes = (self._matrix @ product(self.indices, T)).reshape(len(t), -1, t.shape[1])
        slopes = amplitudes * steep[:, None]
        for k, slope in enumerate(slopes):
            derived = (self._matrix @ product(self.indices, T, S, k)).reshape(amplitudes.shape)
            slope += np.einsum("fpb,fb->pb", derived, nodal)
        return np.asarray(slopes)

    def steepened(self, factor: int, slope: Features) -> Features:
        """Return a factor's features of derivatives, with the variances of the error that the correction leaves."""
        # Low degrees are corrected: along the factor the error's own terms begin at T_n T_{a+1}, those of other factors
        # at T_{a+1}, with the correction's highest degree a. A polynomial's slope grows with its degree.
        n, above = self.levels[factor], 1 + int(self.indices[:, factor].max())
        return replace(slope, prior=slope.prior * above**2, residual=slope.residual * ((n + above) / n) ** 2)

    def only(self, columns: Sequence[int]) -> Self:
        """Return the correction of the outputs `columns`."""
        return replace(self, coefficients=self.coefficients[..., list(columns)])

    def state(self) -> dict[str, tuple[tuple[str, ...], NDArray[np.generic]]]:
        """Return the arrays with their dimensions, for a file."""
        return {
            "correction_degree": (("correction_term", "input"), self.indices),
            "correction_coefficient": (("part", "correction_term", "output"), self.coefficients),
        }

    @classmethod
    def restore(cls, stored: xr.Dataset, levels: tuple[int, ...], outputs: int) -> Self | None:
        """Return the correction in a file, None where it has none."""
        if "correction_degree" not in stored:
            return None
        indices, coefficients = stored["correction_degree"].values, stored["correction_coefficient"].values
        shape = (len(levels), len(indices), outputs)
        if indices.dtype.kind not in "iu" or indices.shape[1:] != (len(levels),) or coefficients.shape != shape:
            raise ValueError("the correction of the mean does not fit the model")
        if not indices.size or indices.min() < 0 or indices.max() > MOST_TERMS or len(indices) > MOST_TERMS:
            raise ValueError("the correction of the mean has degrees that none has")
        return cls(levels, indices.astype(np.intp), coefficients)

    @cached_property
    def _matrix(self) -> Array:
        """Coefficients as one matrix, (d * p, m)."""
        return np.ascontiguousarray(self.coefficients.transpose(0, 2, 1).reshape(-1, len(self.indices)))

    @cached_property
    def _degree(self) -> int:
        return max(int(self.indices.max()), *self.levels)

    def _polynomials(self, t: Array) -> Array:
        return products.polynomials(t, self._degree + 1)

    def _nodal(self, T: Array) -> Array:
        """Return T_{n_f}(t_f), (d, B), from polynomials T, or its derivatives from theirs, (count, d, B)."""
        return np.asarray(T[list(self.levels), np.arange(len(self.levels))])


def degrees(rho: Sequence[float], cases: int, known_at: Sequence[int] | None = None) -> Indices | None:
    """Return the degrees a, (m, d), of the cheapest terms, sum_j a_j cost_j, that the cases allow; None if too few."""
    cost = np.minimum(-0.5 * np.log(rho), DEAREST)
    most = min(cases // CASES_A_TERM, MOST_TERMS) // len(cost)
    shared = [k for k, count in enumerate(known_at or ()) if count < cases]
    parts: set[tuple[int, ...]] = set()
    most_parts = min(known_at or [cases]) // CASES_A_TERM // (1 + len(shared)) if shared else 1
    heap: list[tuple[float, tuple[int, ...]]] = [(0.0, (0,) * len(cost))]
    ranked: list[tuple[float, tuple[int, ...]]] = []
    while heap and heap[0][0] <= COST and len(ranked) <= most:
        spent, index = heappop(heap)
        part = tuple(index[k] for k in shared)
        if part not in parts and len(parts) >= max(most_parts, 1):
            continue  # the indices that follow from it have the same part or a larger one
        parts.add(part)
        ranked.append((spent, index))
        # each index is reached once: from the one without its last degree
        last = max((j for j, degree in enumerate(index) if degree), default=0)
        for j in range(last, len(cost)):
            above = (*index[:j], index[j] + 1, *index[j + 1 :])
            heappush(heap, (float(np.dot(above, cost)), above))
    if len(ranked) > most:  # drop all terms that cost as much as the first one too many
        beyond = ranked[-1][0]
        if beyond <= LEAST_COST:
            return None
        ranked = [pair for pair in ranked if pair[0] < beyond * (1 - 1e-12)]
    return np.array([index for _, index in ranked], dtype=np.intp)


def correct(
    errors: Array, t: Array, levels: tuple[int, ...], rho: Sequence[float], groups: Indices
) -> tuple[Correction | None, Array]:
    """Return the correction learnt from held-out errors (p, n) at t, (d, n), None if too few, and what it leaves."""
    indices = degrees(rho, errors.shape[1], places(t, groups).tolist())
    if indices is None:
        return None, errors
    first, later = slice(MOST_CASES), slice(MOST_CASES, None)
    fitted, left = _fitted(errors[:, first], t[:, first], levels, indices, groups[first])
    if errors.shape[1] > MOST_CASES:
        left = np.hstack([left, errors[:, later] - in_blocks(t[:, later], fitted.values)])
    return fitted, left


def _fitted(
    errors: Array, t: Array, levels: tuple[int, ...], indices: Indices, groups: Indices
) -> tuple[Correction, Array]:
    """Return the correction by least squares and the errors, (p, n), that it leaves with each group left out."""
    empty = Correction(levels, indices, np.empty((len(t), len(indices), 0)))
    T = empty._polynomials(t)
    features = (empty._nodal(T)[:, None] * product(indices, T)).reshape(-1, t.shape[1])
    basis, values, back = np.linalg.svd(features.T, full_matrices=False)
    significant = values > TOLERANCE * values[0]
    basis, back = basis[:, significant], (back[significant] / values[significant, None]).T
    coefficients = errors @ basis
    left = _left_out(errors - coefficients @ basis.T, basis, groups)
    little_gain = np.median(np.abs(left), axis=1) > LEAST_GAIN * np.median(np.abs(errors), axis=1)
    for p in np.flatnonzero(little_gain):
        coefficients[p], left[p] = _weighted(basis, errors[p], _rough_scale(left[p], t), groups)
    worse = (left**2).sum(axis=1) >= (errors**2).sum(axis=1)  # these outputs keep their means
    coefficients[worse], left[worse] = 0.0, errors[worse]
    whole = (back @ coefficients.T).reshape(*empty.coefficients.shape[:2], len(errors))
    return replace(empty, coefficients=whole), left


def _weighted(basis: Array, error: Array, scale: Array, groups: Indices) -> tuple[Array, Array]:
    """Return weighted coefficients (k,) in a basis (n, k), and the errors (n,) that they leave with groups left out."""
    root = scale**-WEIGHT_POWER
    orthonormal, triangle = np.linalg.qr(basis * root[:, None])
    projections = orthonormal.T @ (error * root)
    left = _left_out((error * root - orthonormal @ projections)[None], orthonormal, groups)[0]
    return scipy.linalg.solve_triangular(triangle, projections), left / root


def _left_out(residuals: Array, basis: Array, groups: Indices) -> Array:
    """Return leave-one-group-out residuals, (p, n), of least squares in an orthonormal basis (n, k)."""
    # residuals over 1 - leverage: D. M. Allen, Technometrics 16 (1974) 125; a group has a block of the projection
    left = residuals / np.maximum(1 - np.einsum("nk,nk->n", basis, basis), TOLERANCE)
    order = np.argsort(groups, kind="stable")
    for cases in np.split(order, np.flatnonzero(np.diff(groups[order])) + 1):
        if len(cases) > 1:
            rows = basis[cases]
            values, vectors = np.linalg.eigh(np.eye(len(cases)) - rows @ rows.T)
            left[:, cases] = residuals[:, cases] @ (vectors / np.maximum(values, UNKNOWN)) @ vectors.T
    return np.asarray(left)


def _rough_scale(left: Array, t: Array) -> Array:
    """Return the size of errors (n,) at t, (d, n), over its median: the exponential of an additive polynomial."""
    sizes = np.abs(left)
    if not sizes.any():
        return np.ones_like(left)
    terms = products.values(additive([SCALE_DEGREE] * len(t)), t).T
    logarithm = np.log(np.maximum(sizes, SMALLEST * sizes.max()))
    scale = np.exp(terms @ np.linalg.lstsq(terms, logarithm, rcond=None)[0])
    return np.asarray(np.maximum(scale / np.median(scale), SMALLEST_SCALE))
