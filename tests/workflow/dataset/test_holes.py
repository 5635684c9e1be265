"""Studies of which the solver refuses some cases: a mask with reasons in the files, all others as they are alone.

A flat punch that is tilted needs tension once it tilts too far for its load: the half-plane says so at once.
"""

import json
import re
from itertools import count
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from solver import CaseError, solve
from storage.netcdf import read_whole
from tests.studies import data_set, edited, made, refusal
from workflow.dataset import factorial, holes
from workflow.dataset import slabs as dataset
from workflow.learning import training
from workflow.study import refusals, solvable
from workflow.study.model import Study
from workflow.study.refusals import REASON, REFUSAL

STUDY = """\
title: How far may a flat punch tilt?
fixed: {composite: fibrous, profile: flat, volume_fraction: 0.4, charge: 0.0, magnetic_charge: 0.0, width: 0.025}
factors:
  slope: {low: 1e-5, high: 1e-4, levels: 6}
  friction: {low: 0.0, high: 0.4, levels: 3}
  load: {low: 2e5, high: 1e6, levels: 7, scale: log}
dataset: {slabs: 2, peaks: false, positions: {inside: 6, outside: 4}}
validation: {cases: 40, calibration: 100}
"""
REASON_GIVEN = "contact: it would need tension between punch and surface (too much tilt or moment)"


@pytest.fixture(scope="module")
def study() -> Study:
    return made(STUDY)


@pytest.fixture(scope="module")
def folder(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files that the pipeline's rules make of the data set."""
    folder = tmp_path_factory.mktemp("results")
    data_set(study, folder)
    return folder


def test_the_mask_is_that_of_cases_solved_alone(study: Study, folder: Path) -> None:
    data = read_whole(folder / "quantities.nc")
    mask = data[REFUSAL] > 0
    assert 0.02 < float(mask.mean()) < refusals.MOST
    assert data[REASON].values.tolist() == [REASON_GIVEN]
    assert {name for name in data.data_vars if name != REASON and np.isnan(data[name]).any()} == {*study.quantities}
    levels = factorial.levels(study)
    random = np.random.default_rng(1)
    places = [tuple(place) for place in random.permutation(np.argwhere(mask.values))[:3]]
    places += [tuple(place) for place in random.permutation(np.argwhere(~mask.values))[:4]]
    for place in places:
        case = {name: levels[name][k] for name, k in zip(map(str, mask.dims), place, strict=True)}
        if mask.values[place]:
            with pytest.raises(CaseError, match=re.escape(REASON_GIVEN)):
                solve({**study.fixed, **case})
            assert all(np.isnan(data[name].values[place]) for name in study.quantities)
        else:
            alone = solve({**study.fixed, **case})
            for name in study.quantities:
                np.testing.assert_allclose(data[name].values[place], alone[name], rtol=1e-12)


def test_the_card_counts_no_refused_case(folder: Path) -> None:
    card = json.loads((folder / dataset.CARD).read_text(encoding="utf-8"))
    mask = read_whole(folder / "quantities.nc")[REFUSAL].values > 0
    assert (card["refused"]["places"], card["refused"]["of"]) == (mask.sum(), mask.size)
    assert card["refused"]["reasons"] == {REASON_GIVEN: mask.sum()}
    assert "they lie within slope " in card["refused"]["told"]
    for name in ("contact_pressure", "depth"):
        values = np.concatenate([read_whole(folder / file["name"])[name].values for file in card["files"]])
        described = card["variables"][name]
        assert described["count"] == np.isfinite(values).sum() < values.size
        assert described["attributes"]["mean"] == pytest.approx(np.nanmean(values.astype(float)), rel=1e-9)


def test_random_cases_that_are_refused_are_left_out_and_counted(study: Study) -> None:
    drawn = factorial.cases(study, "calibration")
    refused = holes.refused(drawn, ["case"])
    assert 0 < refused.sum() < 0.2 * 100
    assert np.isfinite(drawn["depth"].values).tolist() == (~refused).tolist()
    assert holes.reasons(drawn, ["case"]) == [REASON_GIVEN] * int(refused.sum())


def test_a_factorial_that_lacks_too_much_is_refused_in_one_line() -> None:
    mask = np.zeros((4, 5), dtype=np.int32)
    mask[:, 4] = 2, 1, 2, 2
    mask[0, 0] = 1
    whole = refusals.masked(xr.Dataset(), xr.Variable(("a", "b"), mask), ["too far", "too near"])
    with pytest.raises(refusals.HolesError) as caught:
        holes.check(whole, ["a", "b"])
    assert str(caught.value) == "5 of 20 places (25 %) are refused: too near; at most 20 % may be"


def test_a_box_of_which_most_is_refused_is_bad_input() -> None:
    message = refusal(edited(STUDY, "low: 2e5", "low: 2e4"))
    assert message.startswith("factors: the solver refuses more than 20 % of the box: contact: it would")


def test_a_check_that_takes_long_ends_and_tells_the_time_of_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock on which every look takes 200 s: no place of the box is tried, and the hours of the run are told."""
    looks = count(0.0, 200.0)
    monkeypatch.setattr(solvable, "process_time", lambda: next(looks))
    study = made(edited(STUDY, "low: 2e5", "low: 2e4"))
    expected = "time: a case takes about 25 s of one core; the 126 of the data set take about 0.88 h, and random cases"
    assert study.defaults[-1].startswith(expected)


def test_a_surrogate_with_holes_is_exact_at_its_nodes_and_refuses_beyond_its_edge(study: Study, folder: Path) -> None:
    """Oracles: the solver at its nodes, and on fresh cases whether it answers and what."""
    whole = read_whole(folder / "quantities.nc")
    model = training.fit(study, whole)
    nodes = factorial.training_data(study, whole)
    points = {name: nodes[name] for name in study.factors}
    predicted = model.predict(points, return_std=False)
    for name in ("depth", "contact_trailing", "voltage_per_load"):
        truth = nodes[name].transpose(*study.factors).values
        errors = np.abs(predicted[name].transpose(*study.factors).values - truth)
        assert np.nanmax(errors) <= 1e-12 * np.nanmax(np.abs(truth))
    training.calibrated(study, model, whole, factorial.cases(study, "calibration"))
    assert model.region_ is not None
    other = study.validation.model_copy(update={"seed": 9})
    fresh = factorial.cases(study.model_copy(update={"validation": other}), "validation")
    table = training.validate(study, whole, fresh, model)
    assert table.attrs["drawn"] == 40
    assert table.attrs["refused_inside"] <= 1
    assert table.attrs["answered_outside"] <= 4
    assert float(table["max_error"].max()) < 1e-2  # what three levels of friction can tell
    assert table.sizes["case"] == 40 - table.attrs["refused"] - table.attrs["answered_outside"]
