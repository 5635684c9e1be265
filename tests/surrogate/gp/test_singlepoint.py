"""One query alone: the numbers of a block, in every way of asking the same ones, each under its own coordinates."""

import numpy as np
import pytest
import xarray as xr

from surrogate import GridGP, Input
from surrogate.data.inputs import Scale
from tests.surrogate import functions

COUNTS = (9, 5, 5, 5, 2)


@pytest.fixture(scope="module")
def plain() -> GridGP:
    return GridGP(inputs=functions.INPUTS).fit(functions.factorial(COUNTS))


@pytest.fixture(scope="module")
def calibrated() -> GridGP:
    # enough cases for a correction of the mean, products of two inputs in the trend, and guards of corners
    model = (
        GridGP(inputs=functions.INPUTS).fit(functions.factorial(COUNTS)).calibrate(functions.scattered(3000, seed=1))
    )
    assert model.correction_ is not None
    return model


def points() -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Points within, in corners and on the faces of the box, (n, d)."""
    t = np.clip(np.random.default_rng(0).uniform(-1.3, 1.3, (60, len(functions.INPUTS))), -1, 1)
    return np.stack([input_.from_unit(column) for input_, column in zip(functions.INPUTS, t.T, strict=True)], axis=1)


@pytest.mark.parametrize("name", ["plain", "calibrated"])
def test_a_point_alone_has_the_numbers_that_it_has_in_a_block(name: str, request: pytest.FixtureRequest) -> None:
    model, X = request.getfixturevalue(name), points()
    mean, std = model.predict_array(X, return_std=True)
    alone = [model.predict_array(x[None], return_std=True) for x in X]
    room = 1e-13 * np.ptp(mean, axis=0)
    assert (np.abs(np.concatenate([one for one, _ in alone]) - mean) <= room).all()
    np.testing.assert_allclose(np.concatenate([one for _, one in alone]), std, rtol=1e-9)


@pytest.mark.parametrize("scale", ["linear", "log", "logit"])
def test_a_point_alone_lies_where_its_scale_puts_it(scale: Scale) -> None:
    x = Input("x", 0.05, 0.9, scale)
    model = GridGP(inputs=[x]).fit(xr.Dataset({"f": ("x", np.sin(5 * x.levels(24)))}, {"x": x.levels(24)}))
    for value in (0.05, 0.3, 0.7, 0.9):
        answer = model.predict_array(np.array([[value]])).item()
        assert answer == pytest.approx(np.sin(5 * value), abs=1e-6)  # 24 levels; on another scale 0.2


@pytest.mark.parametrize("name", ["plain", "calibrated"])
def test_every_way_of_asking_for_one_point_gives_the_same_bits(name: str, request: pytest.FixtureRequest) -> None:
    model = request.getfixturevalue(name)
    names = [*model.box]
    for x in points()[:3]:
        arrays = *model.predict_array(x[None], return_std=True), *model.interval_array(x[None], 0.9)
        numbers = dict(zip(names, x.tolist(), strict=True))
        ways = [numbers, {key: xr.DataArray(value) for key, value in numbers.items()}, x[None]]
        ways += [{key: xr.DataArray([value], dims="case") for key, value in numbers.items()}]
        for way in ways:
            labelled = model.predict(way), model.interval(way, 0.9)
            for k, output in enumerate(model.outputs_):
                result = [labelled[0][output], labelled[0][f"{output}_std"]]
                result += [labelled[1][f"{output}_{end}"] for end in ("lower", "upper")]
                assert [float(one.item()) for one in result] == [float(array[0, k]) for array in arrays]


def test_answers_at_plain_numbers_are_those_at_labelled_ones_and_share_nothing(calibrated: GridGP) -> None:
    first, second = (dict(zip(calibrated.box, x.tolist(), strict=True)) for x in points()[:2])
    for ask in (calibrated.predict, calibrated.interval, lambda at: calibrated.predict(at, extrapolate=True)):
        before = ask(first)
        kept = before.copy(deep=True)
        after = ask(second)
        before["smooth" if "smooth" in before else "smooth_lower"].attrs["units"] = "none"
        again = ask(second)
        for answer in (after, again):
            xr.testing.assert_identical(answer, ask({key: xr.DataArray(value) for key, value in second.items()}))
        xr.testing.assert_equal(before, kept)


def test_what_is_learnt_later_counts_at_once() -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial(COUNTS))
    x, held = points()[:1], functions.scattered(600, seed=1)
    before = model.predict_array(x, return_std=True)
    model.calibrate(held)
    after = model.predict_array(x, return_std=True)
    assert (after[1] != before[1]).all()
    for one, other in zip(model.uncalibrated().predict_array(x, return_std=True), before, strict=True):
        np.testing.assert_array_equal(one, other)
    part = model.only(["ratio"])
    np.testing.assert_allclose(part.predict_array(x)[:, 0], after[0][:, model.outputs_.index("ratio")], rtol=1e-9)
