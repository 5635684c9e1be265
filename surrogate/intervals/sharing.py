"""Groups of held-out cases that share some inputs: the cases of a group count as one place of these inputs."""

import numpy as np

from approximation.arrays import Array, Indices


def sharing(t: Array) -> Indices:
    """Return the group of every case, (n,): cases share those coordinates, (d, n), that have at most n/2 values."""
    few = [row for row in t if len(np.unique(row)) <= t.shape[1] / 2]
    if not few:
        return np.arange(t.shape[1])
    return np.unique(np.stack(few), axis=1, return_inverse=True)[1].reshape(-1)


def places(t: Array, groups: Indices) -> Indices:
    """Return how many places the cases have along every input, (d,): the groups, where these share it, or the cases.

    t: (d, n), scaled coordinates of the cases; groups: (n,), the group of every case.
    """
    count, cases = len(np.unique(groups)), t.shape[1]
    return np.array([count if len(np.unique(row)) <= count else cases for row in t])
