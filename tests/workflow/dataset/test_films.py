"""Data sets and surrogates of films, against the exact solver case by case."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import solver
from solver.fields import FIELDS
from storage.netcdf import read_whole
from tests.studies import made
from workflow.dataset import datacard, draws, effects, factorial
from workflow.dataset import slabs as dataset
from workflow.dataset.slabs import gather
from workflow.learning import training
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


@pytest.fixture(scope="module")
def slabs(study: Study, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("slabs")
    paths = [folder / f"slab_{index}.nc" for index in range(2)]
    for index, path in enumerate(paths):
        dataset.write_slab(study, index, path)
    return paths


def test_every_case_of_the_data_set_is_the_solvers(study: Study, slabs: list[Path]) -> None:
    parts = [read_whole(path) for path in slabs]
    assert [part.sizes["volume_fraction"] for part in parts] == [2, 1]  # tables are not shared by slabs
    assert parts[0].attrs["title"] == "exact solution of a punch on a magneto-electro-elastic film"
    assert parts[0]["voltage"].attrs["long_name"] == "electric potential of the punch"
    for part, where in zip(parts, ((1, 3, 4, 0), (0, 5, 0, 1)), strict=True):
        names = ("volume_fraction", "load", "thickness", "base")
        stored = part.isel(dict(zip(names, (where[0], where[2], where[1], where[3]), strict=True)))
        case = {name: stored[name].item() for name in names}
        exact = solver.solve(study.fixed | case, stored["position"].values)
        for name in (*study.quantities, *FIELDS):
            np.testing.assert_allclose(
                stored[name], exact[name], rtol=1e-9, atol=1e-9 * float(np.abs(part[name]).max())
            )


def test_the_surrogate_of_a_few_tables_hits_cases_between_them(study: Study, slabs: list[Path]) -> None:
    whole = gather([read_whole(path) for path in slabs])
    model = training.fit(study, whole)
    rng = np.random.default_rng(4)
    points = {
        name: xr.DataArray(axis.low + (axis.high - axis.low) * rng.uniform(size=6), dims="case")
        for name, axis in study.factors.items()
    }
    exact = factorial.training_data(study, factorial.exact(study, points))
    predicted = model.predict(points, return_std=False)
    whole = factorial.training_data(study, whole)
    for name in study.output_names:
        np.testing.assert_allclose(predicted[name], exact[name], atol=2e-3 * float(np.ptp(whole[name].values)))
    assert "voltage[steel]" in study.output_names


def test_random_cases_share_tables(study: Study) -> None:
    drawn = draws.points(study, 120, (1, 0))
    places = np.unique(drawn["volume_fraction"])
    assert np.all(np.floor((places - 0.45) / 0.1 * 12) == np.arange(12))  # spread over the axis
    assert len(np.unique(drawn["load"])) == len(np.unique(drawn["thickness"])) == 120


def test_the_card_says_what_hangs_on_the_datum(study: Study, slabs: list[Path]) -> None:
    card = datacard.card(study, "film", slabs, [])
    assert card["on_datum"] == ["blocked_load_per_ampere", "blocked_load_per_volt", "depth", "flux_per_force"]
    assert "depend blocked_load" not in datacard.markdown(card | {"on_datum": []})


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
