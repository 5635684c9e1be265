"""The answer to a table of cases as a file: netCDF with all of it, or CSV with a row a case for a spreadsheet."""

from pathlib import Path

import xarray as xr

from solver.names import ALL_QUANTITIES
from storage.files import write_text
from storage.netcdf import write_whole
from workflow.cli.casetable import Table
from workflow.language.cells import plain
from workflow.language.factors import FACTORS


def write(path: Path, table: Table, answer: xr.Dataset) -> None:
    """Write an answer as the path's ending says.

    Parameters
    ----------
    path
        ``.nc`` or ``.csv``. A CSV has the columns of the table, then those of the answer that have one number a case; a
        unit stands behind each name, as in ``load [N m-1]``, and numbers are in SI, every digit of them.
    table, answer
        The cases, and what they come to over ``case``.
    """
    if path.suffix != ".csv":
        write_whole(answer, path)
        return
    units = {name: one.units for name, one in FACTORS.items()}
    units |= {name: one.units for name, one in ALL_QUANTITIES.items()}
    columns = {name: xr.Variable("case", cells) for name, cells in table.columns.items()}
    columns |= {str(name): one.variable + 0.0 for name, one in answer.data_vars.items() if one.dims == ("case",)}
    frame = xr.Dataset(columns).to_dataframe().map(plain)
    frame.columns = [name if units.get(name, "1") == "1" else f"{name} [{units[name]}]" for name in frame.columns]
    write_text(path, frame.to_csv(index=False))
