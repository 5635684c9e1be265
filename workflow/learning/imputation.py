"""A factorial that lacks the cases which the solver refuses, filled in by the process that learns it."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from approximation.arrays import Array, Flags
from surrogate import GridGP
from surrogate.gp import imputation
from workflow.dataset import factorial
from workflow.study.model import Study


def imputed(study: Study, data: xr.Dataset) -> xr.Dataset:
    """Return training data with NaN filled in; data without NaN, and of no factorial, are unchanged.

    The kernels are fitted to the quantities, and fill in curves too. Of a study with groups, quantities of one sign are
    filled in by their logarithms, so that they keep the sign.
    """
    if study.crossed:
        return data
    holes = {str(name): _missing(study, array) for name, array in data.data_vars.items()}
    if not any(flags.any() for flags in holes.values()):
        return data
    axes = list(study.axes)
    plain = {str(name): array.transpose(*axes) for name, array in data.data_vars.items() if set(array.dims) == {*axes}}
    signs = {name: _sign(array.values) if study.groups else 0 for name, array in plain.items()}
    bent = xr.Dataset({name: np.log(array * signs[name]) if signs[name] else array for name, array in plain.items()})
    coords = {name: data[name].values for name in axes}
    filled, model = imputation.filled(
        lambda: GridGP(factorial.axis_inputs(study)),
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
    """Return whether each place of the axes is missing."""
    extra_dims = [dim for dim in array.dims if dim not in study.axes]
    return np.asarray(array.isnull().any(extra_dims).transpose(*study.axes).values)


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
