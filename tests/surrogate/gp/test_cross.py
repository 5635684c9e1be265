"""Cross approximation: tensors of known rank from few entries, steps that need no state, rows that interpolate."""

from math import prod
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from approximation.arrays import Array
from surrogate import CrossGP, GridGP, Input, load, save
from surrogate.gp.crossgp import Crossed, approximation, run
from surrogate.levels import counts, lines
from surrogate.use.sensitivity import sobol

SIZES = (7, 6, 5, 4)
BLOCK, OUTPUTS = 9, 2
Known = dict[tuple[int, ...], Array]


def separable(rank: int) -> Array:
    """A sum of so many products of random functions of the indices and of the block: (*SIZES, BLOCK, OUTPUTS)."""
    random = np.random.default_rng(rank)
    parts = [random.normal(size=(size, rank)) for size in (*SIZES, BLOCK, OUTPUTS)]
    return np.asarray(np.einsum("ar,br,cr,dr,er,fr->abcdef", *parts))


def found(tensor: Array, tolerance: float, known: Known, batches: list[list[list[int]]], most: int = 10_000) -> Crossed:
    while not isinstance(wanted := run(approximation(SIZES, tolerance, most), known), Crossed):
        batches.append(wanted.tolist())
        known |= {tuple(index): tensor[tuple(index)] for index in wanted.tolist()}
    return wanted


def test_an_interrupted_approximation_goes_on_with_the_same_batches_to_the_same_bits() -> None:
    tensor = separable(4)
    batches: list[list[list[int]]] = []
    whole = found(tensor, 1e-8, Known(), batches)
    half: Known = {tuple(i): tensor[tuple(i)] for batch in batches[:3] for i in batch}
    half |= {tuple(i): tensor[tuple(i)] for i in batches[3][: len(batches[3]) // 2]}
    remaining: list[list[list[int]]] = []
    again = found(tensor, 1e-8, half, remaining)
    assert remaining == [batches[3][len(batches[3]) // 2 :], *batches[4:]]
    for first, other in zip(whole.cores, again.cores, strict=True):
        assert first.tobytes() == other.tobytes()


def test_no_batch_repeats_an_entry_and_the_most_ends_the_sweeps() -> None:
    tensor, batches = np.random.default_rng(0).normal(size=(*SIZES, 1, OUTPUTS)), list[list[list[int]]]()
    got = found(tensor, 1e-3, Known(), batches, most=30)
    entries = [tuple(index) for batch in batches for index in batch]
    assert len(set(entries)) == len(entries) == got.entries > 30
    assert len(batches) <= 1 + len(SIZES)
    assert got.error.max() > 1e-3


BOX = tuple(Input(name, 0.0, 1.0) for name in "uvwxyz")
LEVELS = {"u": 4, "v": 6, "w": 5, "x": 7, "y": 6, "z": 4}
CROSSED = ("x", "y", "v", "u")


def truth(x: xr.Dataset) -> xr.Dataset:
    smooth = np.exp(x.x * x.y + x.z * x.w + 0.3 * x.u * x.v) / (2 + x.x)
    return xr.Dataset({"f": smooth, "g": np.cos(x.w + x.x + x.y) + x.z * x.v, "h": x.u + 0 * x.x})


def crossing(tolerance: float = 1e-9) -> CrossGP:
    return CrossGP(BOX, LEVELS, CROSSED, tolerance, compression=1e-11)


def solved(places: xr.Dataset) -> xr.Dataset:
    whole = {input_.name: input_.levels(LEVELS[input_.name]) for input_ in BOX if input_.name not in CROSSED}
    return places.assign_coords(whole).pipe(lambda points: points.assign(truth(points)))


@pytest.fixture(scope="module")
def cases() -> xr.Dataset:
    model, data = crossing(), solved(crossing().ask(None))
    while "place" in (places := model.ask(data)).sizes:
        data = xr.concat([data, solved(places)], "place", data_vars="all")
    assert (places["error"] <= 1e-9).all()
    return data


@pytest.fixture(scope="module")
def grid() -> xr.Dataset:
    return truth(xr.Dataset(coords={input_.name: input_.levels(LEVELS[input_.name]) for input_ in BOX}))


@pytest.fixture(scope="module")
def model(cases: xr.Dataset) -> CrossGP:
    return crossing().fit(cases)


def test_it_is_the_process_of_the_whole_grid(model: CrossGP, grid: xr.Dataset, cases: xr.Dataset) -> None:
    whole = GridGP(inputs=BOX, compression=1e-11).fit(grid)
    X = np.random.default_rng(0).uniform(size=(300, len(BOX)))
    (mean, std), (expected, spread) = model.predict_array(X, return_std=True), whole.predict_array(X, return_std=True)
    np.testing.assert_allclose(mean, expected, atol=1e-7)
    np.testing.assert_allclose(std, spread, rtol=0.02, atol=1e-12)
    np.testing.assert_allclose(model.gradient_array(X), whole.gradient_array(X), atol=1e-5)
    np.testing.assert_allclose(sobol(model)["total"], sobol(whole)["total"], atol=1e-6)
    assert model.places_ == cases.sizes["place"] < prod(LEVELS[name] for name in CROSSED) / 2
    assert max(model.error_.values()) <= 1e-9


def test_its_file_is_that_of_a_grid(model: CrossGP, tmp_path: Path) -> None:
    save(model, tmp_path / "model.nc")
    again = load(tmp_path / "model.nc")
    assert type(again) is GridGP
    X = np.random.default_rng(1).uniform(size=(5, len(BOX)))
    np.testing.assert_array_equal(again.predict_array(X), model.predict_array(X))


def test_lines_of_the_cases_decay_as_those_of_the_grid(cases: xr.Dataset, grid: xr.Dataset) -> None:
    line_decays, grid_decays = lines.decays(crossing(), cases), counts.decays(grid, BOX)
    assert list(line_decays) == list(grid_decays)
    for output, along in grid_decays.items():
        for name, decay in along.items():
            coefficients = line_decays[output][name].coefficients
            assert (coefficients <= decay.coefficients * (1 + 1e-9) + 1e-12).all()
            assert coefficients[1] >= 0.3 * decay.coefficients[1] - 1e-12


def test_missing_and_bad_cases_are_named(cases: xr.Dataset) -> None:
    with pytest.raises(ValueError, match=r"\d+ places are still to be solved"):
        crossing().fit(cases.isel(place=slice(0, 40)))
    with pytest.raises(ValueError, match=r"input .x.: 0\.1234 is none of its 7 levels"):
        crossing().fit(cases.assign(x=("place", np.full(cases.sizes["place"], 0.1234))))
    with pytest.raises(ValueError, match="output 'f' is not finite"):
        crossing().fit(cases.assign(f=cases["f"] * np.nan))
    with pytest.raises(ValueError, match="crossed and levels must name inputs"):
        CrossGP(BOX, LEVELS, ("x", "q"), 1e-3)
