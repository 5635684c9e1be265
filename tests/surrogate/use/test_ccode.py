"""Surrogates exported as C agree with Python to the error asked for, and answer nothing where they know nothing."""

import zipfile
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from functools import cache
from io import BytesIO
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr

from approximation.arrays import Array
from surrogate import GaussianProcess, GridGP, Input, ScatterGP
from surrogate.use import fmu
from surrogate.use.ccode import code
from surrogate.use.rounding import Rounded, rounded
from tests.compiled import Compiled
from tests.surrogate import curved, functions, grouped
from tests.surrogate.functions import inside

gcc = pytest.mark.needs("gcc")


@cache
def of_two_inputs() -> GaussianProcess:
    inputs = (Input("x", -1.0, 1.0), Input("y", 0.5, 2.0))

    def with_outputs(cases: xr.Dataset) -> xr.Dataset:
        return cases.assign(steep=np.exp(-3 * cases.x * cases.y), wave=np.sin(3 * cases.x) * cases.y)

    model = GridGP(inputs=inputs).fit(with_outputs(functions.grid(inputs, (9, 6))))
    return model.calibrate(with_outputs(functions.drawn(inputs, 1500, seed=1)))


@cache
def of_one_input() -> GaussianProcess:
    """Neither calibrated nor with pairs of inputs; a name that would end a comment."""
    share = Input("share", 0.1, 0.9, "logit", "*/ m", "a\\?")
    grid = xr.Dataset(
        {"f": ("share", np.sin(share.levels(9))), "1": ("share", np.zeros(9))}, {"share": share.levels(9)}
    )
    return GridGP(inputs=[share]).fit(grid)


def exported(
    model: GaussianProcess, outputs: Sequence[str], folder: Path, arithmetic: type[np.floating[Any]], error: float
) -> tuple[list[Rounded], Path]:
    parts = rounded(model, outputs, error, arithmetic)
    for file, text in code("model", parts, arithmetic, ["a note */"]).items():
        (folder / file).write_text(text, encoding="ascii")
    return parts, folder / "model.c"


@gcc
@pytest.mark.parametrize(
    ("model_of", "outputs", "arithmetic", "error"),
    [
        (grouped.calibrated, ["length", "cold", "depth"], np.float64, 1e-5),
        (of_two_inputs, ["steep", "wave"], np.float64, 1e-5),
        (of_one_input, ["f", "1"], np.float64, 1e-5),
        (grouped.calibrated, ["length", "cold"], np.float32, 1e-3),
    ],
)
def test_c_says_what_python_says(
    model_of: Callable[[], GaussianProcess],
    outputs: Sequence[str],
    arithmetic: type[np.floating[Any]],
    error: float,
    tmp_path: Path,
) -> None:
    model = model_of()
    parts, source = exported(model, outputs, tmp_path, arithmetic, error)
    compiled = Compiled(source, "-O2")
    assert compiled.selftest() == 0
    ends = np.array([(axis.low, axis.high) for axis in model.inputs_]).T.astype(arithmetic).astype(float)
    X = np.clip(inside(model.inputs_, 2000, 5, 1.2).astype(arithmetic).astype(float), *ends)
    status, _ = compiled.asked("inside", X)
    assert not status.any()
    for k, part in enumerate(parts):
        assert part.error <= error
        assert_agrees(compiled, part, k, X, 1.1 * error * part.size, 1e-3 if arithmetic == np.float32 else 1e-7)


def assert_agrees(compiled: Compiled, part: Rounded, output: int, X: Array, room: float, digits: float) -> None:
    """Values, ends and derivatives: those of the exact model within the room, those of the rounded one to digits."""
    values, ends, slopes = (compiled.asked(which, X, output)[1] for which in ("value", "interval", "gradient"))
    exact, narrow = (model.predict_array(X, extrapolate=True)[:, 0] for model in (part.exact, part.model))
    result = values[:, 0]
    assert np.abs(result - exact).max() <= room
    assert np.abs(result - narrow).max() <= digits * part.size
    np.testing.assert_array_equal(ends[:, 0], values[:, 0])
    lower, upper = (end[:, 0] for end in part.exact.interval_array(X, extrapolate=True))
    slack = 1e-6 * part.size + 1e-4 * (upper - lower) if digits > 1e-6 else 1e-5 * (upper - lower) + 1e-9 * part.size
    for wider, end in ((lower - ends[:, 1], lower), (ends[:, 2] - upper, upper)):
        assert (wider >= -slack).all(), end
        assert (wider <= 2 * room + slack).mean() > 0.99, end  # where slabs meet, the larger guard counts
    box = [(axis.low, axis.high) for axis in part.model.inputs_]
    expected = part.model.gradient_array(np.clip(X, *np.transpose(box)))[:, 0]  # ends in single precision
    size = np.abs(expected).max(axis=0)
    assert (np.abs(slopes - expected).max(axis=0) <= 30 * digits * size).all()


@gcc
def test_where_slabs_meet_rounding_narrows_no_interval(tmp_path: Path) -> None:
    ((name, grid),) = grouped.calibrated().members.items()
    grid, random = copy(grid), np.random.default_rng(2)
    assert grid.calibration_ is not None
    assert grid.calibration_.outer is not None
    outer = grid.calibration_.outer
    outer = replace(outer, slabs=random.uniform(0.0, 1.0, outer.slabs.shape))
    grid.calibration_ = replace(grid.calibration_, outer=outer)
    model = grouped.calibrated().over({name: grid})
    (part,), source = exported(model, ["depth"], tmp_path, np.float64, 1e-5)
    t = random.integers(0, 11, (len(model.inputs_), 2000)) / 5 - 1
    X = np.stack([axis.from_unit(row) for axis, row in zip(model.inputs_, t, strict=True)], axis=1)
    lower, upper = (end[:, 0] for end in part.exact.interval_array(X))
    ends = Compiled(source, "-O2").asked("interval", X)[1]
    assert (ends[:, 1] <= lower).all()
    assert (ends[:, 2] >= upper).all()


#: Numbers that are no points, a denormal within the range of an input, and numbers outside.
ODD = [np.nan, np.inf, -np.inf, 5e-324, -2.2e-308, 1e300, -3.0]


@gcc
def test_optimisations_change_no_bit_and_what_is_no_point_has_a_status_and_no_number(tmp_path: Path) -> None:
    _, source = exported(of_two_inputs(), ["steep", "wave"], tmp_path, np.float64, 1e-5)
    plain, quick, fast = (Compiled(source, *flags) for flags in (["-O0"], ["-O2"], ["-O2", "-ffast-math"]))
    points = inside(of_two_inputs().inputs_, 1000, 5, 1.2)
    for output, part in product(range(2), ("interval", "gradient")):
        same, other = (library.asked(part, points, output)[1] for library in (quick, fast))
        np.testing.assert_array_equal(plain.asked(part, points, output)[1], same)
        assert np.abs(other - same).max() <= 1e-6 * np.abs(same).max()
    assert [library.selftest() for library in (plain, quick, fast)] == [0, 0, 0]
    outside, abnormal, none = (quick.constants[word] for word in ("OUTSIDE", "NOT_NORMAL", "NO_OUTPUT"))
    for library, place, part in product((quick, fast), range(2), ("inside", "value", "interval", "gradient")):
        odd = np.repeat(points[:1], len(ODD), axis=0)
        odd[:, place] = ODD
        status, answers = library.asked(part, odd)
        assert status.tolist() == [abnormal] * 5 + [outside] * 2
        assert np.isnan(answers).all()
    for output in (-1, 2):
        status, answers = quick.asked("value", points[:1], output)
        assert status.tolist() == [none]
        assert np.isnan(answers).all()


@cache
def of_scattered_cases() -> GaussianProcess:
    x = np.linspace(0, 1, 6)
    return ScatterGP([Input("x", 0, 1)]).fit(xr.Dataset({"x": ("case", x), "y": ("case", x**2)}))


@pytest.mark.parametrize(
    ("model_of", "output", "error", "says"),
    [
        (of_scattered_cases, "y", 1e-5, r"the surrogate is a ScatterGP \(engine 'scatter'\); exported are GridGP"),
        (curved.fitted, "top", 1e-5, r"largest values of curves have no short form; exported are plain"),
        (of_one_input, "f", 1e-9, r"error 1e-09 is not reached for 'f' in single precision: at best [1-9]"),
    ],
)
def test_outputs_without_a_short_form_of_the_precision_are_refused(
    model_of: Callable[[], GaussianProcess], output: str, error: float, says: str
) -> None:
    with pytest.raises(ValueError, match=says):
        rounded(model_of(), [output], error, np.float32)


def test_smooth_outputs_beside_curves_are_exported() -> None:
    model = curved.fitted()
    (part,) = rounded(model, ["plain"], 1e-5, np.float64)
    X, place = inside(model.inputs_, 500, 5, 1.2), model.outputs_.index("plain")
    mean, std = part.exact.predict_array(X, return_std=True)
    for alone, together in zip((mean, std), model.predict_array(X, return_std=True), strict=True):
        np.testing.assert_allclose(alone[:, 0], together[:, place], rtol=1e-6, atol=1e-9 * part.size)
    assert np.abs(part.model.predict_array(X)[:, 0] - mean[:, 0]).max() <= 1.1e-5 * part.size


def test_an_fmu_names_each_variable_once_whatever_the_names(monkeypatch: pytest.MonkeyPatch) -> None:
    time = Input("time", 0.0, 1.0, "linear", "<s>", 'a "b"\x01&')
    grid = xr.Dataset({"status": ("time", time.levels(3)), "time_": ("time", time.levels(3))}, {"time": time.levels(3)})
    parts = rounded(GridGP(inputs=[time]).fit(grid), ["status", "time_"], 1e-5, np.float64)
    monkeypatch.setattr("shutil.which", lambda name: None)
    content, compiled = fmu.unit("model", parts, np.float64, [], "a test")
    assert not compiled
    with zipfile.ZipFile(BytesIO(content)) as archive:
        assert all(name.startswith(("sources/", "modelDescription")) for name in archive.namelist())
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    variables = [variable.attrib for variable in root.iterfind("ModelVariables/*")]
    ends = "status_", "status_lower", "status_upper", "time__", "time__lower", "time__upper"
    assert [variable["name"] for variable in variables] == ["time", "time_", *ends, "status"]
    assert [int(variable["valueReference"]) for variable in variables] == list(range(9))
    assert (variables[1]["unit"], variables[1]["description"]) == ("<s>", 'a "b"_&')
    assert fmu.unit("model", parts, np.float64, [], "a test")[0] == content
