"""Cases that a surrogate asks for: where they lie, that they stand apart from even ones, and what they make surer."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from storage.netcdf import read_whole
from surrogate import GaussianProcess
from surrogate.data.points import EVEN
from tests.studies import edited, made, refusal
from workflow.dataset import draws, factorial, infill
from workflow.design.search import targets
from workflow.learning import training
from workflow.study.model import Study

STUDY = """\
title: A half-plane that asks
fixed: {composite: fibrous, charge: 0.0, radius: 0.05}
factors:
  volume_fraction: {low: 0.1, high: 0.9, levels: 7}
  friction: {low: 0.0, high: 0.6, levels: 3}
  load: {low: 3e3, high: 3e5, levels: 3, scale: log}
dataset: {slabs: 2}
surrogate: {budget: 300, outputs: [voltage_per_load, trailing_tension]}
validation: {cases: 20, calibration: 400}
design:
  sensor:
    maximise: abs(voltage_per_load)
    over: [volume_fraction]
    at: {load: 5e3}
    worst_case: {friction: [0.1, 0.4]}
    subject_to: [trailing_tension <= 100 MPa]
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(STUDY)


@pytest.fixture(scope="module")
def known(study: Study) -> tuple[xr.Dataset, xr.Dataset]:
    """The factorial, and the cases for calibration."""
    return factorial.exact(study, factorial.axes(study)), factorial.cases(study, "calibration")


def fitted(study: Study, known: tuple[xr.Dataset, xr.Dataset], *further: xr.Dataset) -> GaussianProcess:
    quantities, calibration = known
    cases = infill.joined(calibration, list(further))
    return training.calibrated(study, training.fit(study, quantities), quantities, cases)


def test_a_design_is_surer_by_cases_near_it(study: Study, known: tuple[xr.Dataset, xr.Dataset], tmp_path: Path) -> None:
    before = fitted(study, known)
    design = targets.doubted(study, "sensor", before)
    infill.write(study, design, 0, tmp_path / "0.nc")
    further = []
    for index in range(infill.slabs(study, tmp_path / "0.nc")):
        infill.write_slab(study, tmp_path / "0.nc", index, tmp_path / f"0_{index}.nc")
        further.append(read_whole(tmp_path / f"0_{index}.nc"))
    assert [part.sizes["case"] for part in further] == [60, 40]
    none = infill.gathered([])
    whole = infill.joined(known[1], [none, infill.gathered(further)])
    assert infill.joined(known[1], [none]) is known[1]
    assert (whole[EVEN].values == np.repeat([1, -1], [known[1].sizes["case"], 100])).all()
    after = fitted(study, known, *further)
    # exact cases on which the design rests, of which none was asked for
    cases = factorial.exact(study, {name: xr.DataArray(f[::10], dims="case") for name, f in design.factors.items()})
    exact = np.stack([cases[name].values for name in study.outputs], axis=-1)
    X = np.stack([cases[name].values for name in study.factors], axis=-1)
    errors = [np.sqrt(((model.predict_array(X) - exact) ** 2).mean(axis=0)) for model in (before, after)]
    widths = [np.ptp(model.interval_array(X), axis=0).mean(axis=0) for model in (before, after)]
    assert (errors[1] < 0.7 * errors[0]).all()
    assert (widths[1] < 0.5 * widths[0]).all()


def test_cases_lie_beside_those_on_which_a_design_rests_and_within_the_box(study: Study) -> None:
    edge = infill.Place(
        "a", 1.0, {"volume_fraction": np.array([0.9]), "friction": np.array([0.1]), "load": np.array([5e3])}
    )
    drawn = infill.near(study, edge, 1)
    assert {values.size for values in drawn.values()} == {100}
    for axis in factorial.inputs(study):
        t = axis.to_unit(drawn[axis.name].values)
        assert (np.abs(t) <= 1).all()
        assert (np.abs(t - axis.to_unit(edge.factors[axis.name])) <= infill.AROUND + 1e-12).all()
    again = infill.near(study, edge, 1)
    assert all((drawn[name] == again[name]).all() for name in drawn)


def test_no_case_is_asked_for_where_all_is_sure_enough(study: Study, tmp_path: Path) -> None:
    factors = {name: np.array([axis.low]) for name, axis in study.factors.items()}
    surrogate = study.surrogate.model_copy(update={"until": 1e-3})
    until = study.model_copy(update={"surrogate": surrogate})
    for doubt, files in ((0.9e-3, 0), (1.1e-3, 2)):
        infill.write(until, infill.Place("sensor", doubt, factors), 0, tmp_path / "round.nc")
        assert infill.slabs(until, tmp_path / "round.nc") == files


def test_without_designs_cases_lie_where_intervals_are_widest(
    study: Study, known: tuple[xr.Dataset, xr.Dataset]
) -> None:
    model = fitted(study, known)
    found = training.widest(study, model, 0)
    wide, all_wide = (
        np.subtract(*reversed(model.interval_array(np.stack(list(points), axis=-1)))).mean(axis=0)
        for points in (found.factors.values(), [v.values for v in draws.points(study, 500, (9,)).values()])
    )
    assert (wide > all_wide).all()


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("budget: 300", "until: 0.1", "surrogate: until: needs a budget"),
        ("budget: 300", "budget: 3", "surrogate.budget: 3"),
        ("slabs: 2", "slabs: 2, peaks: true", "surrogate: budget: a data set with largest stresses asks for no cases"),
    ],
)
def test_bad_budgets_are_refused_in_one_line(old: str, new: str, expected: str) -> None:
    assert expected in refusal(edited(STUDY, old, new))
