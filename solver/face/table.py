"""A solved case as a table for people: engineering units, without the fields that its body does not have."""

import pandas as pd
import xarray as xr

from solver.fields import Field, fields_of
from solver.names import ALL_QUANTITIES
from solver.units import prefixed

_BY_ITSELF = ("capacitance", "permeance")  # every body has them, whether or not it couples a field to its deformation


def table(case: xr.Dataset) -> pd.DataFrame:
    """Quantities of one solved case, each with a decimal prefix and its unit.

    A body that couples no electric or no magnetic field to its deformation, under a punch without a charge of that
    field, has no quantities of it here; in the dataset they are 0.

    Parameters
    ----------
    case
        Answer of :func:`solve` to one case.

    Returns
    -------
    pandas.DataFrame
        Columns ``value`` and ``unit``, a row a quantity, NaN where the case has none.

    Raises
    ------
    ValueError
        Several cases.

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
    units = {name: quantity.units for name, quantity in ALL_QUANTITIES.items() if name in case}
    if any(case[name].size != 1 for name in units):
        raise ValueError(f"table: several cases, over {', '.join(map(str, case.dims))}; choose one, as case.isel(...)")
    values = {name: float(case[name].values.item()) for name in units}
    coupled: set[Field] = set()
    for name, value in values.items():
        if value and not any(word in name for word in _BY_ITSELF):
            coupled |= fields_of(units[name])
    rows = {}
    for name, value in values.items():
        if fields_of(units[name]) <= coupled:
            scale, unit = prefixed(abs(value), units[name])
            rows[name] = (value / scale, unit)
    return pd.DataFrame.from_dict(rows, orient="index", columns=["value", "unit"])
