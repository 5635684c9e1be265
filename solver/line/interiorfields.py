"""Fields inside films of any thickness and their bases, in blocks of cases and points: bounded memory."""

from collections.abc import Iterator

import numpy as np

from solver.arrays import Array
from solver.halfplane.potentials import POTENTIALS
from solver.line.interior import fields_of
from solver.line.similar import Films
from solver.line.windows import traction_window

_ALONG, _POINTS = 256, 4096  # positions along x, and points, at a time
_VALUES = 1 << 16  # points times cases at a time


def interior_fields(films: Films, x: Array, y: Array, names: tuple[str, ...]) -> Array:
    """Fields of ``LINEAR`` and potentials at ((x - c)/h, y/h), NaN in a rigid base; (case, field, y, x)."""
    blocks = list(in_blocks(x, y))
    together = max(_VALUES // (y[blocks[0][0]].size * x[blocks[0][1]].size), 1)
    out = np.empty((films.load.size, len(names), y.size, x.size))
    for places, number, contact in films.parts:
        tractions = traction_window(films.kind, number).read(contact)
        datum = np.broadcast_to(contact.datum, places.shape)
        for start in range(0, places.size, together):
            block = slice(start, start + together)
            for rows, columns in blocks:
                values = fields_of(tractions.part(block), x[columns], y[rows], names, datum[block])
                out[places[block], :, rows, columns] = values
    for number, name in enumerate(names):
        if name in POTENTIALS:
            out[:, number] *= films.thickness[:, None, None]
    return out


def in_blocks(x: Array, y: Array) -> Iterator[tuple[slice, slice]]:
    """Yield rows and columns of a grid of places x, (x,), and y, (y,), some at a time."""
    across = min(x.size, _ALONG)
    down = min(y.size, max(_POINTS // across, 1))
    for first in range(0, y.size, down):
        for left in range(0, x.size, across):
            yield slice(first, first + down), slice(left, left + across)
