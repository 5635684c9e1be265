"""Regions of many cases: selected, put together, and the one case for which the solver refuses the others."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from solver import FactorError

Solved = Callable[[Mapping[str, Any]], xr.Dataset]
_Cases = Mapping[str, xr.DataArray]
_Region = dict[str, slice]


def refused(
    solved: Callable[[Mapping[str, Any]], object], factors: Mapping[str, Any], reason: FactorError
) -> tuple[dict[str, Any], FactorError]:
    """Return factors and reason of one refused case, searched by halves; no factors where only several are refused."""
    cases = {name: labelled(name, value) for name, value in factors.items()}
    region = {dim: slice(0, size) for dim, size in sizes(cases).items()}
    while True:
        longest = max(region, key=lambda dim: _length(region[dim]), default="")
        if not longest or _length(region[longest]) == 1:
            return {name: array.item() for name, array in selected(cases, region).items()}, reason
        whole = region[longest]
        middle = (whole.start + whole.stop) // 2
        for half in (slice(whole.start, middle), slice(middle, whole.stop)):
            try:
                solved(selected(cases, {**region, longest: half}))
            except FactorError as error:
                region, reason = {**region, longest: half}, error
                break
        else:
            return {}, reason


def _length(part: slice) -> int:
    return int(part.stop - part.start)


def assembled(parts: Sequence[tuple[_Region, xr.Dataset]], whole_sizes: Mapping[str, int]) -> xr.Dataset:
    """Cases of several regions in one data set, without what a part lacks; NaN where no part lies."""
    first_region, first = parts[0]
    shared = first[[name for name in first.data_vars if all(name in part for _, part in parts)]]
    variables: dict[str, xr.Variable] = {}
    for name, variable in shared.variables.items():
        if not set(first_region).isdisjoint(map(str, variable.dims)):
            shape = [whole_sizes.get(str(dim), variable.sizes[dim]) for dim in variable.dims]
            values = np.full(shape, np.nan if variable.dtype.kind == "f" else 0, variable.dtype)
            for region, part in parts:
                values[tuple(region.get(str(dim), slice(None)) for dim in variable.dims)] = part[name].values
            variable = xr.Variable(variable.dims, values, variable.attrs)
        variables[str(name)] = variable
    coords = {name: variable for name, variable in variables.items() if name in shared.coords}
    return xr.Dataset({name: variables[name] for name in map(str, shared.data_vars)}, coords, shared.attrs)


def sizes(cases: _Cases) -> dict[str, int]:
    """Length of every dimension of some cases."""
    return {str(dim): size for array in cases.values() for dim, size in array.sizes.items()}


def selected(cases: _Cases, region: Mapping[str, slice]) -> dict[str, xr.DataArray]:
    """The cases of a region."""
    return {name: array.isel(region, missing_dims="ignore") for name, array in cases.items()}


def labelled(name: str, value: ArrayLike | xr.DataArray) -> xr.DataArray:
    """Values of a factor, along itself where they are a sequence."""
    return value if isinstance(value, xr.DataArray) else xr.DataArray(np.asarray(value), dims=(name,) * np.ndim(value))
