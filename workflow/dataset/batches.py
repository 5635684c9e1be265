"""Batches of cases for a cross approximation: places of the crossed axes, with a block of cases at each."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from tqdm.auto import tqdm

from storage.blocks import write_blocks
from storage.described import described
from storage.netcdf import read_whole, write_whole
from surrogate.data.meanings import MEANINGS, SOURCE
from workflow.dataset import factorial
from workflow.dataset.casecache import CaseCache
from workflow.run.joblog import log
from workflow.study import partition
from workflow.study.model import Study

#: The dimension of the places.
PLACE = "place"
_AT_A_TIME = 8  # places that are solved and written at once
_CASES = 4096  # cases that are solved at once where places need no tables


def write_places(study: Study, places: xr.Dataset, path: Path) -> None:
    """Write the places of a batch, or the final error of the approximation."""
    title = "places at which a cross approximation asks for all cases, or in the end its error"
    write_whole(described(places, title, SOURCE, MEANINGS), path)
    count = places.sizes.get(PLACE, 0)
    log.info("%d places, %d cases", count, count * study.block)


def slabs(study: Study, path: str | Path) -> int:
    """Return the number of slabs of the batch in a file of places; 0 of the last, which is empty."""
    return min(partition.count(study), read_whole(Path(path)).sizes.get(PLACE, 0))


def write_slab(study: Study, path_of_places: Path, index: int, path: Path, cache: CaseCache | None = None) -> None:
    """Solve a slab of a batch exactly, and write its quantities."""
    batch = read_whole(path_of_places)
    part = np.array_split(np.arange(batch.sizes[PLACE]), slabs(study, path_of_places))[index]
    count = part.size
    with tqdm(total=count, desc=f"slab {index + 1}", unit=" places", disable=None, leave=False) as bar:
        parts, batch_size = [], _AT_A_TIME if study.tabled else max(1, _CASES // study.block)
        for start in range(0, count, batch_size):
            parts.append(exact(study, batch.isel({PLACE: part[start : start + batch_size]}), cache))
            bar.update(parts[-1].sizes[PLACE])
    whole = joined(parts)
    values = {str(name): array.values for name, array in whole.data_vars.items()}
    region = tuple(slice(0, size) for size in next(iter(values.values())).shape)
    write_blocks(path, whole, [(region, values)], {PLACE: _AT_A_TIME})
    log.info("slab %d: %d places, %d cases", index + 1, count, count * study.block)


def exact(study: Study, places: xr.Dataset, cache: CaseCache | None = None) -> xr.Dataset:
    """Return exact quantities over places of the crossed axes and all levels of the others."""
    levels = {name: values for name, values in factorial.axes(study).items() if name not in study.crossed}
    crossed = {name: xr.DataArray(places[name].variable) for name in study.crossed}
    solved = factorial.exact(study, {**crossed, **levels}, cache=cache)
    whole = xr.broadcast(solved[study.quantities])[0].transpose(PLACE, *levels)
    return whole.reset_coords(drop=True).assign_coords({name: solved[name] for name in (*study.crossed, *levels)})


def joined(parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return cases of several places in one data set."""
    return xr.concat(parts, PLACE, data_vars="all", coords="minimal", compat="override", join="override")
