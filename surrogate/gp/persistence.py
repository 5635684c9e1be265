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
from surrogate.gp.model import GaussianProcess

FORMAT = "surrogate"
VERSION = 2
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
    """
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
    write_whole(described(whole, f"surrogate of {', '.join(outputs)}"[:200], SOURCE, MEANINGS), path)


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
    """
    try_to_read(path, MAX_BYTES)
    stored = read_whole(path, max_bytes=MAX_BYTES)
    attrs = stored.attrs
    if attrs.get("format") != FORMAT:
        raise FormatError(path, "not a surrogate model")
    if attrs.get("format_version") != VERSION:
        raise FormatError(
            path,
            f"format version {attrs.get('format_version')} is not {VERSION}, the one known here: make the model anew",
        )
    if attrs.get("engine") not in ENGINES:
        raise FormatError(path, f"unknown engine {attrs.get('engine')!r}; known are {', '.join(ENGINES)}")
    try:
        _check_numbers(stored)
        model = engine(attrs["engine"]).restored(stored, _inputs(stored), _outputs(stored))
        model.made_from_ = str(attrs.get("made_from", ""))
        points = stored["probe_point"].transpose("probe", "input").values
        mean, std = model.predict_array(points, return_std=True)
        ends = model.interval_array(points)
    except FAILURES as error:
        raise FormatError(path, f"inconsistent: {error}") from error
    for part, found in zip(("mean", "std", "lower", "upper"), (mean, std, *ends), strict=True):
        name = f"probe_{part}"
        expected = stored[name].transpose("probe", "output").values
        room = PROBE_TOLERANCE * (np.abs(expected) + np.ptp(stored["probe_mean"].values, axis=0))
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
