"""netCDF files written block by block, so that a data set may be larger than the memory.

The file that `write_blocks` makes is one of `storage.netcdf`: it appears whole or not at all, has the same checksum
as if it had been written at once, and equal data give equal bytes.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import prod
from os import PathLike
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from storage.described import as_stored, standard
from storage.netcdf import (
    CHECKSUM,
    COMPRESS_FROM,
    PACKED,
    checksum_parts,
    combined,
    contents,
    encodings,
    finished,
    purpose,
    started,
)
from storage.sealed import appearing

#: Attributes that `write_blocks` adds to every variable.
STATISTICS = ("actual_range", "mean", "standard_deviation")
_PORTION = 2**15  # numbers that are summed up at a time, while they are near the processor

#: A region of an array: along every axis from where to where.
Region = tuple[slice, ...]


@dataclass
class RunningStatistics:
    """Extremes, mean and standard deviation of numbers that come in pieces (Chan, Golub and LeVeque 1979)."""

    count: int = 0
    mean: float = 0.0
    squares: float = 0.0
    low: float = np.inf
    high: float = -np.inf

    def add(self, values: NDArray[Any]) -> None:
        """Take further numbers in; ValueError if one is not finite."""
        flat = values.ravel()
        for begin in range(0, flat.size, _PORTION):
            part = flat[begin : begin + _PORTION]
            low, high = float(part.min()), float(part.max())
            if not (np.isfinite(low) and np.isfinite(high)):
                raise ValueError(f"not finite in {values.dtype}")
            exact = part.astype(np.float64)
            mean = float(exact.sum()) / part.size
            exact -= mean
            total, step = self.count + part.size, mean - self.mean
            self.squares += float(np.dot(exact, exact)) + step**2 * self.count * part.size / total
            self.mean += step * part.size / total
            self.low, self.high = min(self.low, low), max(self.high, high)
            self.count = total

    @property
    def attrs(self) -> dict[str, Any]:
        """Return the statistics as attributes of a variable; `actual_range` is CF's name, NaN without numbers."""
        if not self.count:
            return {"actual_range": [np.nan, np.nan], "mean": np.nan, "standard_deviation": np.nan}
        deviation = float(np.sqrt(max(self.squares, 0.0) / max(self.count, 1)))
        return {"actual_range": [self.low, self.high], "mean": self.mean, "standard_deviation": deviation}


@dataclass
class _Stored:
    """A variable of the file while it is written: what was summed up of it so far."""

    variable: "netCDF4.Variable[Any]"
    digest: Any
    statistics: RunningStatistics = field(default_factory=RunningStatistics)

    def put(self, region: Region, values: NDArray[Any]) -> None:
        """Write the values of the next region; ValueError if one is not finite."""
        with np.errstate(over="ignore"):  # what is not finite is named below
            values = np.ascontiguousarray(values, dtype=self.variable.dtype)
        try:
            self.statistics.add(values)
        except ValueError as error:
            raise ValueError(f"{self.variable.name}: {error}") from None
        self.variable[region] = values
        self.digest.update(contents(values))

    def completed(self, attrs: Mapping[Any, Any]) -> str:
        """Write the statistics of all values; the digest of the variable, which has further attributes."""
        count, size, statistics = self.statistics.count, self.variable.size, self.statistics.attrs
        statistics["actual_range"] = np.array(
            statistics["actual_range"], dtype=self.variable.dtype
        )  # CF asks for the same type
        if count != size:
            raise ValueError(f"{self.variable.name}: {count} of {size} values given")
        self.variable.setncatts(statistics)
        return finished(self.digest, {**attrs, **statistics})


def write_blocks(
    path: str | PathLike[str],
    frame: xr.Dataset,
    blocks: Iterable[tuple[Region, Mapping[str, NDArray[Any]]]],
    chunks: Mapping[str, int],
) -> None:
    """Write a data set to a netCDF-4 file in blocks, with statistics of every variable; it appears whole or not."""
    frame = as_stored(frame.drop_encoding())
    frame.attrs |= standard(frame) | purpose(Path(path))
    skeleton = frame.drop_vars(list(frame.data_vars))
    with appearing(Path(path), sealed=True) as partial:
        skeleton.to_netcdf(partial, format="NETCDF4", engine="netcdf4", encoding=encodings(skeleton))
        with netCDF4.Dataset(partial, "a") as file:
            for dim, size in frame.sizes.items():
                if dim not in file.dimensions:
                    file.createDimension(str(dim), size)
            stored = {str(name): _created(file, str(name), frame[name], chunks) for name in frame.data_vars}
            for region, values in blocks:
                for name, output in stored.items():
                    output.put(region, np.asarray(values[name]))
            digests = {name: output.completed(frame[name].attrs) for name, output in stored.items()}
            digests |= checksum_parts(skeleton)
            file.setncattr(CHECKSUM, combined(digests, frame.attrs))


def _created(file: netCDF4.Dataset, name: str, array: xr.DataArray, chunks: Mapping[str, int]) -> _Stored:
    sizes = [min(chunks.get(str(dim), size), size) for dim, size in array.sizes.items()]
    settings = PACKED if prod(sizes) >= COMPRESS_FROM // 4 else {}  # small chunks gain nothing
    dims = tuple(str(dim) for dim in array.dims)
    variable = file.createVariable(name, array.dtype, dims, chunksizes=sizes or None, fill_value=False, **settings)
    if sizes:  # room for one chunk: it is packed when it is complete, and not kept
        variable.set_var_chunk_cache(size=prod(sizes) * array.dtype.itemsize)
    variable.set_auto_maskandscale(False)
    variable.setncatts(array.attrs)
    return _Stored(variable, started(array.dims, array.shape, array.dtype))
