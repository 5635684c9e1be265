"""A dimension-adaptive sparse grid on Leja points, as a rival of cross approximations: values may be whole blocks.

T. Gerstner and M. Griebel, Computing 71 (2003) 65 (adaptation); A. Narayan and J. D. Jakeman, SIAM J. Sci. Comput. 36
(2014) A2952 (Leja points, one more a level, so that an index is a point). Tasmanian, which has such grids, comes from
PyPI as source only here, and was not built.
"""

from collections.abc import Callable

import numpy as np

from approximation.arrays import Array

_CANDIDATES, _LEVELS = np.linspace(-1, 1, 2001), 16  # of Leja points, and most along a dimension


def _leja(count: int) -> Array:
    """The first Leja points of [-1, 1], the middle first; (count,)."""
    points = [0.0]
    while len(points) < count:
        away = np.abs(np.subtract.outer(_CANDIDATES, points)).prod(axis=1)
        points.append(float(_CANDIDATES[away.argmax()]))
    return np.array(points[:count])


def basis(t: Array, points: Array) -> Array:
    """Newton's polynomials, each one at its own point and zero at those before; (count, B).

    t: (B,), places; points: (count,).
    """
    polynomials = np.ones((len(points), len(t)))
    for level in range(1, len(points)):
        before = points[:level, None]
        polynomials[level] = ((t - before) / (points[level] - before)).prod(axis=0)
    return polynomials


def sparse_grid(solve: Callable[[Array], Array], dimensions: int, most: int) -> Callable[[Array], Array]:
    """Learn a function from at most so many points, each where the surplus next to it is largest."""
    leja_points = _leja(_LEVELS)
    indices, surpluses, accepted = [(0,) * dimensions], [solve(np.zeros((1, dimensions)))[0]], set[int]()

    def at(t: Array) -> Array:
        along = [basis(row, leja_points) for row in t.T]
        table = np.array(indices)
        weights = np.prod([weight[table[:, k]] for k, weight in enumerate(along)], axis=0)
        return np.tensordot(weights.T, np.stack(surpluses), 1)

    while len(indices) < most:
        waiting = [k for k in range(len(indices)) if k not in accepted]
        best = max(waiting, key=lambda k: float(np.abs(surpluses[k]).max()))
        accepted.add(best)
        known, done = set(indices), {indices[k] for k in accepted}
        for k in range(dimensions):
            new = tuple(level + (axis == k) for axis, level in enumerate(indices[best]))
            below = [tuple(n - (axis == j) for axis, n in enumerate(new)) for j in range(dimensions) if new[j]]
            if max(new) < _LEVELS and new not in known and all(index in done for index in below):
                point = leja_points[list(new)][None]
                # a point of the same degree or more in all dimensions is no other's predecessor: surpluses stay
                surpluses.append(solve(point)[0] - at(point)[0])
                indices.append(new)
    return at
