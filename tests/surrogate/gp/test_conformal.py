"""Intervals after calibration: do they hold on fresh cases, everywhere, and do they survive a file."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import linprog

from surrogate import GridGP, ScatterGP, load, save
from surrogate.gp.quantile import quantile_regression
from surrogate.use.validation import validate
from tests.surrogate import functions

Functions = Callable[[Mapping[str, xr.DataArray]], dict[str, xr.DataArray]]


def waves(x: Mapping[str, xr.DataArray]) -> dict[str, xr.DataArray]:
    """Another family than the one that the method was tuned on, again with a near-pole."""
    force, size = xr.apply_ufunc(np.log, x["force"] / 3e4), xr.apply_ufunc(np.log, x["size"] / 0.03)
    pole = 1 / (1.02 - x["mixture"] + 0.01 * x["angle"])
    return {
        "pole": pole * np.exp(-0.5 * force) * np.cos(x["angle"]) + x["bias"] * force,
        "bell": np.exp(-2 * (x["mixture"] - 0.4) ** 2) * (1 + 0.3 * size) / (1 + x["angle"] ** 2),
        "wave": np.sin(4 * x["mixture"] + 0.5 * size) * np.exp(0.3 * force) + x["bias"] * x["angle"],
    }


@pytest.mark.parametrize("counts", [(10, 4, 4, 4, 2), (24, 8, 6, 8, 2)])
@pytest.mark.parametrize("family", [functions.outputs, waves])
def test_coverage_holds_marginally_and_in_every_decile(
    family: Functions, counts: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(functions, "outputs", family)
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial(counts))
    mean = model.predict(functions.scattered(50, seed=0)[list(model.box)], return_std=False)
    assert model.calibrate(functions.scattered(3000, seed=1)) is model
    table = validate(model, functions.scattered(20_000, seed=2), None)
    np.testing.assert_allclose(table["coverage"], 0.95, rtol=0, atol=0.02)
    assert float(table["worst_decile_coverage"].min()) >= 0.85
    xr.testing.assert_identical(mean, model.predict(functions.scattered(50, seed=0)[list(model.box)], return_std=False))


def test_calibrated_intervals_are_no_wider_than_they_must_be() -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial((10, 4, 4, 4, 2)))
    fresh = functions.scattered(5000, seed=2)
    raw = validate(model, fresh, None)["crps"]
    # the best constant interval: a Gaussian with the root-mean-square error everywhere
    error = validate(model, fresh, None)["error"]
    constant: Any = 0.5642 * np.sqrt((error**2).mean("case"))
    right = validate(model.calibrate(functions.scattered(2000, seed=1)), fresh, None)["crps"]
    assert bool((right < 0.9 * raw).all())
    assert bool((right < 1.1 * constant).all())
    assert float(right.sel(output="near_pole")) < 0.7 * float(constant.sel(output="near_pole"))


@pytest.mark.parametrize("count", [60, 150, 500])
def test_few_cases_still_give_right_marginal_coverage(count: int) -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial((10, 4, 4, 4, 2)))
    shares = []
    for seed in range(5):
        model.calibrate(functions.scattered(count, seed=10 + seed))
        shares.append(validate(model, functions.scattered(3000, seed=2), None)["coverage"].values)
    # a beta distribution: the coverage given the cases spreads by about sqrt(0.95 * 0.05 / count)
    assert np.mean(shares) >= 0.94
    assert np.min(shares) >= 0.95 - 4.5 * np.sqrt(0.95 * 0.05 / count)


def test_validation_shows_the_intervals_before_and_after() -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial((10, 4, 4, 4, 2)))
    fresh = functions.scattered(500, seed=2)
    before = validate(model, fresh, None)
    assert "raw_coverage" not in before
    after = validate(model.calibrate(functions.scattered(500, seed=1)), fresh, None)
    for name in ("coverage", "worst_decile_coverage", "crps", "pit"):
        np.testing.assert_array_equal(after[f"raw_{name}"], before[name])
        assert not np.array_equal(after[name], before[name])
    assert model.calibration_ is not None


def test_a_scattered_model_is_calibrated_too() -> None:
    keep = ["mixture", "angle", "size", "ratio"]
    train, held, fresh = (functions.scattered(n, seed=s)[keep] for n, s in ((60, 0), (600, 1), (3000, 2)))
    model = ScatterGP("matern32", functions.INPUTS[:3]).fit(train).calibrate(held)
    table = validate(model, fresh, None)
    assert float(table["coverage"][0]) == pytest.approx(0.95, abs=0.03)


@pytest.mark.parametrize("kind", ["grid", "scatter"])
def test_a_calibrated_model_survives_its_file(kind: str, tmp_path: Path) -> None:
    keep = ["mixture", "angle", "size", "ratio"]
    model: GridGP | ScatterGP
    if kind == "scatter":
        model = ScatterGP("matern32", functions.INPUTS[:3]).fit(functions.scattered(40, seed=0)[keep])
        model.calibrate(functions.scattered(400, seed=1)[keep])
    else:
        model = GridGP(inputs=functions.INPUTS).fit(functions.factorial((6, 4, 4, 3, 2)))
        model.calibrate(functions.scattered(400, seed=1))
    save(model, tmp_path / "a.nc")
    again = load(tmp_path / "a.nc")
    points = functions.scattered(100, seed=5)[list(model.box)]
    xr.testing.assert_identical(again.predict(points), model.predict(points))
    save(again, tmp_path / "b.nc")
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_fitting_again_forgets_the_calibration() -> None:
    data = functions.factorial((6, 4, 4, 3, 2))
    model = GridGP(inputs=functions.INPUTS).fit(data)
    points = functions.scattered(10, seed=5)[list(model.box)]
    raw = model.predict(points)
    assert not raw.equals(model.calibrate(functions.scattered(100, seed=1)).predict(points))
    xr.testing.assert_identical(model.fit(data).predict(points), raw)


def test_exactly_reproduced_outputs_keep_a_zero_interval() -> None:
    data = functions.factorial((6, 4, 4, 3, 2)).assign(constant=((), 3.0))
    cases = functions.scattered(100, seed=1).assign(constant=("case", np.full(100, 3.0)))
    model = GridGP(inputs=functions.INPUTS).fit(data).calibrate(cases)
    answer = model.predict(functions.scattered(10, seed=2)[list(model.box)])
    np.testing.assert_array_equal(answer["constant"], 3.0)
    assert float(answer["constant_std"].max()) < 1e-100
    assert bool((answer["smooth_std"] > 0).all())


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda d: d.isel(case=slice(39)), "calibration needs at least 40 cases, got 39"),
        (lambda d: d.drop_vars("ratio"), "'ratio' is not in the data set"),
        (lambda d: d.assign(angle=d["angle"] + 1), "outside the trained box"),
        (lambda d: d.assign(ratio=d["ratio"].where(d["angle"] < 0.5)), "'ratio' is not finite in a case"),
    ],
)
def test_bad_cases_are_refused(change: Callable[[xr.Dataset], xr.Dataset], says: str) -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial((4, 3, 3, 3, 2)))
    with pytest.raises(ValueError, match=says):
        model.calibrate(change(functions.scattered(60, seed=1)))


@pytest.mark.parametrize("calibrated", [False, True])
@pytest.mark.parametrize("kind", ["chebyshev", "rbf", "matern52", "scatter"])
def test_the_gradient_of_the_standard_deviation_agrees_with_differences(kind: str, calibrated: bool) -> None:
    model: GridGP | ScatterGP
    keep = ["mixture", "angle", "size", "ratio"]
    if kind == "scatter":
        model = ScatterGP("matern52", functions.INPUTS[:3], nugget=1e-4).fit(functions.scattered(50, seed=0)[keep])
    else:
        data = functions.factorial((7, 5, 5, 3, 2)).isel(force=1, bias=1, drop=True)
        model = GridGP(kind, functions.INPUTS[:3], nugget=1e-4).fit(data)  # type: ignore[arg-type]  # plain strings
    if calibrated:
        held = functions.scattered(400, seed=1).assign(force=("case", np.full(400, 3e4)), bias=("case", np.ones(400)))
        truth = functions.outputs({name: held[name] for name in ("mixture", "angle", "size", "force", "bias")})
        model.calibrate(held.assign(truth))
    # away from the levels, where it vanishes, and from the edges of the slabs, where the calibrated one jumps
    t = 0.1 * np.array([[0.5, -2.6, 4.3, 7.4], [-6.6, 1.5, 3.4, -0.6], [2.4, 6.7, -8.5, -3.3]])
    at = {
        one.name: xr.DataArray(one.from_unit(row), dims="point")
        for one, row in zip(functions.INPUTS[:3], t, strict=True)
    }
    gradient = model.gradient(at, return_std=True)
    for one in functions.INPUTS[:3]:
        step: Any = 1e-5 * (one.high - one.low)
        above, below = ({**at, one.name: at[one.name] + sign * step} for sign in (1, -1))
        slope = (model.predict(above) - model.predict(below)) / (2 * step)
        for name in model.outputs_:
            found, want = gradient[f"{name}_std_gradient"].sel(input=one.name), slope[f"{name}_std"]
            room = 1e-4 * float(np.abs(want.values).max()) + 1e-12
            np.testing.assert_allclose(found, want, rtol=1e-3, atol=room, err_msg=f"{name} {one.name}")


def test_quantile_regression_agrees_with_linear_programming() -> None:
    rng = np.random.default_rng(0)
    A = np.stack([np.ones(600), *rng.normal(size=(3, 600))], axis=1)
    y = A @ [1.0, -2.0, 0.5, 0.0] + (1 + 0.5 * A[:, 1] ** 2) * rng.standard_t(4, size=600)
    for level in (0.5, 0.95):
        found = quantile_regression(A, y, level)
        cost = np.concatenate([np.zeros(4), np.full(600, level), np.full(600, 1 - level)])
        equal = np.concatenate([A, np.eye(600), -np.eye(600)], axis=1)
        best = linprog(cost, A_eq=equal, b_eq=y, bounds=[(None, None)] * 4 + [(0, None)] * 1200)
        residual = y - A @ found
        reached = float(np.sum(residual * (level - (residual < 0))))
        assert best.fun is not None
        assert reached <= best.fun * 1.005
        assert np.mean(residual <= 0) == pytest.approx(level, abs=0.012)
