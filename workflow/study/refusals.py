"""Cases that the solver refuses among many that it answers: a mask beside the answers, with the reason of each."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

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
    whole = _everywhere(cases)
    sizes = {dim: _length(part) for dim, part in whole.items()}
    parts, count = [], 0
    for region, part in _parts(solved, cases, whole, first):
        parts.append((region, part))
        count += isinstance(part, FactorError)
        if count > most:
            raise HolesError(str(part))
    if count == len(parts):
        raise AllRefusedError(_masked(xr.Dataset(), list(sizes), sizes, parts))
    return _whole(cases, sizes, parts)


def refused(
    solved: Callable[[Mapping[str, Any]], object], factors: Mapping[str, Any], reason: FactorError
) -> tuple[dict[str, Any], FactorError]:
    """Return factors and reason of one refused case, searched by halves; None if cases are refused only together."""
    cases = {name: labelled(name, value) for name, value in factors.items()}
    parts = _parts(solved, cases, _everywhere(cases), reason, FactorError)
    for region, part in parts:
        if isinstance(part, FactorError):
            case = {name: array.isel(region, missing_dims="ignore") for name, array in cases.items()}
            return {name: array.item() for name, array in case.items()}, part
    return {}, reason


def _everywhere(cases: _Cases) -> _Region:
    return {str(dim): slice(0, size) for array in cases.values() for dim, size in array.sizes.items()}


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
            answer = solved({name: array.isel(half, missing_dims="ignore") for name, array in cases.items()})
        except refusal as error:
            yield from _parts(solved, cases, half, error, refusal)
        else:
            yield half, answer


def _length(part: slice) -> int:
    return int(part.stop - part.start)


def _whole(cases: _Cases, sizes: Mapping[str, int], parts: Sequence[_Part]) -> xr.Dataset:
    """The parts put together, NaN where the solver refuses, and the mask with its reasons."""
    solved = [(region, part) for region, part in parts if isinstance(part, xr.Dataset)]
    like = solved[0][1]
    shared = [name for name in like.data_vars if all(name in part for _, part in solved)]
    dims = [str(dim) for dim in (like[shared[0]].dims if shared else sizes) if dim in sizes]
    whole = like[shared].drop_dims([dim for dim in dims if dim in like.dims])
    variables: dict[str, xr.Variable] = {}
    for name in [*shared, *(coordinate for coordinate in like.coords if set(like[coordinate].dims) & set(dims))]:
        variable = like[name]
        shape = [sizes.get(str(dim), variable.sizes[dim]) for dim in variable.dims]
        if name in like.coords:
            values = _given(cases[str(name)], variable, shape) if name in cases else np.full(shape, np.nan)
        else:
            values = np.full(shape, np.nan)
        for region, part in solved:
            values[tuple(region.get(str(dim), slice(None)) for dim in variable.dims)] = part[name].values
        variables[str(name)] = xr.Variable(variable.dims, values, variable.attrs)
    whole = whole.assign_coords({name: variables[name] for name in map(str, like.coords) if name in variables})
    whole = whole.assign({name: variables[name] for name in map(str, shared)})
    return _masked(whole, dims, sizes, parts)


def _masked(data: xr.Dataset, dims: Sequence[str], sizes: Mapping[str, int], parts: Sequence[_Part]) -> xr.Dataset:
    """Data with the mask of the refused parts."""
    refused = [(region, str(part)) for region, part in parts if isinstance(part, FactorError)]
    numbers = {reason: k for k, reason in enumerate(dict.fromkeys(reason for _, reason in refused), 1)}
    mask = np.zeros([sizes[dim] for dim in dims], dtype=np.int32)
    for region, reason in refused:
        mask[tuple(region[dim] for dim in dims)] = numbers[reason]
    return masked(data, xr.Variable(dims, mask), list(numbers))


def _given(array: xr.DataArray, like: xr.DataArray, shape: Sequence[int]) -> NDArray[Any]:
    """A factor's values over the dimensions of a coordinate."""
    dims = [dim for dim in like.dims if dim in array.dims]
    values = array.transpose(*dims).values.reshape([array.sizes.get(dim, 1) for dim in like.dims])
    return np.broadcast_to(values, shape).copy()


def masked(data: xr.Dataset, mask: xr.Variable, reasons: Sequence[str]) -> xr.Dataset:
    """Cases with a mask of those that are refused, and its reasons."""
    texts = np.array(reasons, dtype=str)
    return data.assign({REFUSAL: (mask.dims, mask.values, _MASK), REASON: ("reason", texts, _REASONS)})


def labelled(name: str, value: ArrayLike | xr.DataArray) -> xr.DataArray:
    """Values of a factor, along itself where they are a sequence."""
    return value if isinstance(value, xr.DataArray) else xr.DataArray(np.asarray(value), dims=(name,) * np.ndim(value))
