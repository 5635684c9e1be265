"""The data set of a study on disk: slabs that are written block by block, and opened lazily as one.

A block is part of one level of the first axis, so that neither memory nor results depend on the number of slabs.
"""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import ceil, prod
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray
from tqdm.auto import tqdm
from xarray.backends import BackendArray
from xarray.core import indexing

from solver.curves import REGIONS
from solver.fields import ACROSS, ALONG, EVERY_FIELD, FIELDS
from solver.names import ALL_QUANTITIES
from storage.blocks import STATISTICS, Region, write_blocks
from storage.netcdf import MAX_BYTES, read_whole
from storage.sealed import check_seal
from workflow.dataset import factorial
from workflow.dataset.casecache import CaseCache
from workflow.run.joblog import log
from workflow.study import partition
from workflow.study.model import Study

CARD = "datacard.json"
_FIELD_VALUES = 2**20  # values of a field that are solved at a time: some twenty temporaries of 8 MiB
_CHUNK_CASES, _CHUNK_POSITIONS = 2**14, 16


def write_slab(study: Study, index: int, path: Path, cache: CaseCache | None = None) -> None:
    """Solve one slab of the factorial exactly and write it, with progress on a terminal."""
    axes = factorial.axes(study)
    first = next(iter(axes))
    axes[first] = np.array_split(axes[first], partition.count(study))[index]
    positions = study.dataset.positions.values() if study.stores_fields else None
    points = max([study.dataset.positions.count, *(REGIONS[name].panels.size for name in study.regions)])
    lengths, block = [levels.size for levels in axes.values()], max(1, _FIELD_VALUES // points)
    chunk = chunk_lengths(lengths, min(block, _CHUNK_CASES))
    regions = list(block_regions(lengths, chunk, block))
    name = f"slab {index + 1} of {partition.count(study)}"
    cases = prod(levels.size for levels in axes.values())

    def part(region: Region) -> xr.Dataset:
        axes_of_part = {
            axis: levels[part_slice] for (axis, levels), part_slice in zip(axes.items(), region, strict=True)
        }
        return factorial.exact(study, axes_of_part, positions, curves=True, cache=cache)

    def blocks() -> Iterator[tuple[Region, Mapping[str, NDArray[Any]]]]:
        with tqdm(total=cases, desc=name, unit=" cases", disable=None, leave=False) as bar:
            for region in regions:
                yield region, {str(name): array.values for name, array in part(region).data_vars.items()}
                bar.update(prod(part_slice.stop - part_slice.start for part_slice in region))

    one_case = {axis: levels if axis in study.categories else levels[:1] for axis, levels in axes.items()}
    frame = _frame(factorial.exact(study, one_case, positions, curves=True), axes, study.dataset.precision)
    chunks = {"position": _CHUNK_POSITIONS, **dict(zip(axes, chunk, strict=True))}
    write_blocks(path, frame, blocks(), chunks)
    log.info("%s: %d cases of %d", name, cases, study.cases)


def _frame(case: xr.Dataset, axes: Mapping[str, NDArray[np.float64]], precision: str) -> xr.Dataset:
    """Return a slab without its values: coordinates, attributes, dimensions and types."""
    coords = {axis: xr.Variable(axis, levels, case[axis].attrs) for axis, levels in axes.items()}
    # along the first level of every axis, factors of groups stand there as arrays of one
    scalar_coordinates = {
        name: coordinate
        for name, coordinate in case.coords.items()
        if axes.keys().isdisjoint(map(str, coordinate.dims))
    }
    frame = xr.Dataset(coords=scalar_coordinates).assign_coords(coords)
    empty = {}
    for name, array in case.data_vars.items():
        zero = np.zeros((), precision if array.ndim > len(axes) else array.dtype)
        shape = [frame.sizes[dim] for dim in array.dims]
        empty[name] = (array.dims, np.broadcast_to(zero, shape), array.attrs)
    return frame.assign(empty).assign_attrs(case.attrs)


def chunk_lengths(lengths: Sequence[int], cases: int) -> list[int]:
    """Return the length of a chunk along every axis."""
    split, most = _split(lengths, cases)
    length = lengths[split]
    divisor = max(part for part in range(1, most + 1) if length % part == 0)
    # chunks divide the axis, unless they were shorter than half of the allowed length
    part = divisor if 2 * divisor >= most else _about_equal(length, most)
    return [*([1] * split), part, *lengths[split + 1 :]]


def block_regions(lengths: Sequence[int], chunk: Sequence[int], cases: int) -> Iterator[Region]:
    """Yield blocks of whole chunks in C order, each within one level of the first axis; chunks are compressed once."""
    split, most = _split(lengths, cases)
    step = chunk[split] * _about_equal(ceil(lengths[split] / chunk[split]), max(1, most // chunk[split]))
    for leading in product(*(range(length) for length in lengths[:split])):
        for begin in range(0, lengths[split], step):
            part = slice(begin, min(begin + step, lengths[split]))
            whole = (slice(0, length) for length in lengths[split + 1 :])
            yield (*(slice(place, place + 1) for place in leading), part, *whole)


def _split(lengths: Sequence[int], cases: int) -> tuple[int, int]:
    """Return the axis that is split, so that later ones stay whole, and the levels of it in so many cases."""
    split = next(k for k in range(1, len(lengths) + 1) if prod(lengths[k:]) <= cases) - 1
    return split, max(1, cases // prod(lengths[split + 1 :])) if split else 1


def _about_equal(length: int, most: int) -> int:
    """Return the size of the largest of as few, about equal pieces as possible."""
    return ceil(length / ceil(length / most))


def open_results(folder: str | os.PathLike[str]) -> xr.Dataset:
    """Open the data set of a study: every quantity in memory, every surface field left on disk until it is asked for.

    Parameters
    ----------
    folder
        ``results/<study>``.

    Returns
    -------
    xarray.Dataset
        Quantities over the factors (what a cross approximation has asked for: over ``place`` and those that it does
        not cross), fields, where the study stores them, over these and ``position``, with units and statistics as
        attributes.
        Selecting (``isel``, ``sel``) reads nothing; ``load``, ``values`` and arithmetic read what was selected.

    Raises
    ------
    FileNotFoundError
        The study has not been run.
    FormatError
        A file is incomplete, altered or not of this program.
    """
    folder = Path(folder)
    card = json.loads((folder / CARD).read_text(encoding="utf-8"))
    whole = read_whole(folder / "quantities.nc")
    dims = [*whole[next(iter(whole.data_vars))].dims, "position"]
    if not card["positions"]:  # of a study that stores no fields
        return whole
    place = ALONG if FIELDS.keys() <= card["variables"].keys() else ACROSS
    whole = whole.assign_coords(position=xr.Variable("position", card["positions"], place))
    files = [folder / file["name"] for file in card["files"]]
    for name, described in card["variables"].items():
        if name in EVERY_FIELD:
            shape = tuple(whole.sizes[dim] for dim in dims)
            stacked = Stacked(name, files, [file["levels"] for file in card["files"]], shape, described["type"])
            whole[name] = xr.Variable(dims, indexing.LazilyIndexedArray(stacked), described["attributes"])
        elif name in whole:
            whole[name].attrs.update(described["attributes"])
    return whole


class Stacked(BackendArray):
    """A variable in several files along its first axis, which is read when it is indexed."""

    def __init__(
        self, name: str, files: Sequence[Path], levels: Sequence[int], shape: tuple[int, ...], dtype: str
    ) -> None:
        self.name, self.files, self.shape, self.dtype = name, list(files), shape, np.dtype(dtype)
        self.starts = np.concatenate([[0], np.cumsum(levels)])

    def __getitem__(self, key: indexing.ExplicitIndexer) -> NDArray[Any]:
        """Return the values of an orthogonal selection."""
        return np.asarray(
            indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._selected)
        )

    def _selected(self, key: tuple[Any, ...]) -> NDArray[Any]:
        first, *selection = key
        wanted = np.atleast_1d(np.arange(self.shape[0])[first])
        parts = []
        file_numbers = np.searchsorted(self.starts, wanted, side="right") - 1
        changes = np.flatnonzero(np.diff(file_numbers)) + 1
        for levels, numbers in zip(np.split(wanted, changes), np.split(file_numbers, changes), strict=True):
            if levels.size:
                parts.append(self._read(int(numbers[0]), levels - self.starts[numbers[0]], selection))
        whole = np.concatenate(parts) if parts else np.empty((0, *self.shape[1:]), self.dtype)[(slice(0), *selection)]
        return whole[0] if isinstance(first, int | np.integer) else whole

    def _read(self, number: int, levels: NDArray[np.int64], selection: Sequence[Any]) -> NDArray[Any]:
        check_seal(self.files[number], MAX_BYTES, digest=False)
        with netCDF4.Dataset(self.files[number], "r") as file:
            file.set_auto_maskandscale(False)
            return np.stack([np.asarray(file[self.name][(int(level), *selection)]) for level in levels])


def gather(slabs: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return the quantities of the whole factorial from its slabs, without the statistics of each slab."""
    names = [name for name in ALL_QUANTITIES if name in slabs[0]]
    whole = xr.concat([part[names] for part in slabs], dim=str(slabs[0][names[0]].dims[0]))
    for array in whole.data_vars.values():
        array.attrs = {key: value for key, value in array.attrs.items() if key not in STATISTICS}
    return whole
