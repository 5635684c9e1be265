"""Errors together: expressions of outputs and of near points hold on fresh cases, in draws and in closed sums."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.special import ndtri

from approximation.arrays import Array
from storage.netcdf import read_whole, write_whole
from storage.sealed import FormatError
from surrogate import GridGP, Input, load, save
from surrogate.intervals.copula import MOST_POINTS, Copula, ends
from surrogate.intervals.distribution import PROBABILITIES, Normal, Tabulated

INPUTS = (Input("x", 0.0, 1.0), Input("y", 1.0, 3.0))


def truth(x: Array, y: Array) -> dict[str, Array]:
    """Outputs that share a near-pole, and one that does not."""
    pole, wave = 1 / (x + 0.1) ** y, np.cos(5 * x * y)
    return {"first": 3 + pole, "second": 2 + 0.7 * pole + 0.002 * wave, "other": np.exp(np.sin(4 * x * y) / y)}


def cases(count: int, seed: int) -> xr.Dataset:
    random = np.random.default_rng(seed)
    x, y = random.uniform(0, 1, count), random.uniform(1, 3, count)
    return xr.Dataset({name: ("case", column) for name, column in {"x": x, "y": y, **truth(x, y)}.items()})


@pytest.fixture(scope="module")
def model() -> GridGP:
    x, y = INPUTS[0].levels(12), INPUTS[1].levels(8)
    grid = {name: (("x", "y"), values) for name, values in truth(x[:, None], y).items()}
    return GridGP(inputs=INPUTS).fit(xr.Dataset(grid, {"x": x, "y": y})).calibrate(cases(3000, 1))


EXPRESSIONS: dict[str, Callable[[dict[str, Array]], Array]] = {
    "ratio": lambda q: q["first"] / q["second"],
    "sum": lambda q: q["first"] + q["second"],
    "product of unlike": lambda q: q["first"] * q["other"],
}


def test_expressions_of_outputs_hold_where_independent_draws_do_not(model: GridGP) -> None:
    fresh = cases(1500, 7)
    drawn = model.sample(fresh[["x", "y"]], 400, 3, together=False)
    random, held = np.random.default_rng(4), {}
    for name, what in EXPRESSIONS.items():
        true = what({key: fresh[key].values for key in truth(np.ones(1), np.ones(1))})
        together = {key: draw.values for key, draw in drawn.data_vars.items()}
        permuted = {key: random.permuted(draw, axis=0) for key, draw in together.items()}
        for kind, draws in (("together", together), ("apart", permuted)):
            low, high = np.quantile(what({str(key): draw for key, draw in draws.items()}), [0.025, 0.975], axis=0)
            held[name, kind] = float(np.mean((low <= true) & (true <= high)))
    for name in EXPRESSIONS:
        # four standard errors of 1,500 cases, and what a calibration on 3,000 and 400 draws leave
        assert held[name, "together"] == pytest.approx(0.955, abs=4 * np.sqrt(0.95 * 0.05 / 1500) + 0.01)
    assert held["sum", "apart"] < 0.92
    assert held["ratio", "apart"] > 0.98


def test_closed_sums_reach_as_far_as_they_should(model: GridGP) -> None:
    fresh = cases(600, 8)
    X = np.stack([fresh["x"], fresh["y"]], axis=1)
    error = np.stack([fresh[name] for name in model.outputs_], axis=1) - model.predict_array(X)
    for weights in ([1.0, 1.0, 0.0], [0.4, -1.0, 0.0], [1.0, 0.0, -0.5]):
        ends_of_sums = np.array([model.ends_of_sum(x[None], np.array([weights])) for x in X])
        sums = error @ weights
        inside = np.mean((ends_of_sums[:, 0] <= sums) & (sums <= ends_of_sums[:, 1]))
        assert inside == pytest.approx(0.955, abs=4 * np.sqrt(0.95 * 0.05 / 600) + 0.01)


def test_differences_of_near_points_hold(model: GridGP) -> None:
    count, step = 120, 0.02
    fresh = cases(count, 9)
    start = fresh["x"].values * (1 - step)
    moved = truth(start + step, fresh["y"].values)
    held: list[bool] = []
    alone: list[bool] = []
    for k in range(count):
        points = {"x": xr.DataArray([start[k], start[k] + step], dims="end"), "y": float(fresh["y"][k])}
        true = moved["first"][k] - truth(start[k : k + 1], fresh["y"].values[k : k + 1])["first"][0]
        for together, result in ((True, held), (False, alone)):
            drawn = model.sample(points, 200, k, together=together)["first"].values
            low, high = np.quantile(drawn[:, 1] - drawn[:, 0], [0.025, 0.975])
            result.append(bool(low <= true <= high))
    assert np.mean(held) == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / count) + 0.015)
    assert np.mean(alone) > np.mean(held)  # wider than they must be


def test_draws_keep_the_calibrated_marginals_however_many_points(model: GridGP) -> None:
    points = {"x": [0.2, 0.21, 0.7], "y": [1.5, 2.5]}
    drawn = model.sample(points, 4000, 5)
    for q in (0.025, 0.5, 0.975):
        bound = model.quantile(points, q)
        for name in model.outputs_:
            share = (drawn[name] <= bound[name]).mean("sample")
            np.testing.assert_allclose(share, q, rtol=0, atol=4 * np.sqrt(q * (1 - q) / 4000))


def test_lengths_are_those_that_errors_were_drawn_with() -> None:
    random, lengths = np.random.default_rng(0), np.array([0.15, 0.8])
    angles = random.uniform(0, np.pi, (2, 1500))
    square = sum(
        np.subtract.outer(angle, angle) ** 2 / length**2 for angle, length in zip(angles, lengths, strict=True)
    )
    scores = np.linalg.cholesky(np.exp(-0.5 * square) + 1e-8 * np.eye(1500)) @ random.normal(size=(1500, 8))
    result = Copula.of(scores.T, np.cos(angles)).lengths
    assert np.abs(np.log(result / lengths)).max() < 0.25


def test_sums_of_normal_errors_have_the_ends_of_the_normal_distribution() -> None:
    random = np.random.default_rng(1)
    correlation = np.array([[1, 0.9, -0.5], [0.9, 1, -0.3], [-0.5, -0.3, 1]])
    scores = np.linalg.cholesky(correlation) @ random.normal(size=(3, 1000))
    lengths = np.array([0.5])
    copula = replace(Copula.of(scores, random.uniform(-1, 1, (1, 1000))), lengths=lengths)
    normal = Tabulated(np.repeat(Normal().quantile(np.clip(PROBABILITIES, 5e-4, 1 - 5e-4)), 3, axis=1), 1000)
    t = np.cos([[1.0, 1.3, 2.9]])
    for sizes in (np.array([[1.0], [-1], [0.5]]), random.normal(size=(3, 3))):
        points = t[:, : sizes.shape[1]]
        near = np.exp(-0.5 * np.subtract.outer(np.arccos(points[0]), np.arccos(points[0])) ** 2 / lengths[0] ** 2)
        deviation = np.sqrt(np.einsum("pn,pq,nm,qm->", sizes, correlation, near, sizes))
        # a quantile of 1,000 rows at 0.025 has a standard error of 4 %
        np.testing.assert_allclose(
            ends(normal, copula, 0.95, sizes, points), [-1.96 * deviation, 1.96 * deviation], rtol=0.12
        )
    added = ends(normal, None, 0.95, np.array([[1.0], [-1], [0.5]]), t[:, :1])
    np.testing.assert_allclose(added, [-1.96 * 2.5, 1.96 * 2.5], rtol=0.02)  # the table is linear between levels


def test_draws_over_points_have_the_correlation_of_the_copula() -> None:
    random = np.random.default_rng(2)
    copula = Copula(np.stack([random.permutation(500), np.arange(500)], axis=1), np.array([0.4]))
    angles = np.array([0.5, 0.7, 2.5])
    drawn = copula.drawn(np.cos(angles)[None], 20_000, random)
    for draws in drawn:
        assert np.abs(np.sort(draws, axis=0) - (np.arange(20_000) + 0.5)[:, None] / 20_000).max() < 0.015  # uniform
        score = np.clip(draws, 1e-9, 1 - 1e-9)
        correlation = np.corrcoef(ndtri(score), rowvar=False)
        np.testing.assert_allclose(correlation, np.exp(-0.5 * np.subtract.outer(angles, angles) ** 2 / 0.16), atol=0.03)


def test_too_many_points_are_refused_together(model: GridGP) -> None:
    many = {"x": np.linspace(0, 1, MOST_POINTS + 1), "y": 2.0}
    with pytest.raises(ValueError, match="3001 points are more than the 3000 that are drawn together; together=False"):
        model.sample(many, 1, 0)
    assert model.sample(many, 1, 0, together=False)["first"].shape == (1, MOST_POINTS + 1)


def _edited(path: Path, change: Callable[[xr.Dataset], xr.Dataset]) -> Path:
    changed = path.with_name("changed.nc")
    write_whole(change(read_whole(path, max_bytes=2**28)), changed)
    return changed


def test_a_file_of_before_is_read_and_draws_nothing_together(model: GridGP, tmp_path: Path) -> None:
    save(model, tmp_path / "a.nc")
    again = load(tmp_path / "a.nc")
    points = {"x": [0.1, 0.6], "y": 2.0}
    xr.testing.assert_identical(again.sample(points, 5, 1), model.sample(points, 5, 1))
    old = load(_edited(tmp_path / "a.nc", lambda d: d.drop_vars(["calibration_rank", "calibration_length"])))
    xr.testing.assert_identical(old.interval(points), model.interval(points))
    with pytest.raises(ValueError, match="the model's file kept no rows of its calibration"):
        old.sample(points, 5, 1)
    point = np.array([[0.1, 2.0]])
    assert (
        np.abs(old.ends_of_sum(point, np.array([[1.0, -1, 0]]))) > model.ends_of_sum(point, np.array([[1.0, -1, 0]]))
    ).all()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda d: d.assign(calibration_rank=d["calibration_rank"] * 0), "ranks .* are not each there once"),
        (lambda d: d.assign(calibration_length=-d["calibration_length"]), "rows of the calibration do not fit"),
        (
            lambda d: d.assign(calibration_rank=d["calibration_rank"].astype(float)),
            "rows of the calibration do not fit",
        ),
        (lambda d: d.drop_vars("calibration_length"), "calibration_length"),
    ],
)
def test_bad_rows_are_refused(
    change: Callable[[xr.Dataset], xr.Dataset], says: str, model: GridGP, tmp_path: Path
) -> None:
    save(model, tmp_path / "a.nc")
    with pytest.raises(FormatError, match=says):
        load(_edited(tmp_path / "a.nc", change))
