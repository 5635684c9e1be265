"""The contract of every model: its file, its parts, its derivatives, one point in every way of asking, wrong files."""

import os
import re
import resource
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import netCDF4
import numpy as np
import pytest
import xarray as xr

from approximation.arrays import Array
from storage.described import described
from storage.netcdf import read_whole, write_whole
from storage.quarantine import little_memory
from surrogate import FactorialRegressor, FormatError, GaussianProcess, GridGP, Input, ScatterGP, load, save
from surrogate.data.meanings import MEANINGS, SOURCE
from surrogate.face import persistence
from surrogate.transforms.measured import CorrectedGP
from tests.refusals import assert_refused
from tests.surrogate import curved, functions, grouped
from tests.surrogate.functions import inside
from tests.surrogate.use import test_learning


@cache
def grid() -> GridGP:
    """Outputs of different sizes, one of them constant."""
    data = functions.factorial((9, 5, 5, 5, 2))
    return GridGP(functions.INPUTS).fit(data.assign(flat=((), 3.0), small=1e-12 * data["smooth"]))


def scattered() -> ScatterGP:
    train, held = (
        functions.scattered(count, seed)[["mixture", "size", "ratio", "no_bias"]] for count, seed in ((30, 0), (200, 1))
    )
    return ScatterGP([functions.INPUTS[0], functions.INPUTS[2]]).fit(train).calibrate(held)


def calibrated() -> GaussianProcess:
    """Enough cases for a correction of the mean, products of two inputs in the trend, and guards of corners."""
    model = GridGP(functions.INPUTS).fit(functions.factorial((9, 5, 5, 5, 2)))
    model.calibrate(functions.scattered(3000, seed=1))
    assert model.correction_ is not None
    return model


MODELS: dict[str, Callable[[], GaussianProcess]] = {
    "grid": grid,
    "calibrated": calibrated,
    "scattered": scattered,
    "grouped": grouped.calibrated,
    "curves": curved.fitted_over_groups,
    "corrected": lambda: test_learning.corrected(
        test_learning.learnt(test_learning.DEVICE.rows()), test_learning.DEVICE.rows()
    ),
}
each_model = pytest.mark.parametrize("name", MODELS)
#: Of a part's means, over the output's spread, where they are compressed otherwise than the whole's.
PARTS = {"grouped": 1e-8, "curves": 1e-7}


@cache
def fitted(name: str) -> GaussianProcess:
    return MODELS[name]()


@each_model
def test_a_file_gives_the_same_answers_and_one_model_makes_one_file(name: str, tmp_path: Path) -> None:
    model, X = fitted(name), inside(fitted(name).inputs_, 12)
    save(model, tmp_path / "a.nc")
    again = load(tmp_path / "a.nc")
    assert type(again) is type(model)
    assert again.box == model.box
    if isinstance(model, CorrectedGP) and isinstance(again, CorrectedGP):
        assert (again.constants_, again.learnt_) == (model.constants_, "what it taught")
    pairs = [(m.predict(X), m.interval(X, 0.9), m.gradient(X, return_std=True)) for m in (again, model)]
    for answer, expected in zip(*pairs, strict=True):
        xr.testing.assert_identical(answer, expected)
    save(again, tmp_path / "b.nc")
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
    with netCDF4.Dataset(tmp_path / "a.nc") as file:  # every variable says what it is
        assert file.title.startswith("surrogate of ")
        assert file.source.startswith("meecontact: Gaussian")
        assert any("calibration_guard" in key for key in file.variables) == (model.calibration_ is not None)
        for variable in file.variables.values():
            assert variable.long_name, variable.name
            assert variable.units == "1"
    again.made_from_ = "some state"
    save(again, tmp_path / "c.nc")
    assert (model.made_from_, load(tmp_path / "c.nc").made_from_) == ("", "some state")


@each_model
def test_a_part_answers_as_the_whole(name: str) -> None:
    model, X = fitted(name), inside(fitted(name).inputs_, 12)
    outputs = model.outputs_
    whole, all_slopes = model.predict(X), model.gradient(X)
    for chosen in ([outputs[-1]], [outputs[-1], outputs[0]]):
        part = model.only(chosen)
        answer, slopes = part.predict(X), part.gradient(X)
        if not isinstance(model, ScatterGP | CorrectedGP):  # these answer all their outputs
            assert part.outputs_ == tuple(chosen)
            assert list(answer.data_vars) == [key for output in chosen for key in (output, f"{output}_std")]
        for output in chosen:
            size = float(np.ptp(whole[output].values)) or 1.0
            np.testing.assert_allclose(answer[output], whole[output], rtol=0, atol=PARTS.get(name, 2e-9) * size)
            rtol = 1e-6 if name in PARTS else 1e-12
            np.testing.assert_allclose(answer[f"{output}_std"], whole[f"{output}_std"], rtol=rtol, atol=0)
            for slope, other in zip(slopes[output].values, all_slopes[output].values, strict=True):
                assert np.abs(slope - other).max() <= 1e-6 * np.abs(other).max() + 1e-12 * size
    assert model.outputs_ == outputs  # the model itself stays


def assert_slopes(model: GaussianProcess, X: Array, rtol: float) -> None:
    """Compare all derivatives at X (n, d) with fourth-order differences, to ``rtol`` of the largest slope."""
    slopes = model.gradient_array(X)  # (n, p, d)
    for k, input_ in enumerate(model.inputs_):
        moves = 1e-4 * np.maximum(np.abs(X[:, k]), 0.01 * (input_.high - input_.low))
        ends = [model.predict_array(X + move * moves[:, None] * np.eye(X.shape[1])[k]) for move in (-2, -1, 1, 2)]
        difference = (ends[0] - 8 * ends[1] + 8 * ends[2] - ends[3]) / (12 * moves[:, None])
        room = rtol * np.max(np.abs(difference), axis=0)
        assert np.all(np.abs(slopes[..., k] - difference) <= room + 1e-300), (input_.name, slopes[..., k], difference)


@each_model
def test_derivatives_are_differences_of_the_means(name: str) -> None:
    """Grids: an output that depends on every input, since a derivative that is zero leaves rounding."""
    model = fitted(name).only(["mixed"]) if name in ("grid", "calibrated") else fitted(name)
    assert_slopes(model, inside(model.inputs_, 5), rtol=2e-5 if name == "curves" else 1e-5)


@each_model
def test_one_point_has_the_numbers_of_a_block_in_every_way_of_asking(name: str) -> None:
    model, X = fitted(name), inside(fitted(name).inputs_, 12)
    mean, std = model.predict_array(X, return_std=True)
    room = 1e-13 * np.ptp(mean, axis=0) if name in ("grid", "calibrated") else 1e-9 * np.ptp(mean, axis=0)
    for row, x in enumerate(X[:4]):
        (alone,), (spread,) = model.predict_array(x[None], return_std=True)
        assert (np.abs(alone - mean[row]) <= room).all()
        np.testing.assert_allclose(spread, std[row], rtol=1e-9)
        arrays = alone, spread, *(ends[0] for ends in model.interval_array(x[None], 0.9))
        numbers = dict(zip(model.box, x.tolist(), strict=True))
        ways: list[Any] = [numbers, {key: xr.DataArray(value) for key, value in numbers.items()}, x[None]]
        ways += [{key: xr.DataArray([value], dims="case") for key, value in numbers.items()}]
        for way in ways:
            answer = {**model.predict(way), **model.interval(way, 0.9)}
            for k, output in enumerate(model.outputs_):
                keys = output, f"{output}_std", f"{output}_lower", f"{output}_upper"
                assert [float(answer[key].item()) for key in keys] == [float(array[k]) for array in arrays]


@each_model
def test_answers_share_nothing(name: str) -> None:
    model = fitted(name)
    first, second = (dict(zip(model.box, x.tolist(), strict=True)) for x in inside(model.inputs_, 2))
    asks: list[Callable[..., xr.Dataset]] = [model.predict, model.interval]
    asks += [lambda point: model.predict(point, extrapolate=True), lambda p: model.gradient(p, extrapolate=True)]
    for ask in asks:
        before = ask(first)
        copied, after = before.copy(deep=True), ask(second)
        next(iter(before.data_vars.values())).attrs["units"] = "none"
        for answer in (after, ask(second)):
            xr.testing.assert_identical(answer, ask({key: xr.DataArray(value) for key, value in second.items()}))
        xr.testing.assert_equal(before, copied)


@cache
def stored(name: str) -> bytes:
    with TemporaryDirectory() as folder:
        save(fitted(name), Path(folder) / "a.nc")
        return (Path(folder) / "a.nc").read_bytes()


def replaced(name: str, value: Any) -> Callable[[xr.Dataset], xr.Dataset]:  # any array-like
    return lambda data: data.assign({name: data[name].copy(data=np.broadcast_to(value, data[name].shape))})


#: Changes of a model's file, and what is said of them.
SPOILT: list[tuple[str, Callable[[xr.Dataset], xr.Dataset], str]] = [
    ("grid", lambda d: d.assign_attrs(format="other"), "not a surrogate model"),
    ("grid", lambda d: d.assign_attrs(format_version=1),
     "format version 1 is not 4, the one known here: `make run` an"),
    ("grid", lambda d: d.assign_attrs(engine="torch"),
     "unknown engine 'torch'; known are grid, scatter, grouped, curv"),
    ("grid", lambda d: d.assign_attrs(kernel="__import__('os')"), "unknown kernel"),
    ("grid", replaced("contraction_order", 0), "is no order"),
    ("grid", lambda d: d.drop_vars("amplitude"), "inconsistent"),
    ("grid", lambda d: d.assign(core_0=d["core_0"][..., :1].rename(rank_1="cut")), "core 1 has the shape"),
    ("grid", lambda d: d.isel(level_0=slice(1, None)), "Chebyshev-Gauss"),
    ("grid", replaced("core_1", np.nan), "not finite"),
    ("grid", replaced("variance", -1.0), "negative variance"),
    ("grid", replaced("hyperparameter", 1.5), "rho must lie between 0 and 1"),
    ("grid", replaced("scale", "cubic"), "'cubic' is none of linear, log"),
    ("grid", lambda d: d.assign(core_2=d["core_2"] * 1.0001), "probe_mean do not come out again"),
    ("grid", lambda d: d.assign(variance=d["variance"] * 1.01), "probe_std do not come out again"),
    ("calibrated", lambda d: d.assign(calibration_rank=d.calibration_rank * 0), "ranks .* are not each there once"),
    ("calibrated", lambda d: d.assign(calibration_length=-d.calibration_length), "rows of the calibration do not fit"),
    ("corrected", lambda d: d.assign(measured_output=0 * d.measured_output + 2), "is of no output or no row"),
    ("corrected", lambda d: d.assign(draw_noise=0 * d.draw_noise - 1), "inconsistent"),
    ("corrected", lambda d: d.assign(draw_mean=0 * d.draw_mean), "predictions probe_mean do not come out again"),
    ("curves", lambda d: d.assign(largest_place=d.largest_place + 9), "from fields that its curves do not have"),
    ("curves", lambda d: d.assign(curve_across_0=d.curve_across_0 + 1), "does not fit their panels"),
    ("curves", lambda d: d.assign(measure_linear_0=("other", np.zeros(3))), "a measure of shapes"),
    ("curves", lambda d: d.assign_attrs(smooth_engine="curves"), "'curves'; known are grid, scatter, grouped"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "change", "says"), SPOILT)
def test_a_spoilt_file_is_refused(
    name: str, change: Callable[[xr.Dataset], xr.Dataset], says: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.nc"
    path.write_bytes(stored(name))
    write_whole(change(read_whole(path)), path)
    assert_refused(FormatError, f"^{re.escape(str(path))}: (.*){says}", load, path)


@pytest.mark.usefixtures("quarantined")
def test_a_calibrated_model_of_one_input_survives_its_file(tmp_path: Path) -> None:
    """It has no corners of two inputs: nothing of length zero stands in a file."""
    model = FactorialRegressor().fit(np.linspace(0, 1, 9)[:, None], np.exp(np.linspace(0, 1, 9))).model_
    t = np.random.default_rng(0).uniform(size=300)
    model.calibrate(xr.Dataset({"y0": ("case", np.exp(t))}, {"x0": ("case", t)}))
    save(model, tmp_path / "one.nc")
    again, points = load(tmp_path / "one.nc"), np.linspace(0, 1, 7)[:, None]
    np.testing.assert_array_equal(again.interval_array(points, 0.9), model.interval_array(points, 0.9))
    with netCDF4.Dataset(tmp_path / "one.nc") as file:
        assert "calibration_guard" in file.variables
        assert all(dimension.size for dimension in file.dimensions.values())


ONE = Input("a", 0, 1)


def sine() -> GridGP:
    levels = ONE.levels(6)
    return GridGP([ONE]).fit(xr.Dataset({"y": ("a", np.sin(levels))}, coords={"a": levels}))


def with_levels(stored: xr.Dataset, count: int = 20_000) -> xr.Dataset:
    """A model's arrays with so many levels, of which a matrix has the square: 3.2 GB of a file of 160 kB."""
    core = ("rank_0", "mode_0", "output"), np.zeros((1, count, 1))
    stored = stored.drop_vars(["levels_0", "core_0"])
    return stored.assign(levels_0=("level_0", np.linspace(0, 1, count)), core_0=core)


def twice(stored: xr.Dataset) -> xr.Dataset:
    return stored.isel(output=[0, 0]).assign(probe_point=(("probe", "input"), [[0.5]]))


@pytest.mark.usefixtures("quarantined")
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (with_levels, r"inconsistent: level_0 is 20000 long; .* at most 1000"),
        (lambda stored: stored.assign(more=("many", np.zeros(2**23))), "too large: it unpacks to 671"),
        (twice, "inconsistent: output names must be unique"),
    ],
)
def test_a_small_file_that_would_fill_the_memory_or_names_twice_is_refused(
    change: Callable[[xr.Dataset], xr.Dataset], says: str, tmp_path: Path
) -> None:
    path, stored = tmp_path / "hostile.nc", change(persistence.nested(sine()))
    stored.attrs |= {"format": persistence.FORMAT, "format_version": persistence.VERSION}
    write_whole(described(stored, "hostile", SOURCE, MEANINGS), path)
    assert path.stat().st_size < 2**19
    assert_refused(FormatError, rf"hostile\.nc: {says}", load, path)


def test_levels_are_bounded_for_all_factors_together() -> None:
    with pytest.raises(ValueError, match="2700 levels of all factors; a model in a file has at most 2000"):
        persistence.check_sizes(xr.Dataset({f"levels_{k}": (f"smooth_level_{k}", np.zeros(900)) for k in range(3)}))


def test_what_is_made_of_a_file_has_little_memory_and_the_limit_goes_again(tmp_path: Path) -> None:
    before, path = resource.getrlimit(resource.RLIMIT_AS), tmp_path / "some.nc"
    with (
        pytest.raises(FormatError, match=r"some\.nc: too large: what is made of it takes more memory"),
        little_memory(path),
    ):
        np.zeros(2**32 + 2**27 * (os.cpu_count() or 1), dtype=np.uint8)  # untouched, a machine would grant it
    assert resource.getrlimit(resource.RLIMIT_AS) == before


def test_what_could_not_be_read_again_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(persistence.MOST, "output", 0)
    assert_refused(ValueError, "output is 1 long", save, sine(), tmp_path / "y.nc")
    assert list(tmp_path.iterdir()) == []
