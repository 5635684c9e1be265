"""Errors together: sums of outputs and of near points hold on fresh cases."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from storage.netcdf import read_whole, write_whole
from surrogate import GridGP, Input, load, save
from surrogate.intervals.copula import Copula, ends
from surrogate.intervals.distribution import PROBABILITIES, Normal, Tabulated
from tests.surrogate import functions

INPUTS = (Input("x", 0.0, 1.0), Input("y", 1.0, 3.0))


def truth(x: Any, y: Any) -> dict[str, Any]:
    """Outputs that share a near-pole, and one that does not."""
    pole, wave = 1 / (x + 0.1) ** y, np.cos(5 * x * y)
    return {"first": 3 + pole, "second": 2 + 0.7 * pole + 0.002 * wave, "other": np.exp(np.sin(4 * x * y) / y)}


def cases(count: int, seed: int) -> xr.Dataset:
    points = functions.drawn(INPUTS, count, seed)
    return points.assign(truth(points["x"], points["y"]))


@pytest.fixture(scope="module")
def model() -> GridGP:
    grid = functions.grid(INPUTS, (12, 8))
    return GridGP(inputs=INPUTS).fit(grid.assign(truth(grid["x"], grid["y"]))).calibrate(cases(3000, 1))


def test_closed_sums_reach_as_far_as_they_should(model: GridGP) -> None:
    fresh = cases(600, 8)
    X = np.stack([fresh["x"], fresh["y"]], axis=1)
    error = np.stack([fresh[name] for name in model.outputs_], axis=1) - model.predict_array(X)
    for weights in ([1.0, 1.0, 0.0], [0.4, -1.0, 0.0], [1.0, 0.0, -0.5]):
        ends_of_sums = np.array([model.ends_of_sum(x[None], np.array([weights])) for x in X])
        sums = error @ weights
        inside = np.mean((ends_of_sums[:, 0] <= sums) & (sums <= ends_of_sums[:, 1]))
        assert inside == pytest.approx(0.955, abs=4 * np.sqrt(0.95 * 0.05 / 600) + 0.01)


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


def test_a_file_of_before_is_read_and_adds_errors(model: GridGP, tmp_path: Path) -> None:
    save(model, tmp_path / "a.nc")
    write_whole(read_whole(tmp_path / "a.nc").drop_vars(["calibration_rank", "calibration_length"]), tmp_path / "b.nc")
    old, points = load(tmp_path / "b.nc"), {"x": [0.1, 0.6], "y": 2.0}
    xr.testing.assert_identical(old.interval(points), model.interval(points))
    sums = [np.abs(process.ends_of_sum(np.array([[0.1, 2.0]]), np.array([[1.0, -1, 0]]))) for process in (old, model)]
    assert (sums[0] > sums[1]).all()
