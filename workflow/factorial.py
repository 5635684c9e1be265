"""The factorial of a study: its axes, its slabs of exact cases, and random cases in the same box."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr
from tqdm import tqdm

from solver import solve
from solver.names import EVERY_QUANTITY, FACTORS, FIELDS
from surrogate import Input, chebyshev_levels
from workflow.joblog import log
from workflow.study import Study

#: Samples of random exact cases: what each is for, the number of its seed, and the key of its size.
SAMPLES = {"validation": (0, "cases"), "calibration": (2, "calibration")}


def inputs(study: Study) -> list[Input]:
    """The factorial's axes as inputs of a surrogate."""
    return [
        Input(name, axis.low, axis.high, axis.scale, FACTORS[name].units, FACTORS[name].long_name)
        for name, axis in study.factors.items()
    ]


def levels(study: Study) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
    """Levels of every axis."""
    return {
        name: chebyshev_levels(axis.low, axis.high, axis.levels, axis.scale) for name, axis in study.factors.items()
    }


def slab_count(study: Study) -> int:
    """Number of slabs: what the study asks for, at most one a level of the first axis."""
    first = next(iter(study.factors.values()), None)
    return min(study.dataset.slabs, first.levels) if first else 0


def slab(study: Study, index: int) -> xr.Dataset:
    """Exact quantities and fields of one slab of the factorial, split along the first axis.

    Shows cases done of all and the time left on a terminal; computes one level of the axis at a time, so that memory
    beyond the result stays small.
    """
    axes = levels(study)
    first = next(iter(axes))
    part = np.array_split(axes[first], slab_count(study))[index]
    per_level = study.cases // axes[first].size
    name = f"slab {index + 1} of {slab_count(study)}"
    pieces = []
    for level in _progress(part, per_level, name):
        piece = exact(study, {**axes, first: np.array([level])}, study.dataset.positions.values())
        pieces.append(piece.assign({field: piece[field].astype(study.dataset.precision) for field in FIELDS}))
    log.info("%s: %d cases of %d", name, part.size * per_level, study.cases)
    return xr.concat(pieces, dim=first)


def gather(slabs: Sequence[xr.Dataset]) -> xr.Dataset:
    """Quantities of the whole factorial from its slabs."""
    names = [name for name in EVERY_QUANTITY if name in slabs[0]]
    return xr.concat([part[names] for part in slabs], dim=str(slabs[0][names[0]].dims[0]))


def cases(study: Study, name: str) -> xr.Dataset:
    """Random exact cases of one of `SAMPLES`, over dimension ``case``."""
    number, key = SAMPLES[name]
    return sample(study, getattr(study.validation, key), (study.validation.seed, number))


def sample(study: Study, count: int, seed: Sequence[int]) -> xr.Dataset:
    """Random cases, uniform in the axes' own scales; exact quantities over dimension ``case``."""
    random = np.random.default_rng(list(seed))
    axes: dict[str, xr.DataArray] = {}
    for name, axis in study.factors.items():
        u = random.uniform(size=count)
        if axis.scale == "log":
            values = axis.low * (axis.high / axis.low) ** u
        else:
            values = axis.low + (axis.high - axis.low) * u
        axes[name] = xr.DataArray(np.clip(values, axis.low, axis.high), dims="case")
    return exact(study, axes)


def exact(
    study: Study, axes: dict[str, Any], positions: Iterable[float] | None = None, *, peaks: bool | None = None
) -> xr.Dataset:
    """The exact solver at some values of the factorial's factors, the study's fixed factors beside them.

    With the largest stresses of the body where ``peaks``, by default where the data set has them.
    """
    return solve(
        {**study.fixed, **axes},
        positions,
        materials=study.own_materials,
        phases=study.phases,
        peaks=study.dataset.peaks if peaks is None else peaks,
    )


def _progress(part: np.ndarray[Any, np.dtype[np.float64]], per_level: int, name: str) -> Iterator[float]:
    """The levels of a slab, with a bar of cases on a terminal and nothing in a log file."""
    with tqdm(total=part.size * per_level, desc=name, unit=" cases", disable=None, leave=False) as bar:
        for level in part:
            yield float(level)
            bar.update(per_level)
