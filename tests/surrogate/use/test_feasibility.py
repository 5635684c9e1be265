"""The edge beyond which cases are refused: what it promises on fresh cases, where it lies, and what a file keeps."""

from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from approximation.arrays import Array
from approximation.chebyshev import gauss_points
from surrogate import GridGP, Input, OutOfBoxError, load, save
from surrogate.data.inputs import unit_coordinates
from surrogate.face.region import OutOfRegionError, Region
from surrogate.use import feasibility

NODES = np.array(list(product(*(gauss_points(count) for count in (8, 5, 10))))).T


def plane(t: Array) -> Array:
    return np.asarray(1.25 - (t[0] + t[1] + 0.3 * t[2]))


def curved(t: Array) -> Array:
    return np.asarray(1.0 - (t[0] + 0.9) ** 2 * (t[1] + 1.2) / 4 + 0.1 * t[2])


def learnt(above: Callable[[Array], Array], seed: int, count: int) -> Region:
    """A region from the nodes and some held-out cases, of which an exact function says what is refused."""
    t = np.concatenate([NODES, np.random.default_rng(seed).uniform(-1, 1, (3, count))], axis=1)
    refused, even = above(t) < 0, np.arange(t.shape[1]) >= NODES.shape[1]
    which = np.zeros(int(refused.sum()), dtype=np.intp)
    return feasibility.learn(t, refused, even, np.arange(t.shape[1]), which, ["too far"])


@pytest.mark.parametrize(("above", "seeds"), [(plane, 3), (curved, 3)])
def test_no_more_refused_cases_pass_than_is_promised(above: Callable[[Array], Array], seeds: int) -> None:
    passed, lost = [], []
    for seed in range(seeds):
        region = learnt(above, seed, 400)
        assert region.passing <= 0.05
        fresh = np.random.default_rng(100 + seed).uniform(-1, 1, (3, 20000))
        refused, inside = above(fresh) < 0, region.inside(fresh)
        passed.append((refused & inside).sum() / refused.sum() / region.passing)
        lost.append((~refused & ~inside).sum() / (~refused).sum())
    assert np.mean(passed) <= 1
    assert np.mean(lost) < 0.03  # the margin takes 1 % at least


@pytest.fixture(scope="module")
def model() -> GridGP:
    inputs = [Input("a", 0.0, 2.0), Input("b", 1.0, 100.0, "log"), Input("c", -1.0, 1.0)]
    coords = {input_.name: input_.levels(4) for input_ in inputs}
    grid = xr.Dataset(coords=coords)
    fitted = GridGP(inputs=inputs).fit(grid.assign(f=grid.a * np.log(grid.b) + grid.c))
    fitted.region_ = learnt(plane, 0, 200)
    return fitted


def test_points_beyond_the_edge_are_refused_with_the_reason(model: GridGP) -> None:
    inside, beyond = {"a": 0.5, "b": 5.0, "c": 0.0}, {"a": 1.95, "b": 98.0, "c": 0.5}
    message = r"a = 1.95, b = 98, c = 0.5 is beyond the edge of the cases that have answers: too far"
    for ask in (model.predict, model.interval, model.gradient, lambda points: model.sample(points, 2, 0)):
        ask(inside)
        with pytest.raises(OutOfRegionError, match=message):
            ask(beyond)
    X = np.array([list(inside.values()), list(beyond.values())])
    with pytest.raises(OutOfBoxError, match=r"\(1 of 2 points are beyond it\): too far"):
        model.predict_array(X)
    assert model.has_answers(np.vstack([X, [[3.0, 5.0, 0.0]]])).tolist() == [True, False, False]
    assert model.predict(beyond, extrapolate=True)["extrapolated"].item()
    np.testing.assert_array_equal(model.everywhere().predict_array(X), model.predict_array(X, extrapolate=True))
    assert model.only(["f"]).region_ is model.region_


def test_a_file_keeps_the_region(model: GridGP, tmp_path: Path) -> None:
    save(model, tmp_path / "model.nc")
    again = load(tmp_path / "model.nc").region_
    assert again is not None
    assert model.region_ is not None
    t = np.random.default_rng(1).uniform(-1, 1, (3, 200))
    np.testing.assert_array_equal(again.above(t), model.region_.above(t))
    assert (again.passing, again.lost, again.reasons) == (
        model.region_.passing, model.region_.lost, model.region_.reasons,
    )  # fmt: skip
    save(model.everywhere(), tmp_path / "plain.nc")
    assert load(tmp_path / "plain.nc").region_ is None


def test_slopes_are_difference_quotients(model: GridGP) -> None:
    assert model.region_ is not None
    t, step = unit_coordinates(model.inputs_, np.array([[0.7, 20.0, -0.3], [1.5, 3.0, 0.6]])), 1e-6
    slopes = model.region_.slopes(t)
    for k in range(3):
        shift = np.zeros((3, 1))
        shift[k] = step
        quotient = (model.region_.above(t + shift) - model.region_.above(t - shift)) / (2 * step)
        np.testing.assert_allclose(slopes[k], quotient, rtol=1e-6, atol=1e-6 * np.abs(slopes).max())


def test_a_file_with_an_inconsistent_region_is_refused(model: GridGP) -> None:
    assert model.region_ is not None
    stored = model.region_.state()
    with pytest.raises(ValueError, match="does not fit the model"):
        Region.restore(stored, 2)
    with pytest.raises(ValueError, match="do not fit its places"):
        Region.restore(stored.assign(region_which=stored["region_which"] + 5), 3)
