"""Tables as cases: every row of a data frame, of Series with one index or of a list of mappings is one case."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import columns_of
from solver.arrays import shown
from solver.face.refusal import FactorError

#: What the entrances of the solver take: values by factor name, or a table of cases.
Factors: TypeAlias = Mapping[str, Any] | xr.Dataset | pd.DataFrame | Sequence[Mapping[str, Any]]

CASE = "case"  # the dimension of rows


def by_name(factors: Factors) -> dict[str, Any]:
    """Values by factor name; those of a table along the one dimension ``case``."""
    if isinstance(factors, xr.Dataset):
        return {str(name): values for name, values in (*factors.data_vars.items(), *factors.coords.items())}
    if isinstance(factors, Mapping | pd.Series):
        try:
            columns = columns_of(factors)
        except ValueError as error:
            raise FactorError(str(error)) from None
        return dict(factors) | (_rows(pd.DataFrame(columns)) if columns else {})
    if isinstance(factors, np.ndarray) and factors.dtype.names:
        return _rows(pd.DataFrame(factors))
    if isinstance(factors, pd.DataFrame):
        return _rows(factors)
    if isinstance(factors, Sequence) and factors and all(isinstance(row, Mapping) for row in factors):
        return _rows(pd.DataFrame([dict(row) for row in factors]))
    raise FactorError(f"factors: {shown(factors)} is no mapping of factors, no data frame and no list of mappings")


def _rows(table: pd.DataFrame) -> dict[str, Any]:
    """Columns of a table over its rows, which have the labels of its index; several levels of one are numbered."""
    if not len(table):
        raise FactorError("factors: a table without rows")
    if table.columns.has_duplicates:
        raise FactorError(f"{table.columns[table.columns.duplicated()][0]}: two columns of the table have this name")
    labels = pd.RangeIndex(len(table)) if table.index.nlevels > 1 else table.index
    return {
        str(name): xr.DataArray(_cells(column), dims=CASE, coords={CASE: labels.to_numpy()})
        for name, column in table.items()
    }


def _cells(column: pd.Series) -> NDArray[Any]:
    """Values of a column; a missing number is NaN, any other missing value None."""
    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        numbers: NDArray[Any] = column.to_numpy(dtype=np.float64, na_value=np.nan)
        return numbers
    values = column.to_numpy(dtype=object, copy=True)
    values[column.isna().to_numpy()] = None
    return np.asarray(values)
