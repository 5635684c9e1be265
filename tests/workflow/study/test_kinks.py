"""Factors whose kinks a study names: levels of every part, a process that knows them, and what is refused."""

import numpy as np
import pytest
import xarray as xr

from surrogate import SplitGP, chebyshev_levels
from tests.studies import edited, made, refusal
from workflow.dataset import factorial
from workflow.learning import imputation, training
from workflow.study.model import Study

STUDY = """\
title: A half-plane with a kink
fixed: {composite: fibrous, load: 1e4}
factors:
  volume_fraction: {low: 0.4, high: 0.8, levels: 6}
  radius: {low: 20 mm, high: 200 mm, levels: 5, scale: log, kinks: [70 mm]}
surrogate: {outputs: [voltage, peak_pressure]}
validation: {cases: 60, calibration: 200, tolerance: 1e-2}
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(STUDY)


def test_levels_are_those_of_every_part(study: Study) -> None:
    parts = [chebyshev_levels(0.02, 0.07, 5, "log"), chebyshev_levels(0.07, 0.2, 5, "log")]
    np.testing.assert_array_equal(factorial.levels(study)["radius"], np.concatenate(parts))
    assert study.cases == 6 * 10
    assert study.kinks == {"radius": [0.07]}


def test_the_surrogate_of_a_study_knows_its_kinks(study: Study) -> None:
    quantities = factorial.exact(study, factorial.axes(study))
    model = training.calibrated(
        study, training.fit(study, quantities), quantities, factorial.cases(study, "calibration")
    )
    assert isinstance(model, SplitGP)
    table = training.validate(study, quantities, factorial.cases(study, "validation"), model)
    assert float(table["max_error"].max()) < 1e-4
    # a bend at the kink, beside what the solver says
    bent = quantities.assign(voltage=abs(np.log(quantities["radius"] / 0.07)) * (1 + quantities["volume_fraction"]))
    process = training.process(study, ["voltage"]).fit(bent)
    radius = xr.DataArray([0.03, 0.069, 0.08], dims="case")
    found = process.predict({"radius": radius, "volume_fraction": 0.5})["voltage"]
    np.testing.assert_allclose(found, 1.5 * abs(np.log(radius / 0.07)), rtol=0, atol=1e-9)


def test_places_that_are_refused_are_filled_in_on_their_side_of_the_kink(study: Study) -> None:
    """A bend at the kink: what is beyond it must not tell what is missing."""
    whole = factorial.axes(study)
    grid = xr.Dataset(coords={name: (name, values) for name, values in whole.items()})
    away = abs(xr.apply_ufunc(np.log, grid["radius"] / 0.07))
    bent = away * xr.apply_ufunc(np.exp, grid["volume_fraction"])
    holes = (grid["volume_fraction"] > 0.7) & (away < 0.25)
    data = xr.Dataset({"voltage": bent.where(~holes), "peak_pressure": bent + 1})
    found = imputation.imputed(study, data)
    assert holes.sum("volume_fraction").values.tolist() == [0] * 4 + [2] * 3 + [0] * 3  # on both sides of it
    np.testing.assert_array_equal(found["voltage"].where(~holes), data["voltage"])
    np.testing.assert_array_equal(found["peak_pressure"], data["peak_pressure"])
    # what four levels of the volume fraction tell of an exponential; across the bend it would be 0.1 of the range
    np.testing.assert_allclose(found["voltage"], bent, rtol=0, atol=1e-3 * float(bent.max()))
    beyond = data.assign(voltage=bent.where(grid["radius"] < 0.07))
    with pytest.raises(ValueError, match=r"all cases between kinks are refused: radius in \[0\.07, 0\.2\] m"):
        imputation.imputed(study, beyond)


def test_a_study_without_kinks_is_what_it_was(study: Study) -> None:
    plain = study.factors["volume_fraction"].model_dump(mode="json")
    assert set(plain) == {"low", "high", "levels", "scale"}


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("[70 mm]", "[20 mm]", "kinks: 0.02 must differ and lie inside of 0.02 to 0.2"),
        ("[70 mm]", "[70 N]", "radius: kinks"),
        ("levels: 6", "scale: linear", "factors: radius: kinks: levels are missing"),
        ("surrogate: {", "surrogate: {kernel: rbf, ", "kernel: chebyshev"),
        ("validation:", "dataset: {peaks: true}\nvalidation:", "dataset: peaks: must be false"),
    ],
)
def test_what_kinks_do_not_go_with_is_refused(old: str, new: str, expected: str) -> None:
    assert expected in refusal(edited(STUDY, old, new))
