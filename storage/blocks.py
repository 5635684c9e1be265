"""netCDF files of `storage.netcdf`, with the same checksum, written in blocks: data may be larger than the memory."""

from collections.abc import Iterable, Mapping, Sequence
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
Region = tuple[slice, ...]  # of an array, one slice an axis


def pooled(counts: Sequence[int], parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the statistics of all numbers from those of their parts, NaN without numbers; CF names `actual_range`."""
    if not any(counts):
        return dict(zip(STATISTICS, ([np.nan, np.nan], np.nan, np.nan), strict=True))
    lows, highs = np.transpose([part["actual_range"] for part in parts])
    means, deviations = np.transpose([[part["mean"], part["standard_deviation"]] for part in parts])
    mean = float(np.average(means, weights=counts))
    variance = float(np.average(deviations**2 + (means - mean) ** 2, weights=counts))
    return dict(zip(STATISTICS, ([float(lows.min()), float(highs.max())], mean, variance**0.5), strict=True))


@dataclass
class _Stored:
    """A variable while it is written, with the number of values and their statistics by region."""

    variable: "netCDF4.Variable[Any]"
    digest: Any
    counts: list[int] = field(default_factory=list)
    statistics: list[dict[str, Any]] = field(default_factory=list)

    def put(self, region: Region, values: NDArray[Any]) -> None:
        """Write the values of the next region; ValueError if one is not finite."""
        with np.errstate(over="ignore"):  # an overflow is refused below
            values = np.ascontiguousarray(values, dtype=self.variable.dtype)
            exact = values.astype(np.float64)
            if exact.size:
                ends = [exact.min(), exact.max()]
                if not np.isfinite(ends).all():
                    raise ValueError(f"{self.variable.name}: not finite in {values.dtype}")
                self.counts.append(exact.size)
                self.statistics.append(dict(zip(STATISTICS, (ends, exact.mean(), exact.std()), strict=True)))
        self.variable[region] = values
        self.digest.update(contents(values))

    def completed(self, attrs: Mapping[Any, Any]) -> str:
        """Write the statistics of all values and return the digest of the variable, with further attributes."""
        if sum(self.counts) != self.variable.size:
            raise ValueError(f"{self.variable.name}: {sum(self.counts)} of {self.variable.size} values given")
        statistics = pooled(self.counts, self.statistics)
        # CF asks for the same type
        statistics["actual_range"] = np.array(statistics["actual_range"], dtype=self.variable.dtype)
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
