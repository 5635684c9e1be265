"""``meecontact query``: predictions of a surrogate, printed or as a table, with exact answers on request."""

import argparse
from math import floor, isfinite, log10
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

import surrogate
from solver.units import prefixed
from storage.files import output, writing
from surrogate import GaussianProcess, OutOfBoxError
from surrogate.data.points import outside
from surrogate.intervals.distribution import NOMINAL
from workflow.cli.casetable import Table, one_case, read_cases
from workflow.cli.textfile import write_columns
from workflow.cli.words import say, trained
from workflow.language.spelling import nearest
from workflow.study.reading import InputError, located, one_line

if TYPE_CHECKING:
    from workflow.study.model import Study

#: Digits of a number without an interval, and the fewest and most with one.
_DIGITS, _WRITTEN_FEWEST, _WRITTEN_MOST = 10, 4, 15


def query(options: argparse.Namespace) -> None:
    """Print the answer at one point, or write a table of answers, as the options say."""
    model = surrogate.load(trained(options.surrogate))
    if (options.table is None) == (options.at is None):
        raise InputError("query: give either a table AT.csv or --at NAME=VALUE,...")
    if options.table is not None and options.output is None:
        raise InputError("query: a table needs -o OUT.csv")
    if options.output is not None:
        options.output = output(options.output, options.surrogate, *filter(None, [options.table]))
    inputs = {name: axis.units for name, axis in model.box.items()}
    table = read_cases(options.table) if options.at is None else one_case("--at", options.at, inputs)
    with located("--level"):
        level = model.checked_level(options.level)
    answer = _predicted(model, table, level, extrapolate=options.extrapolate)
    if not model.calibrated:
        say(f"not calibrated: this surrogate's intervals may hold far less than {100 * level:g} %")
    if options.exact is not None:
        answer = _with_exact(answer, model, table, study_of(model, options.exact))
    if options.output is None:
        _print_answer(answer, list(model.outputs_), level, si=options.si)
    else:
        flags = answer.assign({name: flag.astype(int) for name, flag in answer.items() if flag.dtype == bool})
        with writing(options.output) as file:
            write_columns(file, table.columns | {str(name): array.values for name, array in flags.items()})
        say(f"wrote {options.output}: {answer.sizes['point']} points, {len(model.outputs_)} outputs")


def _predicted(model: GaussianProcess, table: Table, level: float, *, extrapolate: bool) -> xr.Dataset:
    """Return ``<output>``, ``<output>_std``, ``_lower`` and ``_upper`` of every output at every row, over ``point``."""
    for name in table.columns:
        if name not in model.box:
            raise InputError(f"{table.source}: {name}: not an input of the surrogate; {nearest(name, list(model.box))}")
    columns = {name: table.numbers(name, f"the surrogate needs {', '.join(model.box)}") for name in model.box}
    named = {name: xr.DataArray(column, dims="point") for name, column in columns.items()}
    X = np.stack(list(columns.values()), axis=1)
    wrong = outside(X, model.inputs_)
    try:
        with np.errstate(all="ignore"):  # what is not finite is named below
            answer = model.predict(named, extrapolate=extrapolate)
            answer = answer.assign(model.interval(named, level, extrapolate=extrapolate).data_vars)
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
    names = [f"{name}{part}" for name in model.outputs_ for part in ("", "_std", "_lower", "_upper")]
    return answer[names + (["extrapolated"] if extrapolate else [])]


def study_of(model: GaussianProcess, text: str) -> "Study":
    """Return the study of a surrogate, by its name or its file."""
    from workflow.study import location  # and the solver: not for every query
    from workflow.study import model as studies

    study = studies.named(location.given(text))
    if set(model.box) != set(study.factors):
        raise InputError(
            f"--exact: the study's factors are {', '.join(study.factors)}; the surrogate's {', '.join(model.box)}"
        )
    if model.made_from_ not in ("", study.physics):  # "": not recorded
        raise InputError(f"--exact: {study.path}: the surrogate was made from another study, or another state of it")
    return study


def _with_exact(answer: xr.Dataset, model: GaussianProcess, table: Table, study: "Study") -> xr.Dataset:
    """Return the answer with ``<output>_exact`` of every output."""
    from workflow.dataset import factorial

    points = {name: xr.DataArray(values, dims="point") for name, values in table.columns.items()}
    exact = factorial.training_data(study, factorial.exact(study, points))
    return answer.assign({f"{name}_exact": exact[name] for name in model.outputs_})


def _print_answer(answer: xr.Dataset, outputs: list[str], level: float, *, si: bool) -> None:
    if "extrapolated" in answer and bool(answer["extrapolated"].values[0]):
        print("extrapolated: the point lies outside the trained box; its intervals are not to be trusted")
    units = {name: str(answer[name].attrs.get("units", "")) for name in outputs}
    ends = {name: [float(answer[f"{name}{part}"].values[0]) for part in ("", "_lower", "_upper")] for name in outputs}
    lines = {
        name: f"{name:34s} {shown(value, lower, upper, units[name], level, si=si)}"
        for name, (value, lower, upper) in ends.items()
    }
    length = max(map(len, lines.values()))
    for name, line in lines.items():
        exact = ""
        if f"{name}_exact" in answer:
            value = float(answer[f"{name}_exact"].values[0])
            scale, text = (1.0, units[name]) if si else prefixed(abs(value), units[name])
            exact = f"  exact {value / scale:.10g} {text}"
        print(one_line(f"{line:{length}s}{exact}").rstrip())


def shown(
    value: float, lower: float, upper: float, units: str = "", level: float = NOMINAL, *, si: bool = False
) -> str:
    """Return ``value [lower, upper] unit (95 %)`` with two digits of the interval's half width."""
    scale, text = (1.0, units) if si else prefixed(max(abs(lower), abs(upper)), units)
    value, lower, upper = value / scale, lower / scale, upper / scale
    count = _digits(max(abs(lower), abs(upper)), (upper - lower) / 2)
    zeros = "#" if upper > lower else ""  # an exact value needs no trailing zeros
    middle, low, high = (f"{number:{zeros}.{count}g}".rstrip(".") for number in (value, lower, upper))
    return f"{f'{middle} [{low}, {high}] {text}'.rstrip()} ({100 * level:g} %)"


def _digits(size: float, half_width: float) -> int:
    if not (isfinite(size) and half_width > 0):
        return _DIGITS
    return min(max(floor(log10(size)) - floor(log10(half_width)) + 2, _WRITTEN_FEWEST), _WRITTEN_MOST)
