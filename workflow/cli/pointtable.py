"""Predictions of a surrogate at a table of points; a row without an answer is named."""

import numpy as np
import xarray as xr

from surrogate import GaussianProcess, OutOfBoxError
from surrogate.data.points import outside
from workflow.cli import predictions
from workflow.cli.casetable import Table
from workflow.language.spelling import nearest
from workflow.study.reading import InputError


def predicted(model: GaussianProcess, table: Table, level: float, *, extrapolate: bool) -> xr.Dataset:
    """Every output of the model at every row, with intervals, over dimension ``point``."""
    for name in table.columns:
        if name not in model.box:
            raise InputError(f"{table.source}: {name}: not an input of the surrogate; {nearest(name, list(model.box))}")
    columns = {name: table.numbers(name, f"the surrogate needs {', '.join(model.box)}") for name in model.box}
    named = {name: xr.DataArray(column, dims="point") for name, column in columns.items()}
    X = np.stack(list(columns.values()), axis=1)
    wrong = outside(X, model.inputs_)
    try:
        with np.errstate(all="ignore"):  # what is not finite is named below
            answer = predictions.predicted(model, named, level, extrapolate=extrapolate)
    except OutOfBoxError as error:
        raise InputError(f"{table.at(int((~model.has_answers(X)).argmax()))}: {error}") from None
    except ValueError as error:
        raise InputError(f"{table.source}: {error}") from None
    bad = ~np.all([np.isfinite(array.values) for array in answer.data_vars.values()], axis=0)
    if bad.any():
        row = int(bad.argmax())
        far = ", ".join(
            f"{axis.name} = {X[row, k]:.10g} (trained within {axis.range_text()})"
            for k, axis in enumerate(model.inputs_)
            if wrong[row, k]
        )
        raise InputError(f"{table.at(row)}: {far}: no finite answer so far outside of the trained box")
    return answer
