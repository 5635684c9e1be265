"""Data sets and surrogates of films, against the exact solver case by case."""

import numpy as np
import pytest

import solver
from tests.studies import made
from workflow.dataset import effects
from workflow.study.model import Study

FILM = """\
title: A film on two bases
fixed: {surroundings: insulated, composite: fibrous, radius: 0.05, friction: 0.2}
categories: {base: [rigid, steel]}
factors:
  load: {low: 2e4, high: 4e4, levels: 5, scale: log}
  thickness: {low: 1.5e-4, high: 3e-4, levels: 6, scale: log}
  volume_fraction: {low: 0.45, high: 0.55, levels: 3}
dataset: {slabs: 2, positions: {inside: 4, outside: 2}}
effects:
  baseline: {volume_fraction: 0.5, radius: 0.05, load: 3e4, friction: 0.3}
  film: {thickness: 2e-4, base: silicon}
  vary: {thickness: [1e-4, 2e-4], base: [rigid, silicon], friction: [0.0, 0.3]}
  positions: {inside: 5, outside: 4}
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(FILM)


@pytest.mark.parametrize(("factor", "last"), [("thickness", np.nan), ("base", "half-plane")])
def test_effects_of_films_stand_beside_the_half_plane(study: Study, factor: str, last: object) -> None:
    assert study.effects is not None
    curves = effects.effect(study, factor)
    np.testing.assert_array_equal(curves[factor].values[-1:], [last])
    positions = study.effects.positions.values()
    baseline = dict(study.effects.baseline)
    np.testing.assert_array_equal(
        curves["contact_pressure"].isel({factor: -1}), solver.solve(baseline, positions)["contact_pressure"]
    )
    film = solver.solve(baseline | {"thickness": 2e-4, "surroundings": "insulated", "base": "silicon"}, positions)
    np.testing.assert_allclose(curves["stress_xx"].isel({factor: 1}), film["stress_xx"], rtol=1e-12)
    assert "thickness" not in effects.effect(study, "friction").coords
