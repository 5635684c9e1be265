"""Fields along the surface of films of any thickness, in blocks of cases and positions: bounded memory."""

from functools import lru_cache

import numpy as np

from solver.arrays import Array
from solver.fields import FIELDS
from solver.film.similar import Films
from solver.film.surface import SurfaceTable
from solver.film.windows import Kind, window

_POSITIONS = 512  # at a time
_VALUES = 1 << 17  # positions times cases at a time
_TABLES = 32  # kept: 2 MB each at most


@lru_cache(_TABLES)
def _surface_window(kind: Kind, number: int, positions: tuple[float, ...]) -> SurfaceTable:
    return SurfaceTable(window(kind, number), np.array(positions))


def fields(films: Films, positions: Array) -> dict[str, Array]:
    """Fields of ``solver.fields.FIELDS``; (case, position) each.

    Parameters
    ----------
    films : Films, the cases
    positions : ndarray, shape (position,), X = (x - c)/h, finite and never exactly +-1
    """
    count = films.load.size
    out = {name: np.empty((count, positions.size)) for name in FIELDS}
    block = _VALUES // min(positions.size, _POSITIONS)
    for start in range(0, count, block):
        part = films.part(slice(start, start + block))
        for first in range(0, positions.size, _POSITIONS):
            X = positions[first : first + _POSITIONS]
            for places, number, contact in part.parts:
                found = _surface_window(films.kind, number, tuple(X.tolist())).fields(contact)
                for name, values in out.items():
                    values[np.ix_(start + places, np.arange(first, first + X.size))] = getattr(found, name)
    return out
