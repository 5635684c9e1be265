"""Level counts chosen from a pilot: do they deliver, and what is said when they cannot."""

import re
from collections.abc import Callable
from math import prod

import numpy as np
import pytest
import xarray as xr
from numpy.polynomial.chebyshev import chebgauss, chebvander
from numpy.typing import NDArray

from surrogate import GridGP, Input
from surrogate.levels.counts import Decays, LevelChoice, UnreachableError, choose, decays, explore
from surrogate.levels.decay import Decay, decay_of
from surrogate.use.validation import validate
from tests.refusals import assert_refused
from tests.surrogate import functions

PILOT = (17, 9, 9, 9, 3)
BUDGET = 400_000


@pytest.fixture(scope="module")
def pilot() -> xr.Dataset:
    return functions.factorial(PILOT)


@pytest.fixture(scope="module")
def pilot_decays(pilot: xr.Dataset) -> Decays:
    return decays(pilot, functions.INPUTS)


def chosen(data: xr.Dataset, tolerance: float, outputs: list[str] | None = None) -> LevelChoice:
    return choose(decays(data, functions.INPUTS, outputs), tolerance, BUDGET)


def test_the_rate_is_that_of_the_nearest_singularity(pilot_decays: Decays) -> None:
    choice = choose(pilot_decays, 1e-4, BUDGET)
    pole = functions.INPUTS[0].to_unit(0.02 + 0.005 * np.sin(0.6))
    # Bernstein ellipse through the pole: Trefethen (2013), theorem 8.1
    rho = abs(pole) - np.sqrt(pole**2 - 1)
    assert float(choice.decay["rate"].sel(output="near_pole", input="mixture")) == pytest.approx(rho, rel=0.05)
    assert choice.extrapolated == ("mixture",)
    assert choice.decay["coefficient"].sel(output="smooth", input="bias").isnull().sum() == max(PILOT) - 3


def test_kinked_outputs_are_named_and_nothing_is_claimed_for_them(pilot: xr.Dataset, pilot_decays: Decays) -> None:
    kinked = pilot.assign(
        kink=np.abs(pilot["angle"] - 0.31) * pilot["ratio"],
        worst=np.maximum(np.sin(4 * pilot["mixture"]), np.cos(4 * pilot["mixture"])) + pilot["angle"],
    )
    choice = chosen(kinked, 1e-4)
    assert choice.kinked == {"kink": ("angle",), "worst": ("mixture",)}
    assert np.isnan(choice.error["kink"])
    assert np.isnan(choice.error["worst"])
    assert choice.error["smooth"] <= 1e-4
    assert choice.counts == choose(pilot_decays, 1e-4, BUDGET).counts
    with pytest.raises(ValueError, match="no output decays geometrically, so no tolerance can be met: kink, worst"):
        chosen(kinked, 1e-4, outputs=["kink", "worst"])


def test_noise_in_the_data_bounds_the_tolerance(pilot: xr.Dataset) -> None:
    noisy = pilot[["mixed"]].copy(deep=True)
    noisy["mixed"] *= 1 + 1e-6 * np.random.default_rng(0).normal(size=noisy["mixed"].shape)
    chosen(noisy, 1e-3)
    assert_refused(ValueError, "out of reach for output 'mixed'", chosen, noisy, 1e-9)


def test_polynomials_get_exactly_the_levels_that_they_need() -> None:
    inputs = [Input("x", 0, 1), Input("y", -2, 3)]
    x, y = functions.grid(inputs, (9, 9)).coords.values()
    choice = choose(decays(xr.Dataset({"f": x**4 * (1 + y), "g": x**2 - 7 * y}), inputs), 1e-10, 100)
    assert choice.counts == {"x": 5, "y": 2}
    assert choice.affine == ("y",)
    assert choice.kinked == {}


Array = NDArray[np.float64]
Family = Callable[[Array, float], Array]


def judged(family: Family, count: int) -> Decay:
    x = np.sort(chebgauss(count)[0])
    values = np.stack([family(x, a) for a in np.linspace(-0.9, 0.9, 9)])
    coefficients = np.abs(np.linalg.solve(chebvander(x, count - 1), values.T)).max(axis=1)
    return decay_of(coefficients / np.ptp(values))


@pytest.mark.parametrize("count", [9, 12, 17, 40])
@pytest.mark.parametrize(
    "family",
    [
        lambda x, a: 1 / (x + 1.1),
        lambda x, a: np.exp(2 * x),
        lambda x, a: np.cosh(2 * x),
        lambda x, a: 1 / (1 + 4 * x**2),
    ],
)
def test_the_predicted_error_covers_that_of_interpolation_without_waste(family: Family, count: int) -> None:
    decay = judged(family, count)
    fine = np.linspace(-1, 1, 2001)
    for levels in (6, 10, 15, 22, 30):
        x = np.sort(chebgauss(levels)[0])
        weights = np.linalg.solve(chebvander(x, levels - 1), family(x, 0.0))
        error = np.abs(chebvander(fine, levels - 1) @ weights - family(fine, 0.0)).max() / np.ptp(family(fine, 0.0))
        if error > 1e-11 and levels <= 2 * count:
            assert error <= decay.error(levels), levels
        if levels <= count and error > 1e-10:
            assert decay.error(levels) <= 50 * error, levels


Levels = dict[str, NDArray[np.float64]]


def solved(levels: Levels) -> xr.Dataset:
    return xr.Dataset(functions.outputs(xr.Dataset(coords=levels)))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_the_counts_deliver_and_are_no_waste(tolerance: float) -> None:
    result = explore(solved, functions.INPUTS, tolerance, 1_000_000)
    assert result.cases <= 1_000_000
    assert result.choice.affine == ("bias",)
    assert result.choice.extrapolated == ()
    assert max(result.choice.error.values()) <= tolerance
    counts, fresh = list(result.choice.counts.values()), functions.scattered(3000, seed=17)

    def largest_error(counts: list[int]) -> float:
        model = GridGP(inputs=functions.INPUTS).fit(functions.factorial(counts))
        return float(validate(model, fresh, None).max_error.max())

    assert largest_error(counts) <= tolerance < largest_error([max(2, count - 3) for count in counts])


PLANE = [Input("x", 0, 1), Input("y", 0, 1)]


def plane(levels: Levels) -> xr.Dataset:
    """Outputs of two inputs, with a pole and with a kink along x."""
    x, y = (xr.Dataset(coords=levels)[name] for name in ("x", "y"))
    return xr.Dataset({"pole": 1 / (x + 0.05) + y, "kink": np.maximum(x, 0.4) * y, "smooth": np.exp(x * y)})


def test_a_kink_is_told_from_a_near_pole_by_refinement() -> None:
    result = explore(plane, PLANE, 1e-6, 20_000)
    assert result.choice.kinked == {"kink": ("x",)}
    assert result.levels["x"] > result.levels["y"]
    assert int(result.choice.decay["kinked"].sum()) == 1


def test_an_unreachable_tolerance_says_what_would_reach_it() -> None:
    levels = {input_.name: input_.levels(17) for input_ in PLANE}
    plane_decays = decays(plane(levels), PLANE, ["pole", "smooth"])
    needed = choose(plane_decays, 1e-9, 10_000).counts
    with pytest.raises(UnreachableError) as caught:
        choose(plane_decays, 1e-9, 60)
    said = str(caught.value)
    assert said.startswith(f"tolerance 1e-09 needs {prod(needed.values()):,} cases ({needed['x']} x x {needed['y']} y)")
    offered = float(re.findall(r"the budget is 60; 60 cases reach about (\S+)", said)[0])
    assert prod(choose(plane_decays, offered * 1.05, 60).counts.values()) <= 60
    with pytest.raises(UnreachableError):
        choose(plane_decays, offered * 0.8, 60)


def test_given_counts_are_kept_and_blamed_when_too_few() -> None:
    assert explore(plane, PLANE, 1e-4, 20_000, fixed={"y": 12}).choice.counts["y"] == 12
    with pytest.raises(UnreachableError, match=r"out of reach with 3 levels of 'y': output 'smooth' errs by"):
        explore(plane, PLANE, 1e-4, 20_000, fixed={"y": 3})


def test_the_budget_bounds_the_pilots_too() -> None:
    cases = []

    def counted(levels: Levels) -> xr.Dataset:
        cases.append(prod(map(len, levels.values())))
        return plane(levels)

    assert_refused(UnreachableError, "the budget is 200; 200 cases reach about", explore, counted, PLANE, 1e-9, 200)
    assert sum(cases) <= 200
    cases.clear()
    assert explore(counted, PLANE, 1e-6, 20_000).cases == sum(cases)
