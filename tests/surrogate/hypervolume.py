"""Area that a Pareto front dominates, to compare two fronts."""

import numpy as np

from approximation.arrays import Array
from surrogate.search.pareto import non_dominated


def hypervolume(values: Array, reference: Array) -> float:
    """Area that a front of two objectives (m, 2) dominates beyond a reference (2,)."""
    inside = values[np.all(values > reference, axis=1)]
    inside = inside[non_dominated(inside)]
    inside = inside[np.argsort(-inside[:, 0])]
    seconds = np.concatenate([[reference[1]], inside[:, 1]])
    return float(np.sum((inside[:, 0] - reference[0]) * np.diff(seconds)))
