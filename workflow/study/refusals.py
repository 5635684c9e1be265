"""Cases that the solver refuses among many that it answers: a mask beside the answers, with the reason of each."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from solver import CaseError, FactorError

#: The mask over the cases, and the texts that its numbers, from 1 on, stand for.
REFUSAL, REASON = "refusal", "refusal_reason"
#: Largest share of a data set's places that may be missing.
MOST = 0.2
_MASK = {
    "long_name": "0 where the solver answers a case; where it refuses one, the number of the reason, from 1 on",
    "units": "1",
}
_REASONS = {"long_name": "why the solver refuses cases", "units": "1"}

Solved = Callable[[Mapping[str, Any]], xr.Dataset]
_Cases = Mapping[str, xr.DataArray]
_Region = dict[str, slice]
_Part = tuple[_Region, xr.Dataset | FactorError]


class HolesError(ValueError):
    """More of a study's cases are refused than may be missing."""


class AllRefusedError(CaseError):
    """The solver refuses all of some cases.

    mask: `REFUSAL` over the cases' dimensions and `REASON`, as of `answered`.
    """

    def __init__(self, mask: xr.Dataset) -> None:
        super().__init__(str(mask[REASON].values[0]))
        self.mask = mask


def answered(solved: Solved, factors: Mapping[str, Any], most: float = np.inf) -> xr.Dataset:
    """Exact cases with those masked that the solver refuses, which are looked for by halves.

    Cases of which none is refused cost what they cost without. Of k that are refused among n, each is met once in every
    half that holds it: at most some k log2(n) further calls, most of them small.
    """
    try:
        return solved(factors)
    except CaseError as error:
        first = error
    cases = {name: labelled(name, value) for name, value in factors.items()}
    whole_sizes = sizes(cases)
    whole = {dim: slice(0, size) for dim, size in whole_sizes.items()}
    parts, count = [], 0
    for region, part in _parts(solved, cases, whole, first):
        parts.append((region, part))
        count += isinstance(part, FactorError)
        if count > most:
            raise HolesError(str(part))
    if count == len(parts):
        raise AllRefusedError(_masked(xr.Dataset(), list(whole_sizes), whole_sizes, parts))
    return _whole(cases, whole_sizes, parts)


def refused(
    solved: Callable[[Mapping[str, Any]], object], factors: Mapping[str, Any], reason: FactorError
) -> tuple[dict[str, Any], FactorError]:
    """Return factors and reason of one refused case, searched by halves; None if cases are refused only together."""
    cases = {name: labelled(name, value) for name, value in factors.items()}
    whole = {dim: slice(0, size) for dim, size in sizes(cases).items()}
    parts = _parts(solved, cases, whole, reason, FactorError)
    for region, part in parts:
        if isinstance(part, FactorError):
            return {name: array.item() for name, array in selected(cases, region).items()}, part
    return {}, reason


def _parts(
    solved: Callable[[Mapping[str, Any]], Any],
    cases: _Cases,
    region: _Region,
    reason: FactorError,
    refusal: type[FactorError] = CaseError,
) -> Iterator[_Part]:
    """Answers of parts of a region that is refused as a whole, and of every case that is refused alone, why."""
    longest = max(region, key=lambda dim: _length(region[dim]), default="")
    if not longest or _length(region[longest]) == 1:
        yield region, reason
        return
    whole = region[longest]
    middle = (whole.start + whole.stop) // 2
    for half_slice in (slice(whole.start, middle), slice(middle, whole.stop)):
        half = {**region, longest: half_slice}
        try:
            answer = solved(selected(cases, half))
        except refusal as error:
            yield from _parts(solved, cases, half, error, refusal)
        else:
            yield half, answer


def _length(part: slice) -> int:
    return int(part.stop - part.start)


def _whole(cases: _Cases, whole_sizes: Mapping[str, int], parts: Sequence[_Part]) -> xr.Dataset:
    """The parts put together, NaN where the solver refuses, and the mask with its reasons."""
    whole = assembled([(region, part) for region, part in parts if isinstance(part, xr.Dataset)], whole_sizes)
    dims = next(([*map(str, array.dims)] for array in whole.data_vars.values()), list(whole_sizes))
    given = {name: _given(cases[name], whole[name].variable) for name in map(str, whole.coords) if name in cases}
    whole = whole.assign_coords({name: value for name, value in given.items() if set(value.dims) & {*whole_sizes}})
    return _masked(whole, [dim for dim in dims if dim in whole_sizes], whole_sizes, parts)


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


def _masked(
    data: xr.Dataset, dims: Sequence[str], whole_sizes: Mapping[str, int], parts: Sequence[_Part]
) -> xr.Dataset:
    """Data with the mask of the refused parts."""
    refused = [(region, str(part)) for region, part in parts if isinstance(part, FactorError)]
    numbers = {reason: k for k, reason in enumerate(dict.fromkeys(reason for _, reason in refused), 1)}
    mask = np.zeros([whole_sizes[dim] for dim in dims], dtype=np.int32)
    for region, reason in refused:
        mask[tuple(region[dim] for dim in dims)] = numbers[reason]
    return masked(data, xr.Variable(dims, mask), list(numbers))


def _given(array: xr.DataArray, like: xr.Variable) -> xr.Variable:
    """A factor's values over the dimensions of a coordinate."""
    values = array.transpose(*(dim for dim in like.dims if dim in array.dims)).values
    values = values.reshape([array.sizes.get(dim, 1) for dim in like.dims])
    return xr.Variable(like.dims, np.broadcast_to(values, like.shape).copy(), like.attrs)


def masked(data: xr.Dataset, mask: xr.Variable, reasons: Sequence[str]) -> xr.Dataset:
    """Cases with a mask of those that are refused, and its reasons."""
    texts = np.array(reasons, dtype=str)
    return data.assign({REFUSAL: (mask.dims, mask.values, _MASK), REASON: ("reason", texts, _REASONS)})


def labelled(name: str, value: ArrayLike | xr.DataArray) -> xr.DataArray:
    """Values of a factor, along itself where they are a sequence."""
    return value if isinstance(value, xr.DataArray) else xr.DataArray(np.asarray(value), dims=(name,) * np.ndim(value))
