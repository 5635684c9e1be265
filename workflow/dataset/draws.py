"""Random factors of cases: even, towards the ends of the box, and of a box that has grown those of before."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate import Input
from workflow.dataset.casecache import AT_A_TIME
from workflow.study.model import Study
from workflow.study.sections import Axis

#: How many random cases of films share the values for which the solver makes tables. A table costs 0.1 to 1 s, a case
#: 0.1 ms; but a sample with few tables tells little of these values.
TOGETHER = 10
#: Parameters of the beta distribution of shares of a range that are drawn towards its ends.
TOWARDS_ENDS = 0.3, 0.3

_Drawn = tuple[dict[str, xr.DataArray], np.ndarray[Any, np.dtype[np.int8]]]


def sample(study: Study, count: int, seed: Sequence[int], ends: bool) -> _Drawn:
    """Random factors of a sample over ``case``, and which are even: 1, those towards the ends of the box 0.

    Of a box that has grown, the sample of the earlier box gives as large a share of the cases as that box has of the
    volume, in whole pieces of the cache: these may have been solved. The other cases lie outside the earlier box.
    """
    smaller = before(study)
    if smaller is None:
        return _with_ends(study, points(study, count, seed), seed, ends)
    old, even = sample(smaller, count, seed, ends)
    shares = _shares(study, smaller)
    size = TOGETHER * (1 + ends) if study.tabled else AT_A_TIME
    taken = int(np.prod([high - low for low, high in shares.values()]) * even.size) // size * size
    further = _beyond(study, count - int(even[:taken].sum()), (*seed, 2), shares)
    new, new_even = _with_ends(study, further, (*seed, 3), ends)
    both = {name: xr.concat([old[name][:taken], new[name]], "case") for name in study.factors}
    return both, np.concatenate([even[:taken], new_even])


def before(study: Study) -> Study | None:
    """The study over the box that it has grown from; None where that is none or as large."""
    ends = {name: axis.grown_from or [axis.low, axis.high] for name, axis in study.factors.items()}
    axes = {
        name: axis.model_copy(update={"low": ends[name][0], "high": ends[name][1], "grown_from": None})
        for name, axis in study.factors.items()
    }
    same = all((axes[name].low, axes[name].high) == (axis.low, axis.high) for name, axis in study.factors.items())
    return None if same else study.model_copy(update={"factors": axes})


def _with_ends(study: Study, drawn: dict[str, xr.DataArray], seed: Sequence[int], ends: bool) -> _Drawn:
    if ends:
        return towards_ends(study, drawn, (*seed, 1))
    return drawn, np.ones(next(iter(drawn.values())).size, np.int8)


def _shares(study: Study, before: Study) -> dict[str, tuple[float, float]]:
    """Where the ends of the box of before lie, by factor, as shares of the range of now."""
    shares = {}
    for name, axis in study.factors.items():
        own, old = Input(name, axis.low, axis.high, axis.scale), before.factors[name]
        low, high = (float((own.to_unit(end) + 1) / 2) for end in (old.low, old.high))
        shares[name] = low, high
    return shares


def _beyond(
    study: Study, count: int, seed: Sequence[int], shares: Mapping[str, tuple[float, float]]
) -> dict[str, xr.DataArray]:
    """Random factors outside a part of the box; cases of films share the factors that need tables."""
    random = np.random.default_rng(list(seed))
    names, together = list(study.factors), TOGETHER if study.tabled else 1
    low, high = np.array(list(shares.values())).T
    shared = np.array([name in study.tabled for name in names])
    rows: list[Array] = []
    for _ in range(-(-count // together)):
        cases = np.empty((0, len(names)))
        while len(cases) < together:
            u = random.uniform(size=(together, len(names)))
            if len(cases):
                u[:, shared] = cases[0, shared]
            else:  # a place as likely as its cases beyond that part are
                u[1:, :] = u[0]
            beyond = ((u < low) | (u > high)).any(axis=1)
            cases = np.concatenate([cases, u[beyond] if len(cases) else u[beyond][:1]])
        rows.append(cases[:together])
    u = np.concatenate(rows)[:count].T
    return {
        name: xr.DataArray(_along(name, study.factors[name], own), dims="case")
        for name, own in zip(names, u, strict=True)
    }


def points(study: Study, count: int, seed: Sequence[int], together: int = TOGETHER) -> dict[str, xr.DataArray]:
    """Random factors over dimension ``case``, uniform in the axes' own scales.

    A factor that needs tables takes few values: its axis is cut into equal parts, and each value lies in one of them.
    """
    random = np.random.default_rng(list(seed))
    drawn: dict[str, xr.DataArray] = {}
    for name, axis in study.factors.items():
        u = random.uniform(size=count)
        if name in study.tabled and together > 1:
            places = -(-count // together)
            u = np.repeat((random.permutation(places) + u[:places]) / places, together)[:count]
        drawn[name] = xr.DataArray(_along(name, axis, u), dims="case")
    return drawn


def towards_ends(
    study: Study, drawn: Mapping[str, xr.DataArray], seed: Sequence[int]
) -> tuple[dict[str, xr.DataArray], np.ndarray[Any, np.dtype[np.int8]]]:
    """Random factors with as many again that lie towards the ends, and which of them are the former: 1, others 0.

    Groups have their ends in corners of the factors' box, which even cases hardly reach. Cases that share tables follow
    one another.
    """
    random = np.random.default_rng(list(seed))
    count = next(iter(drawn.values())).size
    tables = np.stack([drawn[name].values for name in study.tabled or study.factors])
    place = np.unique(tables, axis=1, return_index=True, return_inverse=True)[1:]
    order = np.argsort(np.tile(place[0][place[1].reshape(-1)], 2), kind="stable")  # as they came
    both = {}
    for name, axis in study.factors.items():
        u = random.beta(*TOWARDS_ENDS, size=count)
        values = drawn[name].values if name in study.tabled else _along(name, axis, u)
        both[name] = xr.DataArray(np.concatenate([drawn[name].values, values])[order], dims="case")
    return both, (order < count).astype(np.int8)


def _along(name: str, axis: Axis, u: Array) -> Array:
    """Values of a factor at shares of its range, in the scale of its axis."""
    if axis.scale == "log":
        values = axis.low * (axis.high / axis.low) ** u
    elif axis.scale == "logit":
        values = Input(name, axis.low, axis.high, axis.scale).from_unit(2 * u - 1)
    else:
        values = axis.low + (axis.high - axis.low) * u
    return np.clip(values, axis.low, axis.high)
