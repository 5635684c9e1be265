"""Pilots that refine themselves: do the chosen counts deliver, at what price, and what is said when they cannot."""

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from surrogate import GridGP, Input
from surrogate.levels.counts import UnreachableError
from surrogate.levels.pilot import Pilot, explore
from surrogate.use.validation import validate
from tests.surrogate import functions

Levels = dict[str, NDArray[np.float64]]


class Solver:
    """The test functions on any levels, counting the cases."""

    def __init__(self, inputs: tuple[Input, ...] = functions.INPUTS) -> None:
        self.inputs, self.cases = inputs, 0

    def __call__(self, levels: Levels) -> xr.Dataset:
        self.cases += int(np.prod([len(axis) for axis in levels.values()]))
        return xr.Dataset(functions.outputs({n: xr.DataArray(x, dims=n, coords={n: x}) for n, x in levels.items()}))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_the_counts_deliver_and_are_no_waste(tolerance: float) -> None:
    solver = Solver()
    result = explore(solver, functions.INPUTS, tolerance, 1_000_000)
    assert result.cases == solver.cases <= 1_000_000
    assert result.choice.affine == ("bias",)
    assert result.choice.extrapolated == ()
    assert max(result.choice.error.values()) <= tolerance
    counts = list(result.choice.counts.values())
    fresh = functions.scattered(3000, seed=17)
    assert (
        float(validate(GridGP(inputs=functions.INPUTS).fit(functions.factorial(counts)), fresh, None).max_error.max())
        <= tolerance
    )
    fewer = [max(2, count - 3) for count in counts]
    assert (
        float(validate(GridGP(inputs=functions.INPUTS).fit(functions.factorial(fewer)), fresh, None).max_error.max())
        > tolerance
    )


def test_a_kink_is_told_from_a_near_pole_by_refinement() -> None:
    def solve(levels: Levels) -> xr.Dataset:
        x, y = (xr.DataArray(levels[name], dims=name, coords={name: levels[name]}) for name in ("x", "y"))
        return xr.Dataset({"pole": 1 / (x + 0.05) + y, "kink": np.maximum(x, 0.4) * y, "smooth": np.exp(x * y)})

    result = explore(solve, [Input("x", 0, 1), Input("y", 0, 1)], 1e-6, 20_000)
    assert result.choice.kinked == {"kink": ("x",)}
    assert result.levels["x"] > result.levels["y"]
    assert bool(result.choice.decay["kinked"].sel(output="kink", input="x"))
    assert int(result.choice.decay["kinked"].sum()) == 1


def test_given_counts_are_kept_and_blamed_when_too_few() -> None:
    def run(**counts: int) -> Pilot:
        return explore(Solver(), functions.INPUTS, 1e-4, 1_000_000, fixed=counts)

    assert run(angle=12).choice.counts["angle"] == 12
    with pytest.raises(UnreachableError, match=r"out of reach with 3 levels of 'angle': output '[a-z_]+' errs by"):
        run(angle=3)


def test_the_budget_bounds_the_pilots_too() -> None:
    solver = Solver()
    with pytest.raises(
        UnreachableError, match=r"^tolerance 1e-09 needs .* the budget is 3,000; 3,000 cases reach about"
    ):
        explore(solver, functions.INPUTS, 1e-9, 3000)
    assert solver.cases <= 3000
