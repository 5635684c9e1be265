"""Array types of all rooms, slices in blocks, and the values of table columns and masked arrays."""

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]
Indices: TypeAlias = NDArray[np.intp]


def blocks(count: int, size: int) -> Iterator[slice]:
    """Yield slices that cut `count` indices into blocks of `size`; the last block may be shorter."""
    return (slice(start, start + size) for start in range(0, count, size))


def columns_of(values: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return the entries that are columns of one table (``pandas.Series``); ValueError unless they share an index."""
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
