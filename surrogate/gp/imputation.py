"""Missing cases of a factorial, filled in by the posterior mean of its grid's Gaussian process.

The values z at the missing places m solve K^-1[m, m] z = -K^-1[m, rest] y[rest] (C. E. Rasmussen and C. K. I. Williams,
Gaussian Processes for Machine Learning (2006), section A.2). The kernels' parameters follow from the filled grid, so
both are found in turn.

The inverse of the Chebyshev kernel overflows. Instead z minimises |K^-1/2 y|^2, weighted least squares with one row per
mode of the grid. Householder QR with column pivoting keeps the digits of every row if the heaviest rows come first
(A. J. Cox and N. J. Higham, Stability of Householder QR factorization for weighted least squares problems (1998)).
Factors along which the same places are missing fall out of K and are solved together.
"""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from scipy.linalg import qr, solve_triangular
from scipy.ndimage import distance_transform_edt

from approximation.arrays import Array, Flags
from surrogate.gp.factors import Factor
from surrogate.gp.gridgp import GridGP

MOST = 2000  # missing places along the dependent factors
ROUNDS, STILL = 4, 1e-9  # fits of the process to the filled grid, and the change over range that ends them
# Most numbers of the least-squares matrix, but for so many rows per missing place; the lightest rows are left out
_ROOM, _ROWS = 2**24, 4
_LIGHTEST = -300.0  # logarithm of the least weight of a row over the largest


def fit(make: Callable[[], GridGP], data: xr.Dataset, missing: Flags) -> GridGP:
    """Fit a grid's process to a factorial without the cases that `missing`, (n_1, ..., n_d), marks."""
    nearest = tuple(distance_transform_edt(missing, return_distances=False, return_indices=True))
    data = data.map(lambda array: array.copy(data=array.values[nearest]))
    model = make().fit(data)
    for _ in range(ROUNDS):
        moved = 0.0
        stacked = np.stack([data[name].values for name in model.outputs_], -1) - model.offset_
        filling = expected(model.factors_, stacked, missing) + model.offset_
        for name, new in zip(model.outputs_, filling.T, strict=True):
            values = data[name].values
            moved = max(moved, float(np.abs(new - values[missing]).max() / (np.ptp(values) or 1.0)))
            values[missing] = new
        model = make().fit(data)
        if moved <= STILL:
            break
    return model


def expected(factors: Sequence[Factor], values: Array, missing: Flags) -> Array:
    """Return the posterior mean at the missing places, (m, p), given values (n_1, ..., n_d, p) at all others."""
    dependent = [k for k in range(missing.ndim) if (missing != np.take(missing, [0], axis=k)).any()]
    independent = [k for k in range(missing.ndim) if k not in dependent]
    order = [*dependent, *independent]
    flags = missing.transpose(order)
    inner = flags.reshape(*flags.shape[: len(dependent)], -1)[..., 0]
    if np.count_nonzero(inner) > MOST:
        raise ValueError(
            f"{np.count_nonzero(inner)} places of the factors on which it depends that some are missing: at most "
            f"{MOST} are filled in"
        )
    moved = values.transpose(*order, -1)
    columns = moved.reshape(*inner.shape, -1)
    known = np.where(inner[..., None], 0.0, columns)
    whole = np.zeros(columns.shape)
    whole[inner] = _of_modes([factors[k] for k in dependent], known, inner)
    back = whole.reshape(moved.shape).transpose(*np.argsort(order), -1)
    return np.asarray(back[missing])


def _of_modes(factors: Sequence[Factor], known: Array, missing: Flags) -> Array:
    """Return the posterior mean at the missing places, (m, columns), by weighted least squares over the modes."""
    count = int(np.count_nonzero(missing))
    weights = np.zeros(missing.shape)  # logarithms
    for axis, factor in enumerate(factors):
        along = np.log(factor.weights) - 0.5 * np.log(factor.eigenvalues)
        weights += along.reshape([-1 if k == axis else 1 for k in range(missing.ndim)])
    heaviest = np.argsort(-weights.ravel(), kind="stable")[: max(_ROWS * count, _ROOM // count)]
    scale = np.exp(np.maximum(weights.ravel()[heaviest] - weights.max(), _LIGHTEST))
    matrix = np.repeat(scale[:, None], count, axis=1)
    for axis, (factor, modes, places) in enumerate(
        zip(factors, np.unravel_index(heaviest, missing.shape), np.nonzero(missing), strict=True)
    ):
        matrix *= factor.basis.T[np.ix_(modes, places)]
        known = np.moveaxis(np.tensordot(factor.basis.T, known, (1, axis)), 0, axis)
    right = -scale[:, None] * known.reshape(missing.size, -1)[heaviest]
    orthogonal, triangle, order = qr(matrix, mode="economic", pivoting=True, overwrite_a=True)
    columns = np.empty((count, right.shape[1]))
    columns[order] = solve_triangular(triangle, orthogonal.T @ right)
    return columns
