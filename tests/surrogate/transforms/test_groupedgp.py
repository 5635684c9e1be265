"""Grouped surrogates: the user's inputs outside, products of powers inside, against functions known by formula."""

import numpy as np
import pytest

from surrogate import GridGP, GroupedGP
from surrogate.data.inputs import unit_coordinates
from surrogate.use.sensitivity import sobol
from surrogate.use.validation import validate
from tests.surrogate import functions
from tests.surrogate.grouped import GROUPING, INPUTS, SCALINGS, cases, factorial, world


@pytest.fixture(scope="module")
def exact() -> GroupedGP:
    return GroupedGP(GROUPING).fit(factorial())


@pytest.fixture(scope="module")
def with_ends() -> GroupedGP:
    return GroupedGP(GROUPING).fit(factorial(0.2)).calibrate(cases(1500, 11, 0.2, to_ends=1500))


def test_what_the_groups_tell_is_exact_in_the_inputs(exact: GroupedGP) -> None:
    """Polynomials of the axes' scaled coordinates are as good as exact; powers and logarithms are exact anyway."""
    fresh = cases(500, 2)
    answer = exact.predict({input_.name: fresh[input_.name] for input_ in INPUTS}, return_std=False)
    for name in SCALINGS:
        true = fresh[name].values
        np.testing.assert_allclose(answer[name].values, true, rtol=1e-9, atol=1e-10 * float(np.ptp(true)))
    assert len(exact.reduced_.inputs_) == 3
    assert list(exact.box) == [input_.name for input_ in INPUTS]


def test_intervals_hold_at_the_ends_of_groups_and_in_corners(with_ends: GroupedGP) -> None:
    """Even cases hardly reach the ends of groups: 0.5 % of the box's are in the last 5 % of `pressing`."""
    fresh = cases(20_000, 12, 0.2)
    X = np.stack([fresh[input_.name].values for input_ in INPUTS], axis=1)
    true = np.stack([fresh[name].values for name in with_ends.outputs_], axis=1)
    along = unit_coordinates(GROUPING.axes, GROUPING.axis_values(X))
    ends = [sign * row > 0.9 for row in along for sign in (1, -1)]

    def worst(model: GroupedGP) -> float:
        lower, upper = model.interval_array(X)
        inside = (lower <= true) & (true <= upper)
        return min(float(inside[end].mean(axis=0).min()) for end in ends if np.count_nonzero(end) > 100)

    assert worst(with_ends) >= 0.9
    table = validate(with_ends, fresh, factorial(0.2))
    assert (np.abs(table.coverage - 0.95) < 0.02).all()  # the quantiles are those of the even cases
    assert float(table.worst_corner_coverage.min()) >= 0.9
    assert float(table.worst_decile_coverage.min()) > 0.8
    assert (np.abs(table.raw_max_error / table.baseline_max_error - 1) < 0.1).all()
    slopes = with_ends.gradient({input_.name: fresh[input_.name][:50] for input_ in INPUTS}, return_std=True)
    assert all(np.isfinite(slopes[f"{name}_std"]).all() and (slopes[f"{name}_std"] >= 0).all() for name in SCALINGS)
    assert with_ends.distribution.highest_level() == 1 - 2 / 1501


def test_sensitivity_is_that_to_the_inputs(exact: GroupedGP) -> None:
    plain = GridGP(inputs=INPUTS).fit(world(functions.grid(INPUTS, (14, 7, 4, 7, 3))))
    input_, two = sobol(exact), sobol(plain)
    for name in ("first_order", "total", "second_order"):
        np.testing.assert_allclose(
            input_[name].sel(output=list(SCALINGS)), two[name].sel(output=list(SCALINGS)), atol=2e-4
        )
