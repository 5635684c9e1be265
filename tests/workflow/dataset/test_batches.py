"""Films by cross approximation: batches of places, their slabs, and the surrogate, as jobs make them."""

import re
from pathlib import Path

import numpy as np
import pytest

from storage.netcdf import read_whole, write_whole
from surrogate import GridGP
from tests.studies import edited, fitted, made
from workflow.dataset import batches, datacard, draws, factorial
from workflow.dataset.slabs import gather
from workflow.learning import training
from workflow.study.model import Study

FILM = """\
title: Two layers
fixed: {surroundings: insulated, radius: 0.05, base: steel, friction: 0.2}
body:
  - {composite: fibrous, volume_fraction: volume_fraction, thickness: thickness}
  - composite: fibrous
    volume_fraction: lower_volume_fraction
    thickness: thickness
    below: {electric: grounded, magnetic: grounded}
factors:
  volume_fraction: {low: 0.45, high: 0.55, levels: 3}
  lower_volume_fraction: {low: 0.45, high: 0.55, levels: 4}
  thickness: {low: 2e-4, high: 2.5e-4, levels: 2, scale: log}
  load: {low: 2e4, high: 3e4, levels: 3, scale: log}
dataset: {slabs: 2}
surrogate: {method: cross, outputs: [voltage, contact_offset, charge_per_force]}
validation: {cases: 20, calibration: 40, tolerance: 1e-3}
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(FILM)


def run(study: Study, folder: Path) -> list[Path]:
    """Round after round as the rules make them; files that are there stay."""
    slabs: list[Path] = []
    for number in range(30):
        places = folder / f"{number}.nc"
        if not places.exists():
            batches.write_places(study, training.places(study, [read_whole(slab) for slab in slabs]), places)
        files = [folder / f"{number}_{index}.nc" for index in range(batches.slabs(study, places))]
        for index, file in enumerate(files):
            if not file.exists():
                batches.write_slab(study, places, index, file)
        if not files:
            return slabs
        slabs += files
    raise AssertionError("no end")


@pytest.fixture(scope="module")
def slabs(study: Study, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return run(study, tmp_path_factory.mktemp("cross"))


def test_it_is_the_surrogate_of_the_whole_factorial(study: Study, slabs: list[Path]) -> None:
    assert study.crossed == ["lower_volume_fraction", "volume_fraction"]
    crossed = training.fit(study, gather([read_whole(slab) for slab in slabs]))
    exact = factorial.training_data(study, factorial.exact(study, factorial.levels(study)))
    whole = GridGP(inputs=factorial.inputs(study), outputs=study.output_names, compression=1e-9).fit(exact)
    X = np.stack([values.values for values in draws.points(study, 200, (5,)).values()], axis=1)
    errors = np.abs(crossed.predict_array(X) - whole.predict_array(X)).max(axis=0)
    assert (errors <= 1e-3 * np.array([np.ptp(exact[name].values) for name in study.outputs])).all()
    assert crossed.made_from_ == study.physics


def test_slabs_and_restarts_change_no_byte(study: Study, slabs: list[Path], tmp_path: Path) -> None:
    single_slab = study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": 1})})
    # a run of one slab a batch that was ended after its first
    (tmp_path / "0.nc").write_bytes((slabs[0].parent / "0.nc").read_bytes())
    batches.write_slab(single_slab, tmp_path / "0.nc", 0, tmp_path / "0_0.nc")
    again = run(single_slab, tmp_path)
    assert len(again) < len(slabs)
    for name, files in (("again.nc", again), ("first.nc", slabs)):
        write_whole(gather([read_whole(slab) for slab in files]), tmp_path / name)
    assert (tmp_path / "again.nc").read_bytes() == (tmp_path / "first.nc").read_bytes()


def test_the_card_counts_what_was_solved(study: Study, slabs: list[Path]) -> None:
    card = datacard.card(study, "crossed", slabs, [])
    places = sum(read_whole(slab).sizes["place"] for slab in slabs)
    assert card["cases"] == 6 * places == 6 * sum(file["levels"] for file in card["files"])
    assert "a cross approximation asked for" in datacard.markdown(card)


HALF_PLANE = """\
title: A half-plane
fixed: {surroundings: insulated, composite: fibrous, friction: 0.2}
factors:
  volume_fraction: {low: 0.3, high: 0.7, levels: 9}
  radius: {low: 5e-3, high: 0.2, levels: 5, scale: log}
  load: {low: 3e3, high: 3e5, levels: 6, scale: log}
  charge: {low: -2e-6, high: 2e-6, levels: 3}
dataset: {slabs: 2, budget: 500}
surrogate: {method: auto, outputs: [voltage, peak_pressure, magnetic_potential]}
validation: {cases: 20, calibration: 40, tolerance: 1e-4}
"""
GROUPS = """\
groups:
  volume_fraction: {levels: 9, scale: logit}
  load * radius: {levels: 5}
  charge / load: {levels: 3}
"""


def test_a_study_of_groups_takes_a_part_of_its_factorial(tmp_path: Path) -> None:
    text = re.sub(r", levels: \d", "", HALF_PLANE).replace("method: auto", "method: cross")
    study = made(text + GROUPS)
    assert sorted(study.crossed) == sorted(study.axes)
    files = run(study, tmp_path)
    solved = gather([read_whole(file) for file in files])
    model = training.fit(study, solved)
    factorial_method = study.surrogate.model_copy(update={"method": "factorial", "log": []})
    whole = fitted(study.model_copy(update={"surrogate": factorial_method}))
    X = np.stack([values.values for values in draws.points(study, 200, (7,)).values()], axis=1)
    errors = np.abs(model.predict_array(X) - whole.predict_array(X)).max(axis=0)
    # what 24 places on levels keep, other points may exceed
    assert (errors <= 5 * study.validation.tolerance * np.ptp(whole.predict_array(X), axis=0)).all()
    assert solved.sizes["place"] == model.cases_ < study.cases
    table = training.validate(study, solved, factorial.sample(study, 60, (8,)), model)
    assert float(table["max_error"].max()) <= 2e-3


def test_a_factorial_within_the_budget_is_solved_whole() -> None:
    study = made(HALF_PLANE)
    assert sorted(study.crossed) == sorted(study.axes)
    assert not made(edited(HALF_PLANE, "budget: 500", "budget: 810")).crossed
