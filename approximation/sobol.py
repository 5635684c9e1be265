"""Sobol' sequences, whose points fill a cube evenly."""

import scipy  # scipy.stats, slow to import, when points are asked for

from approximation.arrays import Array


def sobol_points(count: int, dimension: int, seed: int | None = 0) -> Array:
    """Return the first points of a Sobol' sequence in the unit cube, (count, dimension); no seed: not scrambled."""
    sequence = scipy.stats.qmc.Sobol(dimension, scramble=seed is not None, rng=seed)
    return sequence.random(count)
