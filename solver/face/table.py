"""Solved cases as a table in engineering units, without fields that are not coupled to the deformation."""

import numpy as np
import pandas as pd
import xarray as xr

from solver.fields import Field, fields_of
from solver.names import ALL_QUANTITIES
from solver.units import prefixed

_UNCOUPLED = ("capacitance", "permeance")  # which bodies without coupling to the deformation have, too

_ROUNDING = 1e-6  # of the smallest prefix: values that are 0 except for rounding


def table(answer: xr.Dataset) -> pd.DataFrame:
    """Quantities of solved cases, each with a decimal prefix and its unit.

    A body that couples no electric or no magnetic field to its deformation, under a punch without a charge of that
    field, has no quantities of it here; in the dataset they are 0.

    Parameters
    ----------
    answer
        Answer of :func:`solve`.

    Returns
    -------
    pandas.DataFrame
        Of one case the columns ``value`` and ``unit``, a row a quantity. Of several a row a case, a column a quantity
        such as ``voltage [V]``, beside the factors in SI. NaN where a case lacks a quantity.

    Examples
    --------
    >>> import solver
    >>> ball = {"material": "PZT-4", "profile": "sphere", "radius": 5e-3, "force": 1.0}
    >>> print(solver.table(solver.solve(ball)).head(3).round(2))
                    value unit
    peak_pressure  385.45  MPa
    depth          208.51   nm
    voltage       -156.88    V
    """
    units = {name: quantity.units for name, quantity in ALL_QUANTITIES.items() if name in answer}
    sizes = {name: float(np.nanmax(np.abs(answer[name].values), initial=0.0)) for name in units}
    coupled: set[Field] = set()
    for name, size in sizes.items():
        if size and not any(word in name for word in _UNCOUPLED):
            coupled |= fields_of(units[name])
    scales = {name: prefixed(size, units[name]) for name, size in sizes.items() if fields_of(units[name]) <= coupled}
    quantities = answer[list(scales)]
    if all(quantities[name].size == 1 for name in scales):
        values = {name: float(quantities[name].values.item()) / scale for name, (scale, _) in scales.items()}
        rows = {
            name: (values[name] if abs(values[name]) > _ROUNDING else 0.0, unit) for name, (_, unit) in scales.items()
        }
        return pd.DataFrame.from_dict(rows, orient="index", columns=["value", "unit"])
    frame = quantities.to_dataframe()
    for name, (scale, _) in scales.items():
        frame[name] /= scale
    return frame.rename(columns={name: f"{name} [{unit}]" if unit else name for name, (_, unit) in scales.items()})
