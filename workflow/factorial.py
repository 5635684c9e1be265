"""The factorial of a study: its axes, its slabs of exact cases, and random cases in the same box."""

import os
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver import solve
from solver.names import FACTORS
from surrogate import Input, chebyshev_levels
from workflow import categories
from workflow.study import Study

#: What a job that solves a slab takes at most, whatever its size [MB].
SLAB_MEMORY = 1500

#: Samples of random exact cases: what each is for, the number of its seed, and the key of its size.
SAMPLES = {"validation": (0, "cases"), "calibration": (2, "calibration")}


#: Slabs of a study whose first axis is open, at most and if it does not say: `choice.choose` gives it as many levels.
MOST_SLABS, USUAL_SLABS = 8, 4


def inputs(study: Study) -> list[Input]:
    """The factorial's axes as inputs of a surrogate."""
    return [
        Input(name, axis.low, axis.high, axis.scale, FACTORS[name].units, FACTORS[name].long_name)
        for name, axis in study.factors.items()
    ]


def axes(study: Study) -> dict[str, np.ndarray[Any, np.dtype[Any]]]:
    """Axes of the data set: the levels of every factor, then the names of every category."""
    return levels(study) | {name: np.array(names) for name, names in study.categories.items()}


def learned(study: Study, data: xr.Dataset) -> xr.Dataset:
    """Cases of the study as the surrogate learns them: every output over the continuous factors or ``case`` alone."""
    return categories.apart(data, study.categories, study.outputs)


def levels(study: Study) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
    """Levels of every axis of a study without open ones."""
    return {
        name: chebyshev_levels(axis.low, axis.high, axis.levels or 0, axis.scale)
        for name, axis in study.factors.items()
    }


def slab_count(study: Study) -> int:
    """Number of slabs: what the study asks for, or one for each job that cores and memory let run at once.

    At most one a level of the first axis. The cores and the memory are this machine's (or what the process may use);
    on a cluster the study should say it.
    """
    first = next(iter(study.factors.values()), None)
    if first is None:
        return 0
    if first.levels is None:  # its levels follow from the slabs, and must not from the machine
        return min(study.dataset.slabs or USUAL_SLABS, MOST_SLABS)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20
    at_once = min(len(os.sched_getaffinity(0)), memory // SLAB_MEMORY)
    return min(study.dataset.slabs or max(1, at_once), first.levels)


def cases(study: Study, name: str) -> xr.Dataset:
    """Random exact cases of one of `SAMPLES`, over dimension ``case`` and the categories."""
    number, key = SAMPLES[name]
    return sample(study, getattr(study.validation, key), (study.validation.seed, number))


def sample(study: Study, count: int, seed: Sequence[int]) -> xr.Dataset:
    """Random cases, uniform in the axes' own scales; exact quantities over dimension ``case`` and the categories."""
    random = np.random.default_rng(list(seed))
    points: dict[str, xr.DataArray] = {}
    for name, axis in study.factors.items():
        u = random.uniform(size=count)
        if axis.scale == "log":
            values = axis.low * (axis.high / axis.low) ** u
        else:
            values = axis.low + (axis.high - axis.low) * u
        points[name] = xr.DataArray(np.clip(values, axis.low, axis.high), dims="case")
    return exact(study, points)


def exact(
    study: Study,
    axes: dict[str, Any],
    positions: Iterable[float] | None = None,
    *,
    peaks: bool | None = None,
    regular: bool = False,
) -> xr.Dataset:
    """The exact solver at some values of the factorial's factors, for every category and the study's fixed factors.

    With the largest stresses of the body where ``peaks``, by default where the data set has them; with the regular
    parts of the surface fields where ``regular``.
    """
    return solve(
        {**study.fixed, **axes, **{name: names for name, names in study.categories.items() if name not in axes}},
        positions,
        materials=study.own_materials,
        phases=study.phases,
        peaks=study.dataset.peaks if peaks is None else peaks,
        regular=regular,
    )
