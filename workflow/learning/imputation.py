"""A factorial that lacks the cases which the solver refuses, filled in by the process that learns it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import xarray as xr

from approximation.arrays import Array, Flags
from surrogate import GridGP, Input
from surrogate.gp import imputation
from workflow.dataset import factorial
from workflow.study.model import Study


def imputed(study: Study, data: xr.Dataset) -> xr.Dataset:
    """What the surrogate learns over its axes, with NaN filled in; unchanged without NaN, and of no factorial.

    The kernels are fitted to the quantities, and fill in curves too. Of a study with groups, quantities of one sign are
    filled in by their logarithms, so that they keep the sign.
    """
    if study.crossed:
        return data
    inputs = factorial.axis_inputs(study)
    if not study.kinks:
        return _part(study, data, inputs)
    filled = data.copy(deep=True)
    for place, own in _between_kinks(study, inputs):
        part = data.isel(place)
        if any(part[name].isnull().all() for name in part.data_vars):
            split = [box for box in own if study.axes[box.name].kinks]
            told = ", ".join(f"{box.name} in {box.range_text()}" for box in split)
            raise ValueError(f"all cases between kinks are refused: {told}")
        part = _part(study, part, own)
        for name, array in part.data_vars.items():
            filled[name].loc[{axis: part[axis].values for axis in place}] = array
    return filled


def _between_kinks(study: Study, inputs: Sequence[Input]) -> Iterator[tuple[dict[str, slice], list[Input]]]:
    """Every part of the factorial between kinks: where it lies in it, and its axes."""
    parts = []
    for input_ in inputs:
        axis = study.axes[input_.name]
        count = axis.levels or 0
        ends = enumerate(pairwise(axis.ends))
        parts.append(
            [(slice(k * count, (k + 1) * count), replace(input_, low=low, high=high)) for k, (low, high) in ends]
        )
    for chosen in product(*parts):
        yield {input_.name: place for place, input_ in chosen}, [input_ for _, input_ in chosen]


def _part(study: Study, data: xr.Dataset, inputs: Sequence[Input]) -> xr.Dataset:
    """As `imputed`, of a factorial that one process learns."""
    holes = {str(name): _missing(study, array) for name, array in data.data_vars.items()}
    if not any(flags.any() for flags in holes.values()):
        return data
    axes = list(study.axes)
    plain = {str(name): array.transpose(*axes) for name, array in data.data_vars.items() if set(array.dims) == {*axes}}
    signs = {name: _sign(array.values) if study.groups else 0 for name, array in plain.items()}
    bent = xr.Dataset({name: np.log(array * signs[name]) if signs[name] else array for name, array in plain.items()})
    coords = {name: data[name].values for name in axes}
    filled, model = imputation.filled(
        lambda: GridGP(study.surrogate.kernel, inputs),
        bent.assign_coords(coords),
        {name: holes[name] for name in plain},
    )
    values = {name: np.exp(filled[name].values) * signs[name] if signs[name] else filled[name].values for name in plain}
    return data.assign(
        {name: (plain[name].dims, array, data[name].attrs) for name, array in values.items()}
        | {
            str(name): (array.dims, _filled(model, array, axes, holes), array.attrs)
            for name, array in data.data_vars.items()
            if name not in plain
        }
    )


def _missing(study: Study, array: xr.DataArray) -> Flags:
    """Which places are missing, over the axes."""
    further = [dim for dim in array.dims if dim not in study.axes]
    return np.asarray(array.isnull().any(further).transpose(*study.axes).values)


def _filled(model: GridGP, array: xr.DataArray, axes: list[str], holes: Mapping[str, Flags]) -> Array:
    """Curves with what the process expects where they are missing."""
    ordered = array.transpose(*axes, ...)
    values, flags = ordered.values.copy(), holes[str(array.name)]
    if flags.any():
        columns = values.reshape(*flags.shape, -1)
        offset = columns[~flags].mean(axis=0)
        columns[flags] = imputation.expected(model.factors_, columns - offset, flags) + offset
        values = columns.reshape(values.shape)
    return np.asarray(xr.DataArray(values, dims=ordered.dims).transpose(*array.dims).values)


def _sign(values: Array) -> int:
    known = values[~np.isnan(values)]
    return int(np.sign(known[0])) if (known > 0).all() or (known < 0).all() else 0
