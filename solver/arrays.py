"""The array type of the room, and the two small operations that every module needs."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]


def dot(one: Array, two: Array) -> Array:
    """Sum of products over the last axis."""
    return np.asarray(np.einsum("...i,...i", one, two))


def column(values: Array) -> Array:
    """Values of the case axes (...) as (..., 1, 1), to multiply matrices."""
    return values[..., None, None]
