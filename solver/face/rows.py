"""Tables of cases: rows as factors along one dimension, headings with units, and rows of several kinds."""

import re
from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Indices, columns_of
from solver import units
from solver.arrays import shown
from solver.face.attributes import united
from solver.face.refusal import FactorError
from solver.names import BODY, FACTORS, MATERIALS

#: What the entrances of the solver take: values by factor name, or a table of cases.
Factors: TypeAlias = Mapping[str, Any] | xr.Dataset | pd.DataFrame | Sequence[Mapping[str, Any]]

CASE = "case"  # the dimension of rows
_HEADING = re.compile(r"(?P<name>\w+)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))\s*")
#: Factors that some kinds of cases have and others lack: those without default, and the choices that name a kind.
_OF_KINDS = {*MATERIALS, BODY, "profile", "composite"}
_OF_KINDS |= {name for name, factor in FACTORS.items() if factor.default is None}
_EMPTY = "no number where a case has none"


def by_name(factors: Factors) -> dict[str, Any]:
    """Values by factor name; those of a table along the one dimension ``case``."""
    if isinstance(factors, xr.Dataset):
        return {str(name): values for name, values in (*factors.data_vars.items(), *factors.coords.items())}
    table = _table(factors)
    alone = factors if isinstance(factors, Mapping | pd.Series) else {}
    return dict(alone) | ({} if table is None else _columns(table))


def of_kinds(factors: Factors) -> list[tuple[Indices, dict[str, Any]]]:
    """Rows of a table by the factors that they have, with these factors; empty where all rows have the same.

    In a list of mappings a row lacks the keys that only others have, in a data frame its empty cells of `_OF_KINDS`.
    """
    table = None if isinstance(factors, xr.Dataset) else _table(factors)
    if table is None or not len(table):
        return []
    if isinstance(factors, Sequence):
        lacking = np.array([[name not in row for name in table.columns] for row in factors])
    else:
        lacking = table.isna().to_numpy() & [_named(str(name))[0] in _OF_KINDS for name in table.columns]
    if not np.any(lacking != lacking[:1]):
        return []
    patterns, which = np.unique(lacking, axis=0, return_inverse=True)
    alone = dict(factors) if isinstance(factors, Mapping) else {}
    rows = [np.flatnonzero(which.ravel() == place) for place in range(len(patterns))]
    return [
        (places, alone | _columns(table.iloc[places].loc[:, ~pattern].infer_objects()))
        for places, pattern in zip(rows, patterns, strict=True)
    ]


def solved_by_kind(parts: Sequence[tuple[Indices, dict[str, Any]]], solve: Callable[[Any], xr.Dataset]) -> xr.Dataset:
    """Outputs of rows of several kinds in their order; a row is NaN where its kind lacks an output."""
    answers = []
    for _, factors in parts:
        try:
            answers.append(solve(factors))
        except FactorError as error:
            said = str(error)
            row = next(array[CASE].values[0] for array in factors.values() if CASE in getattr(array, "dims", ()))
            raise FactorError(said if "(row " in said else f"{said} (row {row})") from None
    return joined([places for places, _ in parts], answers)


def joined(rows: Sequence[Indices], answers: Sequence[xr.Dataset]) -> xr.Dataset:
    """Answers to some rows each, put in the order of all rows; a row is NaN where its answer lacks an output."""
    order = np.argsort(np.concatenate(rows))
    whole: dict[str, xr.Variable] = {}
    for name in dict.fromkeys(str(name) for answer in answers for name in answer.variables):
        having = [answer[name].variable for answer in answers if name in answer.variables]
        first = having[0]
        if CASE not in first.dims and len(having) == len(answers) and all(map(first.equals, having)):
            whole[name] = first
            continue
        dims = (CASE, *(dim for dim in first.dims if dim != CASE))
        filled = [
            _filled(answer.variables.get(name), first, dims, len(places))
            for answer, places in zip(answers, rows, strict=True)
        ]
        attrs = first.attrs | ({} if len(having) == len(answers) else {"comment": _EMPTY})
        whole[name] = xr.Variable(dims, np.concatenate(filled)[order], attrs)
    coords = {str(name) for answer in answers for name in answer.coords}
    return xr.Dataset(
        {name: variable for name, variable in whole.items() if name not in coords},
        {name: variable for name, variable in whole.items() if name in coords},
        united([answer.attrs for answer in answers]),
    )


def _filled(variable: xr.Variable | None, like: xr.Variable, dims: tuple[Hashable, ...], count: int) -> NDArray[Any]:
    """An output of some rows over `CASE` and its other dimensions; empty where the rows lack it."""
    shape = (count, *(like.sizes[dim] for dim in dims[1:]))
    if variable is None:
        number = like.dtype.kind == "f"
        return np.full(shape, np.nan if number else "", None if number else object)
    return np.broadcast_to(variable.transpose(*dims, missing_dims="ignore").values, shape)


def _table(factors: Factors) -> pd.DataFrame | None:
    """The table of cases among factors; None where there is none."""
    if isinstance(factors, Mapping | pd.Series):
        try:
            columns = columns_of(factors)
        except ValueError as error:
            raise FactorError(str(error)) from None
        return pd.DataFrame(columns) if columns else None
    if isinstance(factors, np.ndarray) and factors.dtype.names:
        return pd.DataFrame(factors)
    if isinstance(factors, pd.DataFrame):
        return factors
    if isinstance(factors, Sequence) and factors and all(isinstance(row, Mapping) for row in factors):
        return pd.DataFrame([dict(row) for row in factors])
    raise FactorError(f"factors: {shown(factors)} is no mapping of factors, no data frame and no list of mappings")


def _columns(table: pd.DataFrame) -> dict[str, xr.DataArray]:
    """Columns of a table over its rows, which have the labels of its index; several levels of one are numbered."""
    if not len(table):
        raise FactorError("factors: a table without rows")
    labels = pd.RangeIndex(len(table)) if table.index.nlevels > 1 else table.index
    columns: dict[str, xr.DataArray] = {}
    for heading, column in table.items():
        name, unit = _named(str(heading))
        if name in columns:
            raise FactorError(f"{name}: two columns of the table have this name")
        cells = _cells(column) if unit is None else _scaled(str(heading), _cells(column), unit, FACTORS[name].units)
        columns[name] = xr.DataArray(cells, dims=CASE, coords={CASE: labels.to_numpy()})
    return columns


def _named(heading: str) -> tuple[str, str | None]:
    """Factor and unit of a heading such as ``radius [mm]``; a heading without a unit as it is."""
    match = _HEADING.fullmatch(heading)
    if match is None or match["name"] not in FACTORS:
        return heading, None
    return match["name"], match["square"] if match["square"] is not None else match["round"]


def _scaled(heading: str, cells: NDArray[Any], unit: str, si: str) -> NDArray[Any]:
    """Numbers of a column in SI units; texts, which have units of their own, as they are."""
    try:
        parsed = units.parse(unit)
    except ValueError as error:
        raise FactorError(f"{heading}: {error}") from None
    if not parsed.fits(units.parse(si)):
        raise FactorError(f"{heading}: unit mismatch: {unit!r} does not measure what {si!r} measures")
    if cells.dtype != object:
        return _times(cells, parsed.scale)
    numbers = [place for place, cell in enumerate(cells) if not (cell is None or isinstance(cell, str))]
    cells[numbers] = _times(cells[numbers], parsed.scale)
    return cells


def _times(values: NDArray[Any], scale: float) -> NDArray[Any]:
    """Values times a scale; by a whole divisor where there is one, so that 20 um are 2e-5 m to the last bit."""
    divisor = round(1 / scale)
    whole = scale < 1 and np.isclose(scale * divisor, 1, rtol=1e-15, atol=0)
    return np.asarray(values / divisor if whole else values * scale)


def _cells(column: pd.Series) -> NDArray[Any]:
    """Values of a column; a missing number is NaN, any other missing value None."""
    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        numbers: NDArray[Any] = column.to_numpy(dtype=np.float64, na_value=np.nan)
        return numbers
    values = column.to_numpy(dtype=object, copy=True)
    values[column.isna().to_numpy()] = None
    return np.asarray(values)
