"""Plain tensor Chebyshev interpolation: the baseline that every validation of a grid surrogate must show."""

from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np
import xarray as xr

from approximation import chebyshev
from approximation.arrays import Array, blocks
from surrogate.data.factorial import complete_factorial
from surrogate.data.inputs import Input
from surrogate.data.points import named_points
from surrogate.face.model import GaussianProcess
from surrogate.transforms.transformed import groups_of

# Elements of the largest intermediate array, which bounds memory.
ELEMENTS = 2**22


def chebyshev_interpolation(
    training: xr.Dataset,
    inputs: Sequence[Input] | None,
    points: Mapping[str, Any] | xr.Dataset,
    outputs: Sequence[str] | None = None,
) -> xr.Dataset:
    """Interpolate a factorial on Chebyshev-Gauss levels by the tensor-product polynomial through all its cases.

    Source: L. N. Trefethen, Approximation Theory and Approximation Practice (2013), chapters 3 and 4.
    """
    data = complete_factorial(training, inputs, outputs)
    named = named_points(points, data.inputs)
    t = [input_.to_unit(named.X[:, k]) for k, input_ in enumerate(data.inputs)]
    answer = {}
    for name, values in data.outputs.items():
        series = reduce(chebyshev.coefficients, range(values.ndim), values)
        rows = [chebyshev.polynomials(column, size).T for column, size in zip(t, values.shape, strict=True)]
        answer[name] = named.labelled(contracted(series[..., None], rows)[:, 0], data.attrs[name])
    return xr.Dataset(answer)


def baseline(
    model: GaussianProcess, training: xr.Dataset, points: Mapping[str, Any] | xr.Dataset, outputs: Sequence[str]
) -> xr.Dataset:
    """Interpolate what a grid or grouped model was trained on: over its own inputs, or its axes and scaled outputs."""
    grouping, named = groups_of(model), named_points(points, model.inputs_)
    if grouping is None:
        return chebyshev_interpolation(training, list(model.inputs_), points, outputs)
    axes = {axis.name: training[axis.name] for axis in grouping.axes}
    products = xr.DataArray(grouping.products.values(named.X), dims=("point", "axis"))
    columns = {axis.name: products.isel(axis=k) for k, axis in enumerate(grouping.axes)}
    interpolated = chebyshev_interpolation(
        grouping.reduced(training, outputs).assign_coords(axes), grouping.axes, columns, outputs
    )
    rows = grouping.scales(outputs).untransform(np.stack([interpolated[name].values for name in outputs]), named.X)
    return named.dataset({name: (row, training[name].attrs) for name, row in zip(outputs, rows, strict=True)})


def contracted(tensor: Array, rows: Sequence[Array]) -> Array:
    """Return a tensor contracted with a row for every point and factor, (B, p).

    tensor: (n_1, ..., n_d, p); rows: sequence of ndarray, shape (B, n_f), of every factor.
    """
    answer = np.empty((len(rows[0]), tensor.shape[-1]))
    size = max(1, ELEMENTS // int(np.prod(tensor.shape[1:])))
    for block in blocks(len(answer), size):
        state = rows[0][block] @ tensor.reshape(tensor.shape[0], -1)
        for row in rows[1:]:
            state = np.einsum("bi,bij->bj", row[block], state.reshape(len(state), row.shape[1], -1))
        answer[block] = state
    return answer
