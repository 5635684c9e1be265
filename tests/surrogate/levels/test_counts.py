"""Level counts chosen from a pilot: do they deliver, and what is said when they cannot."""

import re

import numpy as np
import pytest
import xarray as xr

from surrogate import Input
from surrogate.levels.counts import LevelChoice, UnreachableError, choose, decays
from tests.surrogate import functions

PILOT = (17, 9, 9, 9, 3)
BUDGET = 400_000


@pytest.fixture(scope="module")
def pilot() -> xr.Dataset:
    return functions.factorial(PILOT)


def chosen(data: xr.Dataset, tolerance: float, budget: int = BUDGET, outputs: list[str] | None = None) -> LevelChoice:
    return choose(decays(data, functions.INPUTS, outputs), tolerance, budget)


def test_the_rate_is_that_of_the_nearest_singularity(pilot: xr.Dataset) -> None:
    choice = chosen(pilot, 1e-4)
    pole = functions.INPUTS[0].to_unit(0.02 + 0.005 * np.sin(0.6))
    # Bernstein ellipse through the pole: Trefethen (2013), theorem 8.1
    rho = abs(pole) - np.sqrt(pole**2 - 1)
    assert float(choice.decay["rate"].sel(output="near_pole", input="mixture")) == pytest.approx(rho, rel=0.05)
    assert choice.extrapolated == ("mixture",)
    assert choice.decay["coefficient"].sel(output="smooth", input="bias").isnull().sum() == max(PILOT) - 3


def test_kinked_outputs_are_named_and_nothing_is_claimed_for_them(pilot: xr.Dataset) -> None:
    kinked = pilot.assign(
        kink=np.abs(pilot["angle"] - 0.31) * pilot["ratio"],
        worst=np.maximum(np.sin(4 * pilot["mixture"]), np.cos(4 * pilot["mixture"])) + pilot["angle"],
    )
    choice = chosen(kinked, 1e-4)
    assert choice.kinked == {"kink": ("angle",), "worst": ("mixture",)}
    assert np.isnan(choice.error["kink"])
    assert np.isnan(choice.error["worst"])
    assert choice.error["smooth"] <= 1e-4
    assert choice.counts == chosen(pilot, 1e-4).counts
    with pytest.raises(ValueError, match="no output decays geometrically, so no tolerance can be met: kink, worst"):
        chosen(kinked, 1e-4, outputs=["kink", "worst"])


def test_an_unreachable_tolerance_says_what_would_reach_it(pilot: xr.Dataset) -> None:
    needed = chosen(pilot, 1e-9, 10**7)
    with pytest.raises(UnreachableError) as caught:
        chosen(pilot, 1e-9, 20_000)
    said = str(caught.value)
    assert said.startswith(f"tolerance 1e-09 needs {needed.cases:,} cases ({needed.counts['mixture']} mixture x ")
    assert "the budget is 20,000; 20,000 cases reach about" in said
    assert "\n" not in said
    offered = float(re.findall(r"reach about (\S+)", said)[0])
    assert chosen(pilot, offered * 1.05, 20_000).cases <= 20_000
    with pytest.raises(UnreachableError):
        chosen(pilot, offered * 0.8, 20_000)


def test_noise_in_the_data_bounds_the_tolerance(pilot: xr.Dataset) -> None:
    noisy = pilot[["mixed"]].copy(deep=True)
    noisy["mixed"] *= 1 + 1e-6 * np.random.default_rng(0).normal(size=noisy["mixed"].shape)
    chosen(noisy, 1e-3)
    with pytest.raises(ValueError, match="out of reach for output 'mixed'"):
        chosen(noisy, 1e-9)


def test_polynomials_get_exactly_the_levels_that_they_need() -> None:
    inputs = [Input("x", 0, 1), Input("y", -2, 3)]
    x, y = (xr.DataArray(i.levels(9), dims=i.name, coords={i.name: i.levels(9)}) for i in inputs)
    choice = choose(decays(xr.Dataset({"f": x**4 * (1 + y), "g": x**2 - 7 * y}), inputs), 1e-10, 100)
    assert choice.counts == {"x": 5, "y": 2}
    assert choice.affine == ("y",)
    assert choice.kinked == {}


@pytest.mark.parametrize(("tolerance", "budget"), [(0.0, 10), (-1.0, 10), (float("nan"), 10), (1e-3, 0)])
def test_senseless_requests_are_refused(pilot: xr.Dataset, tolerance: float, budget: int) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        chosen(pilot, tolerance, budget)
