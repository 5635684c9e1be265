"""Gaps that a density draws shut next to an edge, where the gap's law has two solutions (theory section 10)."""

import numpy as np

from solver.arrays import Array

MOST = 3  # times at most that such a gap is opened


def reopened(densities: Array, gap: Array) -> Array:
    """Densities that are those of the first open place from there up to the edge, where the gap is closed next to it.

    A density that draws the gap shut solves the gap's law too, with a potential of the other sign: Newton's iteration
    may come to it, and from here comes to the contact whose gap is open.
    """
    closed = np.flatnonzero(gap <= 0)
    first = min(int(closed[-1]) + 1, gap.size - 1) if closed.size else 0
    return np.where(np.arange(gap.size) < first, densities[:, first][:, None], densities)
