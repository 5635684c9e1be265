"""Products of kernels on a grid: coefficients in the factors' bases, and the variance that the levels leave."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from approximation.arrays import Array
from surrogate.gp.factors import Features


def unit_variance(
    amplitudes: Array,
    features: Sequence[Features],
    weights: Array,
    slope: tuple[int, Features] | None = None,
) -> Array:
    """Return the posterior variance at unit process variance, (p, B), its parts weighted by (d, p).

    prod_f k_f - prod_f q_f with q_f = k_f - r_f known and r_f unknown parts is the sum over factors of
    q_1 .. q_{f-1} r_f k_{f+1} .. k_d: no cancellation, never negative. It is linear in what every factor brings, so
    that with the slopes of one factor in place of its features it is the variance of the derivative.

    amplitudes: (d, p); weights: (d, p).
    """
    shape = (amplitudes.shape[1], len(features[0].prior))
    unknown, known = np.zeros(shape), np.ones(shape)
    for f, (amplitude, weight) in enumerate(zip(amplitudes, weights, strict=True)):
        derived = slope is not None and slope[0] == f
        feature = slope[1] if slope is not None and derived else features[f]
        k = amplitude[:, None] * feature.prior + (0.0 if derived else 1.0)
        r = amplitude[:, None] * feature.residual
        unknown *= k
        unknown += known * r * weight[:, None]
        k -= r
        known *= k
    return unknown


def standardised(values: Array, bases: Sequence[Array], grams: Sequence[Array]) -> tuple[Array, float, float]:
    """Standardise one output and take its coefficients in the factors' bases.

    values: (n_1, ..., n_d), the output; bases: sequence of ndarray, shape (n_f, n_f), orthonormal columns of every
    factor; grams: sequence of ndarray, shape (n_f, n_f), into which the coefficients' products along every factor
    are written; result: (n_1, ..., n_d).
    """
    offset = float(values.mean())
    residual: Any = values - offset
    spread = float(np.sqrt(np.vdot(residual, residual) / values.size))
    scale = spread if spread > 0 else 1.0
    # each product transforms the leading axis and moves it to the end, so after all of them the order is the old one
    for basis, gram in zip(bases, grams, strict=True):
        residual = residual.reshape(len(basis), -1).T @ (basis / scale)
        gram[...] = residual.T @ residual
        scale = 1.0
    return residual.reshape(values.shape), offset, spread if spread > 0 else 1.0


def significant(coefficients: Array, grams: Sequence[Array], allowed: float) -> Array:
    """Drop the highest modes of every factor, as long as their sum of squares stays small.

    coefficients: (n_1, ..., n_d), of one output; grams: sequence of ndarray, shape (n_f, n_f), their products along
    every factor.
    """
    sizes = []
    for gram in grams:
        tail = np.cumsum(np.diag(gram)[::-1])[::-1]
        sizes.append(max(1, int(np.count_nonzero(tail > allowed))))
    return coefficients[tuple(map(slice, sizes))].copy()


def joined(coefficients: Sequence[Array]) -> tuple[tuple[int, ...], Array]:
    """Join the outputs' coefficients to one tensor, outputs last, and say in which order its factors stand.

    Contracting the largest factors first keeps the ranks of its tensor train, hence the cost of a query, small.
    """
    modes = tuple(
        max(sizes) for sizes in zip(*(output_coefficients.shape for output_coefficients in coefficients), strict=True)
    )
    order = tuple(int(k) for k in np.argsort([-size for size in modes], kind="stable"))
    tensor = np.zeros((*modes, len(coefficients)))
    for p, output_coefficients in enumerate(coefficients):
        tensor[..., p][tuple(map(slice, output_coefficients.shape))] = output_coefficients
    return order, tensor.transpose(*order, len(modes))
