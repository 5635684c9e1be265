"""Holes of a data set: cases that the solver refuses, which are left out, counted and told."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Flags
from storage.blocks import Region
from workflow.study.refusals import MOST, REASON, REFUSAL, AllRefusedError, HolesError, masked


class Mask:
    """Refused cases of a slab with their reasons, collected block by block."""

    def __init__(self, axes: Mapping[str, NDArray[Any]], most: float) -> None:
        self.axes, self.most, self.count = list(axes), most, 0
        self._sizes = [levels.size for levels in axes.values()]
        self._refused: list[tuple[Region, NDArray[np.int32]]] = []
        self._numbers: dict[str, int] = {}

    @property
    def left(self) -> float:
        """Number of cases that may still be refused."""
        return self.most - self.count

    def values(self, region: Region, solved: Callable[[], xr.Dataset], frame: xr.Dataset) -> dict[str, NDArray[Any]]:
        """Values of the solved cases of a region for the frame's variables, masked where the solver refuses."""
        try:
            answered: xr.Dataset = solved()
        except AllRefusedError as error:
            answered = error.mask
        except HolesError as error:
            raise self._too_many(str(error)) from None
        if REFUSAL not in answered:
            return {str(name): array.values for name, array in answered.data_vars.items()}
        codes = _renumbered(answered, self._numbers, self.axes)
        self._refused.append((region, codes))
        self.count += int(np.count_nonzero(codes))
        if self.left < 0:
            raise self._too_many(str(answered[REASON].values[0]))
        values: dict[str, NDArray[Any]] = {}
        for name, array in frame.data_vars.items():
            shape = (*codes.shape, *array.shape[codes.ndim :])
            missing = np.broadcast_to(codes.reshape(codes.shape + (1,) * (len(shape) - codes.ndim)) > 0, shape)
            solved_values = answered[name].values if name in answered else np.full(shape, np.nan)
            values[str(name)] = np.ma.masked_array(solved_values, missing)
        return values

    def _too_many(self, reason: str) -> HolesError:
        return HolesError(f"more than {100 * MOST:.0f} % of all cases are refused: {reason}")

    def stored(self) -> xr.Dataset:
        """The mask and its reasons for the slab's file; nothing where no case is refused."""
        if not self.count:
            return xr.Dataset()
        whole = np.zeros(self._sizes, dtype=np.int32)
        for region, codes in self._refused:
            whole[region] = codes
        return masked(xr.Dataset(), xr.Variable(self.axes, whole), list(self._numbers))


def refused(data: xr.Dataset, axes: Sequence[str]) -> Flags:
    """Return the mask of places that are refused in any category, over `axes`."""
    if REFUSAL not in data:
        return np.zeros([data.sizes[name] for name in axes], dtype=bool)
    mask = data[REFUSAL] > 0
    return np.asarray(mask.any([dim for dim in mask.dims if dim not in axes]).transpose(*axes).values)


def reasons(data: xr.Dataset, axes: Sequence[str]) -> list[str]:
    """Why every place that `refused` tells is refused, in their order: the reason of one of its categories."""
    if REFUSAL not in data:
        return []
    mask = data[REFUSAL]
    first = mask.max([dim for dim in mask.dims if dim not in axes]).transpose(*axes).values
    return [str(data[REASON].values[number - 1]) for number in first[first > 0]]


def joined(parts: Sequence[xr.Dataset], dim: str) -> xr.Dataset:
    """Parts of a data set one after the other along a dimension, with one mask where any of them has one."""
    plain = [part.drop_vars([REFUSAL, REASON], errors="ignore") for part in parts]
    whole = xr.concat(plain, dim=dim)
    if not any(REFUSAL in part for part in parts):
        return whole
    numbers: dict[str, int] = {}
    dims = [str(axis) for axis in next(part[REFUSAL].dims for part in parts if REFUSAL in part)]
    masks = [
        _renumbered(part, numbers, dims)
        if REFUSAL in part
        else np.zeros([part.sizes[axis] for axis in dims], dtype=np.int32)
        for part in parts
    ]
    return masked(whole, xr.Variable(dims, np.concatenate(masks, axis=dims.index(dim))), list(numbers))


def _renumbered(data: xr.Dataset, numbers: dict[str, int], dims: Sequence[str]) -> NDArray[np.int32]:
    """The mask of some cases over some dimensions, by the numbers that reasons have; new ones get the next."""
    codes = [numbers.setdefault(str(text), len(numbers) + 1) for text in data[REASON].values]
    return np.asarray(np.array([0, *codes], dtype=np.int32)[data[REFUSAL].transpose(*dims).values])


def check(data: xr.Dataset, axes: Sequence[str]) -> None:
    """Refuse a factorial that lacks too many of its places."""
    missing = refused(data, axes)
    if missing.mean() > MOST:
        raise HolesError(
            _told(int(missing.sum()), missing.size, _common(data)) + f"; at most {100 * MOST:.0f} % may be"
        )


def summary(data: xr.Dataset, axes: Sequence[str]) -> dict[str, Any]:
    """Holes as plain data: number of refused cases, their levels, and every reason with its cases."""
    missing = refused(data, axes)
    ends = {
        name: [float(end) for end in (levels.min(), levels.max())]
        for name, places in zip(axes, np.nonzero(missing), strict=True)
        for levels in [data[name].values[places]]
    }
    counts = np.bincount(data[REFUSAL].values.ravel(), minlength=data[REASON].size + 1)[1:]
    where = ", ".join(
        f"{name} {low:.4g} to {high:.4g}"
        for name, (low, high) in ends.items()
        if [low, high] != [data[name].values.min(), data[name].values.max()]
    )
    words = _told(int(missing.sum()), missing.size, _common(data))
    return {
        "places": int(missing.sum()),
        "of": missing.size,
        "between": ends,
        "reasons": {str(text): int(count) for text, count in zip(data[REASON].values, counts, strict=True)},
        "told": f"{words}; they lie within {where}" if where else words,
    }


def _told(count: int, total: int, reason: str) -> str:
    """Report the number of refused places and the reason."""
    return f"{count:,} of {total:,} places ({100 * count / total:.2g} %) are refused: {reason}"


def _common(data: xr.Dataset) -> str:
    """The reason of most refused cases."""
    counts = np.bincount(data[REFUSAL].values.ravel(), minlength=data[REASON].size + 1)[1:]
    return str(data[REASON].values[int(counts.argmax())])
