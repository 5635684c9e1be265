"""Cross approximation: the process of the whole grid from few places."""

from math import prod
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from surrogate import CrossGP, GridGP, Input, load, save
from surrogate.levels import counts, lines
from surrogate.use.sensitivity import sobol
from tests.refusals import assert_refused

BOX = tuple(Input(name, 0.0, 1.0) for name in "uvwxyz")
LEVELS = {"u": 4, "v": 6, "w": 5, "x": 7, "y": 6, "z": 4}
CROSSED = ("x", "y", "v", "u")


def truth(x: xr.Dataset) -> xr.Dataset:
    smooth = np.exp(x.x * x.y + x.z * x.w + 0.3 * x.u * x.v) / (2 + x.x)
    return xr.Dataset({"f": smooth, "g": np.cos(x.w + x.x + x.y) + x.z * x.v, "h": x.u + 0 * x.x})


def crossing(tolerance: float = 1e-9, most: int = 10_000) -> CrossGP:
    return CrossGP(BOX, LEVELS, CROSSED, tolerance, compression=1e-11, most=most)


def solved(places: xr.Dataset) -> xr.Dataset:
    whole = {input_.name: input_.levels(LEVELS[input_.name]) for input_ in BOX if input_.name not in CROSSED}
    return places.assign_coords(whole).pipe(lambda points: points.assign(truth(points)))


def asked(model: CrossGP) -> tuple[xr.Dataset, float]:
    """Cases of all places that a model asks for, and its error."""
    data = solved(model.ask(None))
    while "place" in (places := model.ask(data)).sizes:
        data = xr.concat([data, solved(places)], "place", data_vars="all")
    return data, float(places["error"].max())


@pytest.fixture(scope="module")
def cases() -> xr.Dataset:
    data, error = asked(crossing())
    assert error <= 1e-9
    return data


def test_no_place_is_asked_for_twice_and_the_most_ends_the_sweeps() -> None:
    data, error = asked(crossing(1e-15, most=30))
    places = np.stack([data[name] for name in CROSSED], axis=1)
    assert len(np.unique(places, axis=0)) == len(places) > 30
    assert error > 1e-15


@pytest.fixture(scope="module")
def grid() -> xr.Dataset:
    return truth(xr.Dataset(coords={input_.name: input_.levels(LEVELS[input_.name]) for input_ in BOX}))


@pytest.fixture(scope="module")
def model(cases: xr.Dataset) -> CrossGP:
    return crossing().fit(cases)


def test_it_is_the_process_of_the_whole_grid(
    model: CrossGP, grid: xr.Dataset, cases: xr.Dataset, tmp_path: Path
) -> None:
    whole = GridGP(inputs=BOX, compression=1e-11).fit(grid)
    X = np.random.default_rng(0).uniform(size=(60, len(BOX)))
    (mean, std), (expected, spread) = model.predict_array(X, return_std=True), whole.predict_array(X, return_std=True)
    np.testing.assert_allclose(mean, expected, atol=1e-7)
    np.testing.assert_allclose(std, spread, rtol=0.02, atol=1e-12)
    np.testing.assert_allclose(model.gradient_array(X), whole.gradient_array(X), atol=1e-5)
    np.testing.assert_allclose(sobol(model)["total"], sobol(whole)["total"], atol=1e-6)
    assert model.places_ == cases.sizes["place"] < prod(LEVELS[name] for name in CROSSED) / 2
    assert max(model.error_.values()) <= 1e-9
    save(model, tmp_path / "model.nc")
    assert isinstance(load(tmp_path / "model.nc"), GridGP)


def test_lines_of_the_cases_decay_as_those_of_the_grid(cases: xr.Dataset, grid: xr.Dataset) -> None:
    line_decays, grid_decays = lines.decays(crossing(), cases), counts.decays(grid, BOX)
    assert list(line_decays) == list(grid_decays)
    for output, along in grid_decays.items():
        for name, decay in along.items():
            coefficients = line_decays[output][name].coefficients
            assert (coefficients <= decay.coefficients * (1 + 1e-9) + 1e-12).all()
            assert coefficients[1] >= 0.3 * decay.coefficients[1] - 1e-12


def test_missing_and_bad_cases_are_named(cases: xr.Dataset) -> None:
    assert_refused(ValueError, r"\d+ places are still to be solved", crossing().fit, cases.isel(place=slice(0, 40)))
    with pytest.raises(ValueError, match=r"input .x.: 0\.1234 is none of its 7 levels"):
        crossing().fit(cases.assign(x=("place", np.full(cases.sizes["place"], 0.1234))))
    assert_refused(ValueError, "output 'f' is not finite", crossing().fit, cases.assign(f=cases["f"] * np.nan))
    assert_refused(ValueError, "crossed and levels must name inputs", CrossGP, BOX, LEVELS, ("x", "q"), 1e-3)
