"""Share in contact of the cells that the edge of a contact cuts.

Near the edge the gap grows like c s^(3/2) with the distance s, so that -gap^(2/3) is linear outside and extends into
the contact. The edge where this vanishes has the radius of a Hertz contact to 0.02 cells on every grid.
"""

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray, Scalar

_SAMPLES = 8  # a side of a cell
_STEPS = tuple((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1))


def share_in_contact(gap: Array, pressed: BoolArray) -> Array:
    """Share of each cell that is in contact; (x, y).

    gap: between punch and surface [m], infinite beside the punch; pressed: cells in contact; (x, y) each.
    """
    air = np.isfinite(gap) & ~pressed
    near_air, near_contact = (np.logical_or.reduce(_around(mask)) for mask in (air, pressed))
    cells = near_air & near_contact & np.isfinite(gap)
    result = pressed.astype(float)
    if not np.any(cells):
        return result
    level = np.where(air, -(np.maximum(np.where(air, gap, 0.0), 0.0) ** (2 / 3)), 0.0)
    inside = float(np.max(-level, where=cells & air, initial=0.0))  # beyond the first cells in contact
    sums, counts = np.zeros_like(level), np.zeros_like(level)
    for i, j in _STEPS:
        if (i, j) != (0, 0):
            valid = _shifted(air, i, j) & _shifted(air, 2 * i, 2 * j)
            sums += np.where(valid, 2 * _shifted(level, i, j) - _shifted(level, 2 * i, 2 * j), 0.0)
            counts += valid
    extended = np.where(counts > 0, np.maximum(sums / np.maximum(counts, 1), 0.0), inside)
    level = np.where(air, level, np.where(pressed, extended, 0.0))
    around = np.stack([values[cells] for values in _around(level)], -1)
    result[cells] = np.mean(around @ _weights().T >= 0, axis=1)
    return result


def _around(values: NDArray[Scalar]) -> list[NDArray[Scalar]]:
    """Values of a cell and its eight neighbours, in the order of the steps; (x, y) each."""
    return [_shifted(values, i, j) for i, j in _STEPS]


def _shifted(values: NDArray[Scalar], i: int, j: int) -> NDArray[Scalar]:
    """Values of the cell i and j steps on, zero beyond the grid; (x, y)."""
    n, m = values.shape
    padded = np.pad(values, 2)
    return np.asarray(padded[2 + i : 2 + i + n, 2 + j : 2 + j + m])


def _weights() -> Array:
    """Bilinear interpolation from the cells around to samples within a cell; (sample, step)."""
    places = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
    hat = np.maximum(1 - np.abs(places[:, None] - np.array([-1, 0, 1])), 0)
    return np.asarray(np.einsum("ai,bj->abij", hat, hat).reshape(_SAMPLES**2, len(_STEPS)))
