"""The array types of the house, and blocks of them."""

from collections.abc import Iterator, Mapping
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


def columns_of(values: Mapping[Any, Any]) -> dict[Any, Any]:
    """Entries that are columns of one table (``pandas.Series``).

    Their values belong together row by row, so that two of them with unlike indices raise a ``ValueError``.
    """
    columns = {
        name: value
        for name, value in values.items()
        if hasattr(value, "to_numpy") and hasattr(value, "index") and not callable(value.index)
    }
    first = next(iter(columns), None)
    for name, column in columns.items():
        if not column.index.equals(columns[first].index):
            raise ValueError(
                f"{name}: its rows are not those of {first}: Series are columns of one table and share its index; "
                "plain lists span a grid"
            )
    return columns


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
