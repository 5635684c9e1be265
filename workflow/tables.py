"""Tables of cases of any kind: rows that leave different cells empty are solved apart and put together again."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from solver.attributes import united
from solver.names import CHOICES, FACTORS

Cell = float | str | None
_DEFAULTS: dict[str, Cell] = {name: factor.default for name, factor in FACTORS.items()}
_DEFAULTS |= {name: choices[0] for name, choices in CHOICES.items() if name not in ("composite", "corner")}


def solved(columns: Mapping[str, Sequence[Cell]], solve: Callable[[xr.Dataset], xr.Dataset]) -> xr.Dataset:
    """Outputs over dimension ``case`` in the order of the rows.

    Parameters
    ----------
    columns
        Cells by factor; an empty one (None) takes the factor's default, or means that the case has no such factor.
    solve
        What answers a data set of factors over ``case``.

    Returns
    -------
    xarray.Dataset
        What every case has: the quantities of an insulating punch, say, are those of all where one case has it.
    """
    filled = {
        name: [_DEFAULTS.get(name) if cell is None else cell for cell in cells] for name, cells in columns.items()
    }
    count = len(next(iter(filled.values())))
    given = [tuple(name for name, cells in filled.items() if cells[row] is not None) for row in range(count)]
    kinds = list(dict.fromkeys(given))
    rows = [[row for row in range(count) if given[row] == kind] for kind in kinds]
    parts = [
        solve(xr.Dataset({name: ("case", np.asarray([filled[name][row] for row in some])) for name in kind}))
        for kind, some in zip(kinds, rows, strict=True)
    ]
    if len(parts) == 1:
        return parts[0]
    shared = [name for name in parts[0].variables if all(name in part.variables for part in parts)]
    alike = [part.drop_vars([name for name in part.variables if name not in shared]) for part in parts]
    whole = xr.concat(alike, "case", data_vars="minimal", coords="minimal", compat="override", join="override")
    whole = whole.assign_attrs(united([part.attrs for part in parts]))
    return whole.isel(case=np.argsort(np.concatenate(rows)))
