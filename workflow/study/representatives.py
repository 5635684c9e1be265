"""The stored cases of a study with groups: one case represents all similar ones at a place in the axes."""

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from approximation.arrays import Array
from workflow.study import grouped
from workflow.study.contents import Contents
from workflow.study.datum import inner


def factors(study: Contents, axes: Mapping[str, Array | xr.DataArray]) -> dict[str, xr.DataArray | float]:
    """Return the factors of cases over a study's group axes; an axis varies its first factor, others stay fixed."""
    leads = grouped.leads(study.products.values(), study.factors)
    values: dict[str, Any] = {name: value for name, value in inner(study).items() if name not in leads.values()}
    values |= {name: value for name, value in study.numbers.items() if name not in study.factors}
    waiting = list(study.products)
    while waiting:
        ready = [name for name in waiting if all(other in values for other in _trailing(study, leads, name))]
        if not ready:
            raise ValueError(f"groups: {', '.join(waiting)}: each needs a factor that another varies")
        for name in ready:
            powers = study.products[name].powers
            axis = axes[name]
            remainder = axis if isinstance(axis, xr.DataArray) else xr.DataArray(np.asarray(axis), dims=name)
            for factor in _trailing(study, leads, name):
                remainder = remainder / values[factor] ** powers[factor]
            values[leads[name]] = _root(remainder, powers[leads[name]])
            waiting.remove(name)
    return {name: values[name] for name in study.factors}


def ends(study: Contents) -> dict[str, Any]:
    """Return the factors of cases in the corners of the axes, with those that need tables all low, or all high."""
    return factors(
        study,
        {
            name: xr.DataArray([axis.low, axis.high], dims="end" if name in study.tabled else name)
            for name, axis in study.axes.items()
        },
    )


def corners(study: Contents) -> dict[str, Any]:
    """Return the factors of a case in each corner of the axes, with those that need tables low in every other one."""
    untabled = [name for name in study.axes if name not in study.tabled]
    high = np.array(list(product((False, True), repeat=len(untabled))))
    ends = dict(zip(untabled, high.T, strict=True)) | dict.fromkeys(study.tabled, high.sum(1) % 2 == 1)
    return factors(
        study,
        {
            name: xr.DataArray(np.where(ends[name], axis.high, axis.low), dims="case")
            for name, axis in study.axes.items()
        },
    )


def _trailing(study: Contents, leads: Mapping[str, str], axis: str) -> list[str]:
    """Return the factors of a product but the varied one; the order in which they divide decides the last bits."""
    return [name for name in study.products[axis].powers if name != leads[axis]]


def _root(values: xr.DataArray, degree: int) -> xr.DataArray:
    """Return a root with the sign of the values, since a group has its first factor's sign (`grouped.check_signs`)."""
    if degree == 1:
        return values
    return values.copy(data=np.sign(values.values) * np.abs(values.values) ** (1 / degree))
