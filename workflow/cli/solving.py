"""Tables of cases of any kind: rows that leave different cells empty are solved apart, in blocks, and put together."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from tqdm import tqdm

from solver import FactorError, MaterialError
from solver.face.attributes import united
from solver.names import CHOICES, FACTORS, OF_A_FILM, OF_A_PUNCH
from workflow.cli.casetable import Table
from workflow.study.reading import InputError

Indices = NDArray[np.intp]

_DEFAULTS: dict[str, float | str | None] = {name: factor.default for name, factor in FACTORS.items()}
_DEFAULTS |= {name: choices[0] for name, choices in CHOICES.items() if name not in ("composite", "corner")}
# a case without: a half-plane, a rigid punch
_DEFAULTS |= {name: np.nan if name in FACTORS else "" for name in (*OF_A_FILM, *OF_A_PUNCH)}
_CASES = 512  # solved at a time at most: searched contacts (tilted flats) take 100 kB of temporaries each
_VALUES = 2**17  # of a field at a time: some hundred temporaries of 8 bytes each inside the body
_MOST_BYTES = 2**32  # of an answer, which is kept in memory until it is written
_OF_OPTIONS = ("positions", "x", "y", "fields")  # what a message opens with that is about no row
_REFUSALS = (FactorError, MaterialError, np.linalg.LinAlgError)


def solved(table: Table, solve: Callable[[xr.Dataset], xr.Dataset], points: int = 1) -> xr.Dataset:
    """Outputs over dimension ``case`` in the order of the rows.

    Shows cases done of all on a terminal, from the second second on.

    Parameters
    ----------
    table
        An empty cell takes the factor's default, or means that the case has no such factor.
    solve
        What answers a data set of factors over ``case``.
    points
        Values of a field for every case, which the memory grows with.

    Returns
    -------
    xarray.Dataset
        What every case has: the quantities of an insulating punch, say, are those of all where one case has it.

    Raises
    ------
    InputError
        A case that cannot be solved, with its line; an answer too large for the memory.
    """
    whole = _Whole(table)
    with tqdm(total=len(table.lines), unit=" cases", delay=2, disable=None, leave=False) as bar:
        for names, rows in _blocks(table, min(_CASES, max(1, _VALUES // points))):
            try:
                part = solve(_factors(table, names, rows))
            except _REFUSALS as error:
                raise _explained(table, names, rows, solve, error) from None
            whole.add(rows, part)
            bar.update(len(rows))
    return whole.dataset()


def _blocks(table: Table, most: int) -> Iterator[tuple[list[str], Indices]]:
    """Rows that are solved together, and the factors that they have.

    Every block of a pattern takes its rows from all over the table, so that it meets what is hardest in it: the
    solver's iterations go on until the last case of a block has come to an end, so that cases which are easier would
    else go fewer steps than in one block. What is searched for (`solver.names.PEAKS`) is found to its tolerance only.
    """
    columns = [~table.empty(name) | (_DEFAULTS.get(name) is not None) for name in table.columns]
    patterns, first, pattern = np.unique(np.stack(columns, 1), axis=0, return_index=True, return_inverse=True)
    for k in np.argsort(first):
        rows = np.flatnonzero(pattern.ravel() == k)
        count = -(-len(rows) // most)
        names = [name for name, has in zip(table.columns, patterns[k], strict=True) if has]
        for begin in range(count):
            yield names, rows[begin::count]


def _factors(table: Table, names: list[str], rows: Indices) -> xr.Dataset:
    """The cells of some rows, defaults where they are empty."""
    columns = {}
    for name in names:
        cells = table.columns[name][rows]
        cells[table.empty(name)[rows]] = _DEFAULTS.get(name)
        columns[name] = ("case", cells.astype(float if name in FACTORS else str))
    return xr.Dataset(columns)


def _explained(
    table: Table, names: list[str], rows: Indices, solve: Callable[[xr.Dataset], xr.Dataset], error: Exception
) -> InputError:
    """The error of the first row that cannot be solved, with its line, found by halving."""
    if str(error).partition(":")[0] in _OF_OPTIONS:
        return InputError(f"{table.source}: {error}")

    def refused(rows: Indices) -> Exception | None:
        try:
            solve(_factors(table, names, rows))
        except _REFUSALS as error:
            return error
        return None

    while len(rows) > 1:
        half = rows[: (len(rows) + 1) // 2]
        rows = half if refused(half) else rows[len(half) :]
    alone = refused(rows)
    where = table.at(int(rows[0])) if alone else table.source  # else it takes several rows to go wrong
    error = alone or error
    if isinstance(error, np.linalg.LinAlgError):
        return InputError(f"{where}: constants beyond what double precision can solve ({error})")
    return InputError(f"{where}: {error}")


class _Whole:
    """The answer to a table, filled block by block."""

    def __init__(self, table: Table) -> None:
        self._table, self._count = table, len(table.lines)
        self._filled: dict[str, xr.Variable] = {}
        self._coords: list[str] = []
        self._attrs: dict[str, Any] = {}

    def add(self, rows: Indices, part: xr.Dataset) -> None:
        """Take the answer to some rows in; what it lacks is left out of the whole."""
        if not self._filled:
            self._coords = [str(name) for name in part.coords]
            size = part.nbytes / len(rows) * self._count
            if size > _MOST_BYTES:
                raise InputError(
                    f"{self._table.source}: {self._count} cases give {size:.3g} bytes, "
                    f"more than {_MOST_BYTES}; split it"
                )
            self._filled = {str(name): self._room(variable) for name, variable in part.variables.items()}
        self._attrs = united([self._attrs or part.attrs, part.attrs])
        for name in [name for name in self._filled if name not in part.variables]:
            del self._filled[name]
        for name, variable in self._filled.items():
            if "case" in variable.dims:
                variable.values[rows] = part[name].values

    def dataset(self) -> xr.Dataset:
        """All of it."""
        coords = {name: variable for name, variable in self._filled.items() if name in self._coords}
        return xr.Dataset(
            {name: variable for name, variable in self._filled.items() if name not in coords}, coords, self._attrs
        )

    def _room(self, variable: xr.Variable) -> xr.Variable:
        """A variable as long as the table; names as objects, which one long name does not widen."""
        if "case" not in variable.dims:
            return variable
        kind = variable.dtype if variable.dtype.kind == "f" else np.dtype(object)
        return xr.Variable(variable.dims, np.empty((self._count, *variable.shape[1:]), kind), variable.attrs)
