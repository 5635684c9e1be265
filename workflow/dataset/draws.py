"""Random factors of cases: spread evenly over the box, or towards its ends."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate import Input
from workflow.study.model import Study
from workflow.study.sections import Axis

#: Random cases of films that share the values of a table: a table costs 0.1 to 1 s and a case 0.1 ms, but few tables
#: make a poor sample of these values.
TOGETHER = 10
#: Parameters of the beta distribution by which shares of a range are drawn towards its ends.
TOWARDS_ENDS = 0.3, 0.3


def points(study: Study, count: int, seed: Sequence[int], together: int = TOGETHER) -> dict[str, xr.DataArray]:
    """Return random factors over ``case``, uniform on their scales; few values of those that need tables."""
    random = np.random.default_rng(list(seed))
    drawn: dict[str, xr.DataArray] = {}
    for name, axis in study.factors.items():
        u = random.uniform(size=count)
        if name in study.tabled and together > 1:
            places = -(-count // together)
            u = np.repeat((random.permutation(places) + u[:places]) / places, together)[:count]
        drawn[name] = xr.DataArray(_along(name, axis, u), dims="case")
    return drawn


def sample(
    study: Study, count: int, seed: Sequence[int], ends: bool
) -> tuple[dict[str, xr.DataArray], np.ndarray[Any, np.dtype[np.int8]]]:
    """Return random factors over ``case``, and 1 for even ones; with `ends`, as many again towards the ends: 0."""
    drawn = points(study, count, seed)
    if not ends:
        return drawn, np.ones(count, np.int8)
    # groups end in corners of the factors' box, which even cases hardly reach
    random = np.random.default_rng([*seed, 1])
    tables = np.stack([drawn[name].values for name in study.tabled or study.factors])
    place = np.unique(tables, axis=1, return_index=True, return_inverse=True)[1:]
    order = np.argsort(np.tile(place[0][place[1].reshape(-1)], 2), kind="stable")  # cases that share tables together
    for name, axis in study.factors.items():
        u, even = random.beta(*TOWARDS_ENDS, size=count), drawn[name].values
        values = even if name in study.tabled else _along(name, axis, u)
        drawn[name] = xr.DataArray(np.concatenate([even, values])[order], dims="case")
    return drawn, (order < count).astype(np.int8)


def _along(name: str, axis: Axis, u: Array) -> Array:
    """Return the values of a factor at shares of its range, in the scale of its axis."""
    return np.clip(Input(name, axis.low, axis.high, axis.scale).from_unit(2 * u - 1), axis.low, axis.high)
