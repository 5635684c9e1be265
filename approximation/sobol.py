"""Points of Sobol's sequence, which fill a cube evenly."""

import scipy  # scipy.stats, slow to import, when points are asked for

from approximation.arrays import Array


def sobol_points(count: int, dimension: int, seed: int | None = 0) -> Array:
    """The first points, of shape ``(count, dimension)``, in the unit cube; in [-1, 1]: twice them less one."""
    sequence = scipy.stats.qmc.Sobol(dimension, scramble=seed is not None, rng=seed)
    return sequence.random(count)
