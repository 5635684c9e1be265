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

#: Factors of cases as the public functions take them: values by factor name, or a table of cases.
Factors: TypeAlias = Mapping[str, Any] | xr.Dataset | pd.DataFrame | Sequence[Mapping[str, Any]]

CASE = "case"  # the dimension of rows
_HEADING = re.compile(r"(?P<name>\w+)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))\s*")
#: Factors that some kinds of cases lack: those without a default, and the choices that name a kind.
_OF_KINDS = {*MATERIALS, BODY, "profile", "composite"}
_OF_KINDS |= {name for name, factor in FACTORS.items() if factor.default is None}
_EMPTY = "no number where a case has none"


def by_name(factors: Factors) -> dict[str, Any]:
    """Return values by factor name, of a table along the one dimension ``case``."""
    if isinstance(factors, xr.Dataset):
        return {str(name): values for name, values in (*factors.data_vars.items(), *factors.coords.items())}
    table = _table(factors)
    scalars = factors if isinstance(factors, Mapping | pd.Series) else {}
    return dict(scalars) | ({} if table is None else _columns(table))


def of_kinds(factors: Factors) -> list[tuple[Indices, dict[str, Any]]]:
    """Group the rows of a table by the factors that they have, with these factors; empty if all rows have the same."""
    table = None if isinstance(factors, xr.Dataset) else _table(factors)
    if table is None or not len(table):
        return []
    if isinstance(factors, Sequence):  # a mapping lacks the keys that only others have
        lacking = np.array([[name not in row for name in table.columns] for row in factors])
    else:  # a row of a data frame lacks its empty cells of these factors
        lacking = table.isna().to_numpy() & [_named(str(name))[0] in _OF_KINDS for name in table.columns]
    if not np.any(lacking != lacking[:1]):
        return []
    patterns, which = np.unique(lacking, axis=0, return_inverse=True)
    scalars = dict(factors) if isinstance(factors, Mapping) else {}
    groups = [np.flatnonzero(which.ravel() == number) for number in range(len(patterns))]
    return [
        (rows, scalars | _columns(table.iloc[rows].loc[:, ~pattern].infer_objects()))
        for rows, pattern in zip(groups, patterns, strict=True)
    ]


def solved_by_kind(parts: Sequence[tuple[Indices, dict[str, Any]]], solve: Callable[[Any], xr.Dataset]) -> xr.Dataset:
    """Solve rows kind by kind, and return outputs in the order of all rows, NaN where a kind lacks an output."""
    solutions = []
    for _, factors in parts:
        try:
            solutions.append(solve(factors))
        except FactorError as error:
            message = str(error)
            row = next(array[CASE].values[0] for array in factors.values() if CASE in getattr(array, "dims", ()))
            raise FactorError(message if "(row " in message else f"{message} (row {row})") from None
    return joined([rows for rows, _ in parts], solutions)


def joined(rows: Sequence[Indices], solutions: Sequence[xr.Dataset]) -> xr.Dataset:
    """Join solutions of parts of the rows in the order of all rows, with NaN where a solution lacks an output."""
    order = np.argsort(np.concatenate(rows))
    variables: dict[str, xr.Variable] = {}
    for name in dict.fromkeys(str(name) for solution in solutions for name in solution.variables):
        available = [solution[name].variable for solution in solutions if name in solution.variables]
        first = available[0]
        if CASE not in first.dims and len(available) == len(solutions) and all(map(first.equals, available)):
            variables[name] = first
            continue
        dims = (CASE, *(dim for dim in first.dims if dim != CASE))
        filled = [
            _filled(solution.variables.get(name), first, dims, len(part))
            for solution, part in zip(solutions, rows, strict=True)
        ]
        attrs = first.attrs | ({} if len(available) == len(solutions) else {"comment": _EMPTY})
        variables[name] = xr.Variable(dims, np.concatenate(filled)[order], attrs)
    coords = {str(name) for solution in solutions for name in solution.coords}
    return xr.Dataset(
        {name: variable for name, variable in variables.items() if name not in coords},
        {name: variable for name, variable in variables.items() if name in coords},
        united([solution.attrs for solution in solutions]),
    )


def _filled(variable: xr.Variable | None, like: xr.Variable, dims: tuple[Hashable, ...], count: int) -> NDArray[Any]:
    """Return an output of ``count`` rows over its dimensions, empty if the rows lack it."""
    shape = (count, *(like.sizes[dim] for dim in dims[1:]))
    if variable is None:
        number = like.dtype.kind == "f"
        return np.full(shape, np.nan if number else "", None if number else object)
    return np.broadcast_to(variable.transpose(*dims, missing_dims="ignore").values, shape)


def _table(factors: Factors) -> pd.DataFrame | None:
    """Return the table of cases among factors, its rows numbered in place of a multi-index, or None."""
    if isinstance(factors, Mapping | pd.Series):
        try:
            columns = columns_of(factors)
        except ValueError as error:
            raise FactorError(str(error)) from None
        if not columns:
            return None
        table = pd.DataFrame(columns)
    elif isinstance(factors, np.ndarray) and factors.dtype.names:
        table = pd.DataFrame(factors)
    elif isinstance(factors, pd.DataFrame):
        table = factors
    elif isinstance(factors, Sequence) and factors and all(isinstance(row, Mapping) for row in factors):
        table = pd.DataFrame([dict(row) for row in factors])
    else:
        raise FactorError(f"factors: {shown(factors)} is no mapping of factors, no data frame and no list of mappings")
    return table.reset_index(drop=True) if table.index.nlevels > 1 else table


def _columns(table: pd.DataFrame) -> dict[str, xr.DataArray]:
    """Return the columns of a table over its rows, labelled by its index."""
    if not len(table):
        raise FactorError("factors: a table without rows")
    columns: dict[str, xr.DataArray] = {}
    for heading, column in table.items():
        name, unit = _named(str(heading))
        if name in columns:
            raise FactorError(f"{name}: two columns of the table have this name")
        cells = _cells(column) if unit is None else _scaled(str(heading), _cells(column), unit, FACTORS[name].units)
        columns[name] = xr.DataArray(cells, dims=CASE, coords={CASE: table.index.to_numpy()})
    return columns


def _named(heading: str) -> tuple[str, str | None]:
    """Split a heading such as ``radius [mm]`` into factor and unit; one without a unit stays as it is."""
    match = _HEADING.fullmatch(heading)
    if match is None or match["name"] not in FACTORS:
        return heading, None
    return match["name"], match["square"] if match["square"] is not None else match["round"]


def _scaled(heading: str, cells: NDArray[Any], unit: str, si: str) -> NDArray[Any]:
    """Return numbers of a column in SI units, and texts, which have units of their own, unchanged."""
    try:
        parsed = units.parse(unit)
    except ValueError as error:
        raise FactorError(f"{heading}: {error}") from None
    if not parsed.fits(units.parse(si)):
        raise FactorError(f"{heading}: unit mismatch: {unit!r} does not measure what {si!r} measures")
    if cells.dtype != object:
        return _times(cells, parsed.scale)
    numbers = [row for row, cell in enumerate(cells) if not (cell is None or isinstance(cell, str))]
    cells[numbers] = _times(cells[numbers], parsed.scale)
    return cells


def _times(values: NDArray[Any], scale: float) -> NDArray[Any]:
    """Multiply values by a scale, or divide by a whole divisor, so that 20 um are 2e-5 m to the last bit."""
    divisor = round(1 / scale)
    is_whole = scale < 1 and np.isclose(scale * divisor, 1, rtol=1e-15, atol=0)
    return np.asarray(values / divisor if is_whole else values * scale)


def _cells(column: pd.Series) -> NDArray[Any]:
    """Return the values of a column, with NaN for missing numbers and None for other missing values."""
    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        numbers: NDArray[Any] = column.to_numpy(dtype=np.float64, na_value=np.nan)
        return numbers
    values = column.to_numpy(dtype=object, copy=True)
    values[column.isna().to_numpy()] = None
    return np.asarray(values)
