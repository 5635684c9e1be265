"""Query points by name: from scalars, arrays and labelled arrays to one array of points, and back."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from surrogate.data.arrays import Array, Flags
from surrogate.data.inputs import Input

# Room for rounding at the ends of the box, as a share of its width on the input's own scale.
SLACK = 1e-12


@runtime_checkable
class Table(Protocol):
    """What a DataFrame is here: named columns, had by their names."""

    columns: Any

    def __getitem__(self, name: Any, /) -> Any: ...


# What a query may be: named inputs, a table with a column an input, or plain points in the order of the inputs.
Queries: TypeAlias = Mapping[Any, Any] | xr.Dataset | Table | ArrayLike


class OutOfBoxError(ValueError):
    """A query point lies outside the box that the model was trained on."""


@dataclass(frozen=True)
class Points:
    """Query points as an array, with what is needed to label the answers.

    Attributes
    ----------
    X : ndarray, shape (n, d)
        Points in physical units, columns in the order of the model's inputs.
    dims : tuple of str
        Dimensions of the broadcast of all inputs.
    shape : tuple of int
        Its shape; the product is n.
    coords : mapping
        Coordinates that the labelled inputs brought along.
    """

    X: Array
    dims: tuple[Hashable, ...]
    shape: tuple[int, ...]
    coords: Mapping[Hashable, Any]

    def labelled(self, values: NDArray[Any], attrs: Mapping[str, str]) -> xr.DataArray:
        """Label one value per point: shape (n,) -> the shape of the broadcast."""
        return xr.DataArray(values.reshape(self.shape), coords=self.coords, dims=self.dims, attrs=dict(attrs))

    def flat(self, array: xr.DataArray, like: xr.DataArray) -> Array:
        """Broadcast an array to the points, labelled `like` one of their answers: shape (n,)."""
        return np.asarray(array.broadcast_like(like).transpose(*like.dims).values, dtype=np.float64).ravel()


def named_points(points: Queries, inputs: Sequence[Input]) -> Points:
    """Broadcast named inputs against each other.

    Parameters
    ----------
    points : mapping, Dataset, DataFrame or array
        One entry per input: a scalar, a 1-d array (dimension `point`), or a DataArray of any dimensions. A DataFrame
        has a column an input, in any order; an array is (n, d), columns in the order of the inputs.
    inputs : sequence of Input
        What the model needs.

    Raises
    ------
    ValueError
        A missing or unknown name, arrays of another shape, unequal length or coordinates, values that are not finite
        numbers.
    """
    if not isinstance(points, (Mapping, xr.Dataset)):
        points = _by_name(points, [one.name for one in inputs])
    _check_names(points, [one.name for one in inputs])
    arrays = [_as_array(one.name, points[one.name]) for one in inputs]
    lengths = {one.name: a.sizes["point"] for one, a in zip(inputs, arrays, strict=True) if "point" in a.dims}
    if len(set(lengths.values())) > 1:
        raise ValueError(
            f"inputs differ in length: {', '.join(f'{name} has {size}' for name, size in lengths.items())}"
        )
    try:
        aligned = xr.broadcast(*xr.align(*arrays, join="exact", copy=False))
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise ValueError(f"the coordinates of the inputs do not agree: {reason}") from error
    X = np.stack([np.asarray(a.values, dtype=np.float64).ravel() for a in aligned], axis=1)
    for k, one in enumerate(inputs):
        bad = ~np.isfinite(X[:, k])
        if bad.any():
            raise ValueError(
                f"input {one.name!r} is {X[bad, k][0]} at {bad.sum()} of {len(X)} points; give finite values"
            )
    return Points(X, aligned[0].dims, aligned[0].shape, dict(aligned[0].coords))


def outside(X: Array, inputs: Sequence[Input]) -> Flags:
    """Return, for points (n, d), which entries lie outside the box (NaN counts as outside), shape (n, d)."""
    margins = [_margin(one) for one in inputs]
    low = np.array([lower for lower, _ in margins])
    high = np.array([upper for _, upper in margins])
    return np.asarray(~((low <= X) & (high >= X)))


def require_inside(X: Array, inputs: Sequence[Input]) -> None:
    """Raise OutOfBoxError, naming input, value and allowed range, unless all points (n, d) lie in the box."""
    wrong = outside(X, inputs)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        one, count = inputs[column], int(wrong.any(axis=1).sum())
        others = f" ({count} of {len(X)} points are outside)" if len(X) > 1 else ""
        raise OutOfBoxError(f"{one.name} = {X[row, column]:.10g} is outside the trained box {one.range_text()}{others}")


def _margin(one: Input) -> tuple[float, float]:
    if one.scale == "log":
        slack = SLACK * np.log(one.high / one.low)
        return one.low * (1 - slack), one.high * (1 + slack)
    slack = SLACK * (one.high - one.low)
    return one.low - slack, one.high + slack


def _by_name(points: Table | ArrayLike, names: Sequence[str]) -> dict[Any, Any]:
    """The columns of a table or of plain points."""
    if isinstance(points, Table):
        if len(set(points.columns)) < len(points.columns):
            raise ValueError("the table of points has a column twice")
        return {name: np.asarray(points[name]) for name in points.columns}
    array = None if isinstance(points, (str, bytes, xr.DataArray)) else _plain(points)
    if array is None or array.ndim != 2 or array.shape[1] != len(names) or array.dtype.kind not in "iuf":
        got = type(points).__name__ if array is None else f"{array.dtype} values of shape {array.shape}"
        raise ValueError(
            f"points must be named, or an array of numbers of shape (n, {len(names)}) with the columns "
            f"{', '.join(names)}; got {got}"
        )
    return dict(zip(names, array.T, strict=True))


def _plain(points: ArrayLike) -> NDArray[Any] | None:
    try:
        return np.asarray(points)
    except ValueError:  # rows of unequal length
        return None


def _check_names(points: Mapping[Any, Any] | xr.Dataset, names: Sequence[str]) -> None:
    given = [*points.data_vars] if isinstance(points, xr.Dataset) else [*points]
    for name in given:
        if name not in names:
            near = get_close_matches(str(name), names, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else f"; the inputs are {', '.join(names)}"
            raise ValueError(f"unknown input {name!r}{hint}")
    for name in names:
        if name not in points:
            raise ValueError(f"input {name!r} is missing; the inputs are {', '.join(names)}")


def _as_array(name: str, value: object) -> xr.DataArray:
    if isinstance(value, xr.DataArray):
        array = value.reset_coords(drop=True)
    else:
        plain = np.asarray(value)
        if plain.ndim > 1:
            raise ValueError(f"input {name!r} is an array of {plain.ndim} dimensions; label it (xarray.DataArray)")
        array = xr.DataArray(plain, dims=("point",) * plain.ndim)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"input {name!r} must be numbers, got {array.dtype} values")
    return array.astype(np.float64)
