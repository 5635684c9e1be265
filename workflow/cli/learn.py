"""``meecontact learn``: measured rows correct a study's surrogate; the result in words."""

import argparse
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver.names import ALL_QUANTITIES
from storage.files import output
from surrogate import GaussianProcess, save
from surrogate.data.points import outside
from surrogate.transforms.measured import CorrectedGP, Measurements
from workflow.cli import questions
from workflow.cli.casetable import Table, read_cases
from workflow.cli.words import named, say, trained
from workflow.language.spelling import nearest
from workflow.learning import correction
from workflow.study import categories, uncertainty
from workflow.study.model import Study
from workflow.study.reading import InputError, located, number, one_line

#: Ending of a column of errors behind the name of its quantity.
ERROR = "_std"


def read_measured(path: Path, study: Study, model: GaussianProcess) -> Measurements:
    """Read measured rows: columns of all factors and categories, quantities, and ``<quantity>_std`` of their errors."""
    quantities = {name: ALL_QUANTITIES[name].units for name in study.outputs}
    columns = quantities | {f"{name}{ERROR}": units for name, units in quantities.items()}
    table = read_cases(path, columns)
    needs = f"the surrogate needs {', '.join((*study.factors, *study.categories))}"
    _check_columns(table, study, list(columns), needs)
    X = np.stack([table.numbers(name, needs) for name in model.box], axis=1)
    wrong = outside(X, model.inputs_)
    if wrong.any():
        row, k = np.argwhere(wrong)[0]
        axis = model.inputs_[k]
        raise InputError(
            f"{table.at(int(row))}: {axis.name} = {X[row, k]:.10g} is outside the trained box {axis.range_text()}"
        )
    combinations = _combinations(table, study)
    rows, outputs, values, errors = [], [], [], []
    for name in quantities:
        for row in np.flatnonzero(_measured(table, name)).tolist():
            rows.append(row)
            outputs.append(model.outputs_.index(categories.output(name, combinations[row])))
            values.append(float(table.columns[name][row]))
            errors.append(float(table.columns[f"{name}{ERROR}"][row]) if f"{name}{ERROR}" in table.columns else np.nan)
    return Measurements(
        X, np.array(rows, dtype=np.intp), np.array(outputs, dtype=np.intp), np.array(values), np.array(errors)
    )


def _check_columns(table: Table, study: Study, measured: list[str], needs: str) -> None:
    inputs = [*study.factors, *study.categories]
    for name in table.columns:
        if name not in (*inputs, *measured):
            near = nearest(name, [*inputs, *measured])
            raise InputError(f"{table.source}: {name}: neither an input of the surrogate nor learned by it; {near}")
        if name.endswith(ERROR) and name in measured and name.removesuffix(ERROR) not in table.columns:
            raise InputError(f"{table.source}: {name}: without a column {name.removesuffix(ERROR)}")
    for name in inputs:
        if name not in table.columns:
            raise InputError(f"{table.source}: {name}: missing; {needs}")
    if not any(name in measured for name in table.columns):
        raise InputError(f"{table.source}: no measured quantity; known are {', '.join(study.outputs)}")


def _combinations(table: Table, study: Study) -> list[dict[str, str]]:
    """Return the categories of every row."""
    for name, allowed in study.categories.items():
        for row, value in enumerate(table.columns[name].tolist()):
            if value not in allowed:
                shown = "empty" if value is None else repr(value)
                raise InputError(f"{table.at(row)}: {name}: {shown}; must be one of {', '.join(allowed)}")
    columns = [table.columns[name].tolist() for name in study.categories]
    return [dict(zip(study.categories, names, strict=True)) for names in zip(*columns, strict=True)] or [{}] * len(
        table.lines
    )


def _measured(table: Table, name: str) -> NDArray[np.bool_]:
    """Return whether each row has a quantity, (row,), and refuse errors that are not positive."""
    if name not in table.columns:
        return np.zeros(len(table.lines), dtype=bool)
    measured = ~table.empty(name)
    if (column := f"{name}{ERROR}") in table.columns:
        error = table.columns[column]
        bad = (error <= 0) | (~measured & ~np.isnan(error))
        if bad.any():
            row = int(bad.argmax())
            why = "must be a positive number, or empty" if measured[row] else f"without a value of {name}"
            raise InputError(f"{table.at(row)}: {column}: {error[row]:g}: {why}")
    return measured


#: Name of the corrected surrogate, beside the one that it was made from, where none is given.
CORRECTED = "corrected.nc"


def learn(options: argparse.Namespace) -> None:
    """Learn from measured rows, write the corrected surrogate and print what was learned, as the options say."""
    trained(options.on)
    path = output(options.output or options.on.with_name(CORRECTED), options.on, options.measured)
    study, model = questions.results(options.on.parent, options.on)
    if isinstance(model, CorrectedGP):
        raise InputError(f"{options.on}: is corrected already; learn from all rows at once, on the surrogate before")
    rows = read_measured(options.measured, study, model)
    constants = uncertainty.uncertain(study, _uncertain(options.uncertain))
    with located(options.measured, InputError):
        corrected, summary = correction.learn(study, model, rows, constants, say)
    save(corrected, path)
    words = "\n".join(map(one_line, correction.in_words(summary)))
    print(json.dumps(summary, indent=2, allow_nan=False) if options.json else words)
    say(f"wrote {path}: `meecontact query {path}` answers with it")


def _uncertain(words: list[str] | None) -> dict[str, float | None] | None:
    """Return prior standard deviations by name from ``NAME`` or ``NAME=5%`` between commas; None without any."""
    texts = named("--uncertain", words)
    return {name: _share(name, text) if text else None for name, text in texts.items()} or None


def _share(name: str, text: str) -> float:
    plain = text.removesuffix("%")
    try:
        share = number(plain) * (0.01 if plain != text else 1.0)
    except ValueError:
        share = -1.0
    if not 0 < share <= 0.5:
        raise InputError(f"--uncertain: {name}: {text!r} is not a number above 0 and up to 0.5 (50 %)")
    return share
