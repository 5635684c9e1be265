"""Surroundings of the contacts whose cases name none."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from solver.body import around
from solver.face.filmfactors import absent
from solver.names import BODY, OF_AN_ELECTRODE

#: Factors that :func:`solver.body.around` reads: by their value, or only by whether a case has them, other than 0.
_READ = ("surroundings", BODY, "material", "profile", "electric", "magnetic", "electrode", "interface_magnetic")
_THERE = ("thickness", "gap_radius", "base_volume_fraction", "grading_exponent", *OF_AN_ELECTRODE[1:])


def settled(arrays: Mapping[str, xr.DataArray]) -> dict[str, xr.DataArray]:
    """Factors with the surroundings of every case, where a film or a table leaves them open."""
    surroundings = arrays.get("surroundings")
    opened = arrays.keys() & {BODY, "thickness"} if surroundings is None else any(map(absent, surroundings.values.flat))
    if not opened:
        return dict(arrays)
    read = {name: _labels(arrays[name], name in _THERE) for name in (*_READ, *_THERE) if name in arrays}
    cases = xr.broadcast(*read.values())
    around_of: dict[tuple[Any, ...], str] = {}
    for values in (rows := list(zip(*(labels.values.flat for labels in cases), strict=True))):
        if values not in around_of:
            case = {name: value for name, value in zip(read, values, strict=True) if not absent(value)}
            around_of[values] = str(case.get("surroundings") or around(case))
    chosen = xr.DataArray(np.reshape([around_of[values] for values in rows], cases[0].shape), dims=cases[0].dims)
    return {**arrays, "surroundings": chosen if len({*around_of.values()}) > 1 else chosen[(0,) * chosen.ndim]}


def _labels(array: xr.DataArray, only_presence: bool) -> xr.DataArray:
    """A factor's values, or 1 where a case has it and it is not 0; without dimension where all are one."""
    values = array.values
    if only_presence:
        values = np.where([not absent(value) and value != 0 for value in values.flat], 1.0, np.nan)
        values = values.reshape(array.shape)
    labels = xr.DataArray(values.astype(object), dims=array.dims)
    first = labels.values.flat[0] if labels.size else None
    alike = all(label is first or label == first or (absent(label) and absent(first)) for label in labels.values.flat)
    return labels.isel(dict.fromkeys(labels.dims, 0)) if labels.size and alike else labels
