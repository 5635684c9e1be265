"""Query points: named scalars, arrays, labelled arrays and tables as one array of points with its labels."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import prod
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from approximation.arrays import Array, Flags, columns_of, unmasked
from surrogate.data.inputs import Input, unit_coordinates

SLACK = 1e-12  # room for rounding at the ends of the box, as a share of its width on the input's scale
MOST = 10**7  # points that crossed inputs may span; a user with more meant a list of points
#: Variable of held-out cases: 1 where they are spread evenly over the box, 0 where they are drawn towards its ends.
EVEN = "evenly_drawn"
CASE = "case"  # dimension of the rows of a table, as in the answers of the solver


@runtime_checkable
class Table(Protocol):
    """Named columns of one length, such as a DataFrame."""

    columns: Any

    def __getitem__(self, name: Any, /) -> Any: ...


# Named inputs, a table with one column per input, a list of mappings, or plain points in the order of the inputs.
Queries: TypeAlias = Mapping[Any, Any] | xr.Dataset | Table | Sequence[Mapping[str, Any]] | ArrayLike


class OutOfBoxError(ValueError):
    """A query point lies outside the box on which the model was trained."""


@dataclass(frozen=True)
class Points:
    """Query points as an array, with the labels of the answers."""

    X: Array  # shape (n, d); physical units, columns in the order of the model's inputs
    dims: tuple[Hashable, ...]  # dimensions of the broadcast inputs
    shape: tuple[int, ...]  # sizes of `dims`, whose product is n
    coords: Mapping[Hashable, xr.Variable]  # every input, and the labels of its dimensions

    def stacked(self, dataset: xr.Dataset, names: Sequence[str]) -> Array:
        """Return variables of a data set broadcast to the points, (len(names), n)."""
        like = xr.DataArray(np.zeros(self.shape), self.coords, self.dims)
        columns = (dataset[name].broadcast_like(like).transpose(*self.dims) for name in names)
        return np.stack([np.asarray(column.values, dtype=np.float64).ravel() for column in columns])


def named_points(points: Queries, inputs: Sequence[Input]) -> Points:
    """Return query points with their inputs broadcast against each other; ValueError names what does not fit."""
    names = [input_.name for input_ in inputs]
    if not isinstance(points, (Mapping, xr.Dataset)):
        points = _by_name(points, names)
    _check_names(points, names)
    point = _one_point(points, names)
    if point is not None:
        coordinates: dict[Hashable, xr.Variable] = {
            factor.name: xr.Variable((), x, factor.attrs) for factor, x in zip(inputs, point, strict=True)
        }
        return Points(point[None], (), (), coordinates)
    if columns := {} if isinstance(points, xr.Dataset) else columns_of(points):
        points = {**points, **_columns(columns, next(iter(columns.values())).index)}
    arrays = {name: _as_array(name, points[name], names) for name in names}
    try:
        xr.align(*(array for array in arrays.values() if array.dims), join="exact", copy=False)
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise ValueError(f"the coordinates of the inputs do not agree: {reason}") from error
    sizes = {dim: size for array in arrays.values() for dim, size in array.sizes.items()}
    shape = tuple(sizes.values())
    if len(shape) > 1 and prod(shape) > MOST:
        raise ValueError(
            f"the inputs span {prod(shape)} points, more than {MOST}; sequences are crossed: for a list of points give "
            "a table, or DataArrays that share a dimension"
        )
    X = np.empty((*shape, len(names)))
    for k, (name, array) in enumerate(arrays.items()):
        X[..., k] = array.variable.set_dims(sizes).values  # type: ignore[no-untyped-call]
        bad = ~np.isfinite(array.values)
        if bad.any():
            where = int(np.count_nonzero(~np.isfinite(X[..., k])))
            raise ValueError(
                f"input {name!r} is {array.values[bad][0]} at {where} of {prod(shape)} points; give finite values"
            )
    coords = {label: coord.variable for array in arrays.values() for label, coord in array.coords.items()}
    coords |= {
        input_.name: xr.Variable(arrays[input_.name].dims, arrays[input_.name].values, input_.attrs)
        for input_ in inputs
    }
    return Points(X.reshape(-1, len(names)), tuple(sizes), shape, coords)


def outside(X: Array, inputs: Sequence[Input]) -> Flags:
    """Mark the entries of physical points X, (n, d), that lie outside the box, (n, d); NaN counts as outside."""
    with np.errstate(divide="ignore", invalid="ignore"):  # logarithms of numbers <= 0
        return np.asarray(~(np.abs(unit_coordinates(inputs, X)) <= 1 + 2 * SLACK).T)


def require_inside(X: Array, inputs: Sequence[Input]) -> None:
    """Raise OutOfBoxError with input, value and range unless physical points X, (n, d), lie in the box."""
    wrong = outside(X, inputs)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        factor, count = inputs[column], int(wrong.any(axis=1).sum())
        others = f" ({count} of {len(X)} points are outside)" if len(X) > 1 else ""
        raise OutOfBoxError(
            f"{factor.name} = {X[row, column]:.10g} is outside the trained box {factor.range_text()}{others}"
        )


def _by_name(points: Any, names: Sequence[str]) -> dict[Any, Any]:
    """Return the columns of a table, over the labels of its rows, or of plain points, by the inputs' names."""
    if isinstance(points, Sequence) and len(points) and all(isinstance(row, Mapping) for row in points):
        import pandas as pd  # slow to import

        points = pd.DataFrame([dict(row) for row in points])
    if isinstance(points, Table):
        if len(set(points.columns)) < len(points.columns):
            raise ValueError("the table of points has a column twice")
        return _columns({name: points[name] for name in points.columns}, getattr(points, "index", None))
    array = None if isinstance(points, (str, bytes, xr.DataArray)) else _plain(points)
    if array is None or array.ndim != 2 or array.shape[1] != len(names) or array.dtype.kind not in "iuf":
        got = type(points).__name__ if array is None else f"{array.dtype} values of shape {array.shape}"
        raise ValueError(
            f"points must be named, or an array of numbers of shape (n, {len(names)}) with the columns "
            f"{', '.join(names)}; got {got}"
        )
    return {name: xr.DataArray(column, dims="point") for name, column in zip(names, array.T, strict=True)}


def _columns(columns: Mapping[Any, Any], labels: Any) -> dict[Any, Any]:
    """Return the columns of a table over the labels of its rows, without labels of several levels."""
    coords = {} if labels is None or labels.nlevels > 1 else {CASE: np.asarray(labels)}
    return {name: xr.DataArray(_numbers(column), coords, CASE) for name, column in columns.items()}


def _one_point(points: Mapping[Any, Any] | xr.Dataset, names: Sequence[str]) -> Array | None:
    """Return the point, (d,), if every entry is a plain number, which needs no broadcasting; None otherwise."""
    if not all(type(points[name]) in (float, int, np.float64) for name in names):
        return None
    values = np.array([points[name] for name in names])  # of objects where a whole number is too large
    return values.astype(np.float64) if values.dtype.kind in "if" and np.isfinite(values).all() else None


def _numbers(column: Any) -> NDArray[Any]:
    """Return the values of a column of a table; a missing number is NaN."""
    if hasattr(column, "to_numpy") and str(column.dtype) in ("Int64", "Int32", "Float64", "Float32"):
        return np.asarray(column.to_numpy(dtype=np.float64, na_value=np.nan))
    return np.asarray(unmasked(column))


def _plain(points: ArrayLike) -> NDArray[Any] | None:
    try:
        return np.asarray(unmasked(points))
    except ValueError:  # rows of unequal length
        return None


def _check_names(points: Mapping[Any, Any] | xr.Dataset, names: Sequence[str]) -> None:
    columns = [*points.data_vars] if isinstance(points, xr.Dataset) else [*points]
    for name in columns:
        if name not in names:
            near = get_close_matches(str(name), names, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else f"; the inputs are {', '.join(names)}"
            raise ValueError(f"unknown input {name!r}{hint}")
    for name in names:
        if name not in points:
            raise ValueError(f"input {name!r} is missing; the inputs are {', '.join(names)}")


def _as_array(name: str, value: object, names: Sequence[str]) -> xr.DataArray:
    if isinstance(value, xr.DataArray):
        array = value.reset_coords(drop=True)
    else:
        plain = np.asarray(unmasked(value))
        if plain.ndim > 1:
            raise ValueError(f"input {name!r} is an array of {plain.ndim} dimensions; label it (xarray.DataArray)")
        array = xr.DataArray(plain, dims=(name,) * plain.ndim)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"input {name!r} must be numbers, got {array.dtype} values; units are not read here")
    for dim in array.dims:
        if dim in names and array.dims != (name,):
            raise ValueError(
                f"input {name!r} has a dimension of an input's name, {dim!r}; only {dim!r} itself may, alone"
            )
    return array if array.dtype == np.float64 else array.astype(np.float64)
