"""Models as data: netCDF files with everything that a prediction needs, nothing of which is executed."""

from os import PathLike
from typing import Any

import numpy as np
import xarray as xr

from storage.described import described
from storage.netcdf import FAILURES, read_whole, write_whole
from storage.quarantine import try_to_read
from storage.sealed import FormatError
from surrogate.data.arrays import Array
from surrogate.data.inputs import Input
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.gp.engines import ENGINES, engine
from surrogate.gp.model import SMALLEST, GaussianProcess

FORMAT = "surrogate"
VERSION = 3
MAX_BYTES = 2**28  # unpacked; a model is a few MB at most, and a hostile file must not fill the memory
PROBES = 8
PROBE_TOLERANCE = 1e-7


def save(model: GaussianProcess, path: str | PathLike[str]) -> None:
    """Write a fitted model to a netCDF-4 file, whole or not at all; the same model gives the same bytes.

    Raises
    ------
    FileNotFoundError
        The folder does not exist.
    OSError
        No room or no permission, in the system's words, with the file.

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
    title = f"surrogate of {', '.join(model.outputs_)}"[:200]
    write_whole(described(_stored(model), title, SOURCE, MEANINGS), path)


def _stored(model: GaussianProcess) -> xr.Dataset:
    """A model and the models that it is made of as one data set."""
    inputs, outputs = model.inputs_, model.outputs_
    points = probe_points(inputs)
    mean, std = model.predict_array(points, return_std=True)
    lower, upper = model.interval_array(points)
    common = xr.Dataset(
        {
            "low": ("input", [one.low for one in inputs]),
            "high": ("input", [one.high for one in inputs]),
            "scale": ("input", [one.scale for one in inputs]),
            "input_units": ("input", [one.units for one in inputs]),
            "input_long_name": ("input", [one.long_name for one in inputs]),
            "output_units": ("output", [model.attrs_[name].get("units", "") for name in outputs]),
            "output_long_name": ("output", [model.attrs_[name].get("long_name", "") for name in outputs]),
            "probe_point": (("probe", "input"), points),
            "probe_mean": (("probe", "output"), mean),
            "probe_std": (("probe", "output"), std),
            "probe_lower": (("probe", "output"), lower),
            "probe_upper": (("probe", "output"), upper),
        },
        coords={"input": [one.name for one in inputs], "output": list(outputs)},
        attrs={"format": FORMAT, "format_version": VERSION, "engine": model.engine},
    )
    if model.made_from_:
        common.attrs["made_from"] = model.made_from_
    whole = common.merge(model.stored(), combine_attrs="no_conflicts")
    for name, member in model.members.items():
        whole = whole.merge(_prefixed(name, _stored(member)), combine_attrs="no_conflicts")
    return whole


def _prefixed(name: str, member: xr.Dataset) -> xr.Dataset:
    """A member's data set under names that begin with its own, as do their meanings."""
    told = described(member, "", "", MEANINGS)
    for variable in told.variables.values():
        variable.attrs["long_name"] = f"{name} model: {variable.attrs.get('long_name', '')}"
    renamed = told.rename({one: f"{name}_{one}" for one in {*told.variables, *told.dims}})
    renamed.attrs = {f"{name}_{key}": value for key, value in member.attrs.items()}
    return renamed


def _member(name: str, stored: xr.Dataset) -> xr.Dataset:
    """What `_prefixed` was made from."""
    prefix = f"{name}_"
    own = stored.drop_vars([one for one in stored.variables if not str(one).startswith(prefix)])
    plain = own.rename({one: str(one).removeprefix(prefix) for one in {*own.variables, *own.dims}})
    attrs = {str(key): value for key, value in stored.attrs.items()}
    return plain.assign_attrs({key.removeprefix(prefix): one for key, one in attrs.items() if key.startswith(prefix)})


def load(path: str | PathLike[str]) -> GaussianProcess:
    """Read a model, which may come from anywhere, and verify it.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    FormatError
        One line with the file and the reason: truncated, altered, too large, more than plain numbers and texts, not a
        model, of an unknown version, engine or kernel, inconsistent in its shapes, or its probe predictions do not come
        out as stored.

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
    try_to_read(path, MAX_BYTES)
    stored = read_whole(path, max_bytes=MAX_BYTES)
    return _restored(path, stored, tuple(ENGINES))


def _restored(path: str | PathLike[str], stored: xr.Dataset, engines: tuple[str, ...]) -> GaussianProcess:
    """The verified model of a data set; FormatError as for `load`."""
    attrs = stored.attrs
    if attrs.get("format") != FORMAT:
        raise FormatError(path, "not a surrogate model")
    if attrs.get("format_version") != VERSION:
        raise FormatError(
            path,
            f"format version {attrs.get('format_version')} is not {VERSION}, the one known here: make the model anew",
        )
    if attrs.get("engine") not in engines:
        raise FormatError(path, f"unknown engine {attrs.get('engine')!r}; known are {', '.join(engines)}")
    kind = engine(attrs["engine"])
    try:
        _check_numbers(stored)
        # what a model is made of is not made of others in turn
        simple = tuple(name for name in engines if not engine(name).MEMBERS) if kind.MEMBERS else ()
        members = {name: _restored(path, _member(name, stored), simple) for name in kind.MEMBERS}
        model = kind.restored(stored, _inputs(stored), _outputs(stored)).with_members(members)
        model.made_from_ = str(attrs.get("made_from", ""))
        points = stored["probe_point"].transpose("probe", "input").values
        mean, std = model.predict_array(points, return_std=True)
        ends = model.interval_array(points)
    except FormatError:
        raise
    except FAILURES as error:
        raise FormatError(path, f"inconsistent: {error}") from error
    for part, found in zip(("mean", "std", "lower", "upper"), (mean, std, *ends), strict=True):
        name = f"probe_{part}"
        expected = stored[name].transpose("probe", "output").values
        room = PROBE_TOLERANCE * (np.abs(expected) + np.ptp(stored["probe_mean"].values, axis=0)) + SMALLEST
        if found.shape != expected.shape or not (np.abs(found - expected) <= room).all():
            raise FormatError(path, f"the stored predictions {name} do not come out again")
    return model


def probe_points(inputs: tuple[Input, ...]) -> Array:
    """Return a few points spread over the box, (PROBES, d): a Kronecker sequence."""
    steps = np.sqrt(np.arange(2, 2 + len(inputs)) + 0.618)
    share = (np.arange(1, PROBES + 1)[:, None] * steps) % 1
    return np.stack([one.from_unit(2 * share[:, k] - 1) for k, one in enumerate(inputs)], axis=1)


def _inputs(stored: xr.Dataset) -> tuple[Input, ...]:
    columns = [
        stored[name].values.tolist() for name in ("input", "low", "high", "scale", "input_units", "input_long_name")
    ]
    if len(set(columns[0])) != len(columns[0]) or not columns[0]:
        raise ValueError("input names must be unique")
    return tuple(Input(*row) for row in zip(*columns, strict=True))


def _outputs(stored: xr.Dataset) -> dict[str, dict[str, str]]:
    attrs: dict[str, dict[str, str]] = {}
    for name in stored["output"].values.tolist():
        found = stored.sel(output=name)
        every: dict[str, Any] = {key: found[f"output_{key}"].item() for key in ("units", "long_name")}
        attrs[name] = {key: text for key, text in every.items() if text}
    return attrs


def _check_numbers(stored: xr.Dataset) -> None:
    for name, variable in stored.variables.items():
        if variable.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise ValueError(f"variable {name!r} is not finite")
