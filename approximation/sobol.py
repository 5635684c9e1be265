"""Points of Sobol's sequence, which fill a cube evenly."""

import scipy  # scipy.stats, slow to import, when points are asked for

from approximation.arrays import Array


def sobol_points(count: int, dimension: int, seed: int | None = 0) -> Array:
    """The first points, of shape ``(count, dimension)``, in the unit cube; in [-1, 1]: twice them less one.

    Parameters
    ----------
    count, dimension : int
    seed
        Of Owen's scrambling; ``None`` leaves the sequence as Sobol gave it.

    Examples
    --------
    >>> sobol_points(4, 2, None)
    array([[0.  , 0.  ],
           [0.5 , 0.5 ],
           [0.75, 0.25],
           [0.25, 0.75]])
    """
    sequence = scipy.stats.qmc.Sobol(dimension, scramble=seed is not None, rng=seed)
    return sequence.random(count)
