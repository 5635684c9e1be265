"""Models in netCDF files: all data of a prediction, nothing of which is executed."""

import re
from importlib import import_module
from os import PathLike
from pathlib import Path

import numpy as np
import xarray as xr

from approximation.arrays import Array
from storage.described import described
from storage.netcdf import FAILURES, read_whole, write_whole
from storage.quarantine import little_memory, try_to_read
from storage.sealed import FormatError
from surrogate.data.factorial import MOST_OF_A_FACTOR
from surrogate.data.inputs import COLUMNS, Input, physical_points, stored_inputs
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.face.model import SMALLEST, GaussianProcess
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.distribution import NOMINAL

FORMAT = "surrogate"
VERSION = 4
MAX_BYTES = 2**28  # unpacked; a model is a few MB at most, and a hostile file must not fill the memory
_DENSEST, _SMALL = 100, 2**22  # a file may unpack to so many times its size, or to so many bytes
PROBES = 8
_PROBE_DIMS = {"point": ("probe", "input")} | dict.fromkeys(("mean", "std", "lower", "upper"), ("probe", "output"))
PROBE_TOLERANCE = 1e-7
#: Module and class of every kind of model. The members of a kind are of earlier kinds.
ENGINES = {
    "grid": ("gp.gridgp", "GridGP"),
    "scatter": ("gp.scattergp", "ScatterGP"),
    "grouped": ("transforms.groupedgp", "GroupedGP"),
    "curves": ("transforms.curves.curvegp", "CurveGP"),
    "corrected": ("transforms.measured", "CorrectedGP"),
}
_LEVELS = r"level_\d+"
#: Longest dimensions of a model or a member: matrices over levels and over cases are decomposed.
MOST = {_LEVELS: MOST_OF_A_FACTOR, "case": 3000, "input": 100, "output": 10_000}
_ALL_LEVELS = 2 * MOST_OF_A_FACTOR  # of all factors together


def save(model: GaussianProcess, path: str | PathLike[str]) -> None:
    """Write a fitted model to a netCDF-4 file, whole or not at all; the same model gives the same bytes.

    Parameters
    ----------
    model : GaussianProcess
    path : str or path

    Raises
    ------
    FileNotFoundError
        The folder does not exist.
    OSError
        No room or no permission, in the system's words, with the file.
    ValueError
        More levels, cases or outputs than `load` reads.

    Examples
    --------
    >>> import tempfile, surrogate
    >>> from pathlib import Path
    >>> made = surrogate.FactorialRegressor().fit([[0.0], [0.5], [1.0]], [1.0, 1.5, 3.0]).model_
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(made, Path(folder) / "y.nc")
    ...     [file.name for file in Path(folder).iterdir()]
    ['y.nc']
    """
    points = probe_points(model.inputs_)
    probes = {"point": points, **_answers(model, points)}
    whole = nested(model).assign({f"probe_{name}": (_PROBE_DIMS[name], values) for name, values in probes.items()})
    title = f"surrogate of {', '.join(model.outputs_)}"[:200]
    whole.attrs |= {"format": FORMAT, "format_version": VERSION}
    check_sizes(whole)
    write_whole(described(whole, title, SOURCE, MEANINGS), path)


def nested(model: GaussianProcess) -> xr.Dataset:
    """Return a model with its members as one data set: inputs, outputs, state and calibration of each.

    The names of a member's variables begin with the member's name: `smooth_reduced_core_0` is the first core of the
    member `reduced` of the member `smooth`.
    """
    inputs, outputs, members = model.inputs_, model.outputs_, model.members
    whole = xr.Dataset(
        {
            **{
                column: ("input", [getattr(input_, part) for input_ in inputs])
                for column, part in COLUMNS.items()
                if column != "input"  # a coordinate
            },
            "output_units": ("output", [model.attrs_[name].get("units", "") for name in outputs]),
            "output_long_name": ("output", [model.attrs_[name].get("long_name", "") for name in outputs]),
        },
        coords={"input": [input_.name for input_ in inputs], "output": list(outputs)},
        attrs={"engine": model.engine, "cases": model.cases_},
    )
    if model.level_ != NOMINAL:
        whole.attrs["level"] = model.level_
    if model.made_from_:
        whole.attrs["made_from"] = model.made_from_
    whole = whole.merge(model.state(), combine_attrs="no_conflicts")
    learnt = model.calibration_
    if learnt is not None and not any(member.calibration_ is learnt for member in members.values()):
        whole = whole.assign(learnt.state())
    for name, member in members.items():
        whole = whole.merge(_prefixed(name, nested(member)), combine_attrs="no_conflicts")
    return whole


def _prefixed(name: str, member: xr.Dataset) -> xr.Dataset:
    """Return a member's data set with the member's name before all names and long names."""
    description = described(member, "", "", MEANINGS)
    for variable in description.variables.values():
        variable.attrs["long_name"] = f"{name} model: {variable.attrs.get('long_name', '')}"
    renamed = description.rename({part: f"{name}_{part}" for part in {*description.variables, *description.dims}})
    renamed.attrs = {f"{name}_{key}": value for key, value in member.attrs.items()}
    return renamed


def _member(name: str, stored: xr.Dataset) -> xr.Dataset:
    """Undo `_prefixed`."""
    prefix = f"{name}_"
    member_variables = stored.drop_vars([part for part in stored.variables if not str(part).startswith(prefix)])
    plain = member_variables.rename(
        {part: str(part).removeprefix(prefix) for part in {*member_variables.variables, *member_variables.dims}}
    )
    attrs = {str(key): value for key, value in stored.attrs.items()}
    member_attrs = {key.removeprefix(prefix): value for key, value in attrs.items() if key.startswith(prefix)}
    return plain.assign_attrs(member_attrs)


def _answers(model: GaussianProcess, points: Array) -> dict[str, Array]:
    """Return means, standard deviations and ends of intervals at points (n, d): (n, p) each."""
    mean, std = model.predict_array(points, return_std=True, extrapolate=True)
    lower, upper = model.interval_array(points, NOMINAL, extrapolate=True)
    return {"mean": mean, "std": std, "lower": lower, "upper": upper}


def load(path: str | PathLike[str]) -> GaussianProcess:
    """Read a model, which may come from anywhere, and verify it.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    FormatError
        One line with the file and the reason: truncated, altered, too large, other contents than plain numbers and
        texts, not a model, an unknown version, engine or kernel, inconsistent shapes, or other probe predictions than
        those stored.

    Examples
    --------
    >>> import tempfile, surrogate
    >>> from pathlib import Path
    >>> made = surrogate.FactorialRegressor().fit([[0.0], [0.5], [1.0]], [1.0, 1.5, 3.0]).model_
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     surrogate.save(made, Path(folder) / "y.nc")
    ...     again = load(Path(folder) / "y.nc")
    >>> bool(again.predict({"x0": 0.3})["y0"] == made.predict({"x0": 0.3})["y0"])
    True
    """
    file = Path(path)
    most = min(MAX_BYTES, max(_DENSEST * file.stat().st_size, _SMALL)) if file.is_file() else MAX_BYTES
    try_to_read(file, most)
    stored = read_whole(file, max_bytes=most)
    attrs = stored.attrs
    if attrs.get("format") != FORMAT:
        raise FormatError(path, "not a surrogate model")
    if attrs.get("format_version") != VERSION:
        raise FormatError(
            path, f"format version {attrs.get('format_version')} is not {VERSION}, the one known here: `make run` anew"
        )
    try:
        check_sizes(stored)
        for name, variable in stored.variables.items():
            if variable.dtype.kind == "f" and not np.isfinite(variable.values).all():
                raise ValueError(f"variable {name!r} is not finite")
        with little_memory(file):
            model = restored(stored, tuple(ENGINES))
            answers = _answers(model, stored["probe_point"].transpose("probe", "input").values)
    except FAILURES as error:
        raise FormatError(path, f"inconsistent: {error}") from error
    for part, answer in answers.items():
        expected = stored[f"probe_{part}"].transpose("probe", "output").values
        room = PROBE_TOLERANCE * (np.abs(expected) + np.ptp(stored["probe_mean"].values, axis=0)) + SMALLEST
        if answer.shape != expected.shape or not (np.abs(answer - expected) <= room).all():
            raise FormatError(path, f"the stored predictions probe_{part} do not come out again")
    return model


def restored(stored: xr.Dataset, engines: tuple[str, ...]) -> GaussianProcess:
    """Undo `nested`; ValueError names what is inconsistent, KeyError what is missing."""
    name, inputs, outputs = str(stored.attrs["engine"]), stored_inputs(stored), _outputs(stored)
    if name not in engines:
        raise ValueError(f"unknown engine {name!r}; known are {', '.join(engines)}")
    module, class_name = ENGINES[name]
    kind: type[GaussianProcess] = getattr(import_module(f"surrogate.{module}"), class_name)
    earlier = engines[: engines.index(name)]
    members = {member: restored(_member(member, stored), earlier) for member in kind.MEMBERS}
    model = kind.restore(stored, inputs, outputs)
    model.calibration_, model.cases_ = None, int(stored.attrs["cases"])
    model.made_from_ = str(stored.attrs.get("made_from", ""))
    model = model.over(members)
    model.level_ = float(stored.attrs.get("level", NOMINAL))
    own_calibration = Calibration.restore(stored, model.parts, len(inputs), len(outputs))
    if own_calibration is not None:
        model.calibration_ = own_calibration
    model.check_level(model.level_)
    return model


def probe_points(inputs: tuple[Input, ...]) -> Array:
    """Return a Kronecker sequence of points in the box, (PROBES, d)."""
    steps = np.sqrt(np.arange(2, 2 + len(inputs)) + 0.618)
    share = (steps[:, None] * np.arange(1, PROBES + 1)) % 1
    return physical_points(inputs, 2 * share - 1)


def _outputs(stored: xr.Dataset) -> dict[str, dict[str, str]]:
    names, units, meanings = (stored[key].values for key in ("output", "output_units", "output_long_name"))
    if len({len(names), len(units), len(meanings), len(set(names.tolist()))}) != 1:
        raise ValueError("output names must be unique, each with its units and its meaning")
    return {
        name: {key: text for key, text in (("units", unit), ("long_name", meaning)) if text}
        for name, unit, meaning in zip(names.tolist(), units.tolist(), meanings.tolist(), strict=True)
    }


def check_sizes(stored: xr.Dataset) -> None:
    """Raise ValueError, naming dimension and length, if a dimension is longer than `load` accepts."""
    for kind, most in MOST.items():
        for name, length in _lengths(stored, kind).items():
            if length > most:
                raise ValueError(f"{name} is {length} long; a model in a file has at most {most}")
    if (levels := sum(_lengths(stored, _LEVELS).values())) > _ALL_LEVELS:
        raise ValueError(f"{levels} levels of all factors; a model in a file has at most {_ALL_LEVELS}")


def _lengths(stored: xr.Dataset, kind: str) -> dict[str, int]:
    return {str(name): size for name, size in stored.sizes.items() if re.fullmatch(rf"(?:.*_)?{kind}", str(name))}
