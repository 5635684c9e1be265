"""Grouped surrogates: the user's inputs outside, products of powers inside, against functions known by formula."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import surrogate
from surrogate import GridGP, Group, GroupedGP, Input, Scaling
from surrogate.data.inputs import unit_coordinates
from surrogate.use.sensitivity import sobol
from surrogate.use.validation import validate
from tests.surrogate.grouped import GROUPING, GROUPS, INPUTS, PRESSING, SCALINGS, cases, factorial, world


@pytest.fixture(scope="module")
def exact() -> GroupedGP:
    return GroupedGP(GROUPING).fit(factorial())


@pytest.fixture(scope="module")
def calibrated() -> GroupedGP:
    return GroupedGP(GROUPING).fit(factorial(0.2)).calibrate(cases(3000, 1, 0.2))


def test_what_the_groups_tell_is_exact_in_the_inputs(exact: GroupedGP) -> None:
    """Polynomials of the axes' scaled coordinates are as good as exact; powers and logarithms are exact anyway."""
    fresh = cases(500, 2)
    found = exact.predict({one.name: fresh[one.name] for one in INPUTS}, return_std=False)
    for name in SCALINGS:
        true = fresh[name].values
        np.testing.assert_allclose(found[name].values, true, rtol=1e-9, atol=1e-10 * float(np.ptp(true)))
    assert len(exact.reduced_.inputs_) == 3
    assert list(exact.box) == [one.name for one in INPUTS]


def test_gradients_are_those_by_the_inputs(calibrated: GroupedGP) -> None:
    x = np.stack([one.from_unit(np.array([-0.3, 0.2, 0.6])) for one in INPUTS], axis=1)
    slopes = calibrated.gradient_array(x)
    for k, one in enumerate(INPUTS):
        step = 1e-5 * (one.high - one.low)
        up, down = x.copy(), x.copy()
        up[:, k] += step
        down[:, k] -= step
        found = (calibrated.predict_array(up) - calibrated.predict_array(down)) / (2 * step)
        np.testing.assert_allclose(slopes[:, :, k], found, rtol=1e-5, atol=1e-6 * np.abs(found).max())


def test_intervals_hold_by_the_inputs_and_of_derivatives(calibrated: GroupedGP) -> None:
    fresh = cases(4000, 3, 0.2)
    table = validate(calibrated, fresh, factorial(0.2))
    assert (np.abs(table.coverage - 0.95) < 0.02).all()
    assert float(table.worst_decile_coverage.min()) > 0.8
    assert (np.abs(table.raw_max_error / table.baseline_max_error - 1) < 0.1).all()
    found = calibrated.gradient({one.name: fresh[one.name][:50] for one in INPUTS}, return_std=True)
    assert all(np.isfinite(found[f"{name}_std"]).all() and (found[f"{name}_std"] >= 0).all() for name in SCALINGS)


def test_a_file_gives_the_same_answers(calibrated: GroupedGP, tmp_path: Path) -> None:
    surrogate.save(calibrated, tmp_path / "model.nc")
    again = surrogate.load(tmp_path / "model.nc")
    at = cases(20, 4)[[one.name for one in INPUTS]]
    xr.testing.assert_identical(again.predict(at), calibrated.predict(at))
    xr.testing.assert_identical(again.interval(at, 0.9), calibrated.interval(at, 0.9))
    xr.testing.assert_identical(again.gradient(at), calibrated.gradient(at))


def test_a_part_answers_as_the_whole(calibrated: GroupedGP) -> None:
    at = cases(30, 5)[[one.name for one in INPUTS]]
    part, whole = calibrated.only(["depth", "length"]), calibrated.predict(at)
    found = part.predict(at)
    assert part.outputs_ == ("depth", "length")
    for name in ("depth", "length"):
        np.testing.assert_allclose(found[name], whole[name], rtol=1e-8)
        np.testing.assert_allclose(found[f"{name}_std"], whole[f"{name}_std"], rtol=1e-6)


def test_sensitivity_is_that_to_the_inputs(exact: GroupedGP) -> None:
    """Against the indices of a grid process on the inputs themselves."""
    counts = (14, 7, 4, 7, 3)
    levels = {one.name: (one.name, one.levels(n)) for one, n in zip(INPUTS, counts, strict=True)}
    x = xr.Dataset(coords=levels)
    plain = GridGP(inputs=INPUTS).fit(world(x))
    one, two = sobol(exact), sobol(plain)
    for name in ("first_order", "total", "second_order"):
        np.testing.assert_allclose(
            one[name].sel(output=list(SCALINGS)), two[name].sel(output=list(SCALINGS)), atol=2e-4
        )


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"groups": GROUPS[:2]}, "input 'charge' is in no group and no scale"),
        ({"groups": (*GROUPS, Group(Input("x", 0, 1), {"heat": 1.0}))}, "'heat' is no input"),
        ({"groups": (*GROUPS[:2], Group(Input("root", 0, 1), {"charge": 0.5}))}, "'charge' from -2e-06 on has no such"),
        ({"groups": (GROUPS[0], Group(Input("pressing", 1e9, 2e9), PRESSING), GROUPS[2])}, "beyond its range"),
        ({"scalings": {"f": Scaling({"charge": 1.0})}}, "the scale of f: 'charge'"),
        ({"added": {"charge": 1.0}}, "the added logarithm: 'charge'"),
    ],
)
def test_bad_groups_are_named(change: dict[str, object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        replace(GROUPING, **change)  # type: ignore[arg-type]


def test_no_logarithm_of_what_changes_sign() -> None:
    logs = {**SCALINGS, "voltage": Scaling({"load": 1.0}, logarithm=1)}
    with pytest.raises(ValueError, match=r"output 'voltage' is from .* no logarithm of what changes sign"):
        GroupedGP(replace(GROUPING, scalings=logs)).fit(factorial())


def test_cases_that_do_not_have_the_axes_values_are_refused() -> None:
    wrong = factorial().assign_coords(radius=0.03)
    with pytest.raises(ValueError, match="do not have its values of the axis 'pressing'"):
        GroupedGP(GROUPING).fit(wrong)


def test_a_logit_scale_maps_there_and_back() -> None:
    one = Input("x", 0.02, 0.9, "logit")
    t = np.linspace(-1, 1, 9)
    x = one.from_unit(t)
    np.testing.assert_allclose(one.to_unit(x), t, atol=1e-14)
    np.testing.assert_allclose(x[4], 1 / (1 + np.sqrt(0.98 / 0.02 * 0.1 / 0.9)), rtol=1e-13)
    slope = (one.to_unit(x + 1e-7) - one.to_unit(x - 1e-7)) / 2e-7
    np.testing.assert_allclose(one.unit_slope(x), slope, rtol=1e-6)
    np.testing.assert_array_equal(unit_coordinates([one], x[:, None])[0], one.to_unit(x))
    with pytest.raises(ValueError, match=r"a logit scale needs 0 < low and high < 1, got \[0, 0.9\]"):
        Input("x", 0.0, 0.9, "logit")
