"""The array types of the house."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

#: Real numbers, in double precision.
Array: TypeAlias = NDArray[np.float64]
#: One flag a place.
Flags: TypeAlias = NDArray[np.bool_]
#: Whole numbers that say which.
Indices: TypeAlias = NDArray[np.intp]
