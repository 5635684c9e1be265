"""The array types of the house, and blocks of them."""

from collections.abc import Iterator
from typing import TypeAlias

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
