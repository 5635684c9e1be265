"""The array types of the house, and blocks of them."""

from collections.abc import Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

#: Real numbers, in double precision.
Array: TypeAlias = NDArray[np.float64]
#: One flag a place.
Flags: TypeAlias = NDArray[np.bool_]
#: Whole numbers that say which.
Indices: TypeAlias = NDArray[np.intp]


def blocks(count: int, size: int) -> Iterator[slice]:
    """Yield the slices that cut so many places into blocks, the last of which may be shorter."""
    return (slice(start, start + size) for start in range(0, count, size))


def unmasked(values: Any) -> Any:
    """Return values with NaN, or None among texts and objects, in the cells that a masked array hides."""
    if isinstance(values, list | tuple):
        return [np.nan if value is np.ma.masked else value for value in values]
    if not isinstance(values, np.ma.MaskedArray):
        return values
    kind, missing = (np.float64, np.nan) if values.dtype.kind in "iuf" else (object, None)
    if not np.ma.is_masked(values):
        return values.data
    cells = values.data.astype(kind)
    cells[np.ma.getmaskarray(values)] = missing
    return cells
