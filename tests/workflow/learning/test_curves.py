"""Largest stresses by curves and surface fields from their surrogates, against the exact solver."""

import re

import numpy as np
import pytest
import xarray as xr

from solver import solve
from surrogate import CurveGP, GaussianProcess, GridGP, OutOfBoxError, load, save
from tests.studies import fitted, made
from workflow.dataset import factorial
from workflow.learning import curves, surface, training

STUDY = """\
title: Two axes stand for four factors
fixed: {composite: fibrous}
factors:
  volume_fraction: {low: 0.4, high: 0.6}
  friction: {low: 0.1, high: 0.3}
  radius: {low: 0.01, high: 0.1, scale: log}
  load: {low: 1e4, high: 1e5, scale: log}
groups:
  volume_fraction: {levels: 5}
  friction: {levels: 6}
dataset: {peaks: [peak_von_mises, peak_von_mises_depth]}
surrogate: {outputs: [peak_von_mises, peak_von_mises_depth, peak_pressure]}
"""


def test_over_groups_sizes_carry_the_scale_and_curves_have_none() -> None:
    study = made(STUDY)
    assert study.regions == ["body"]
    assert "peak_principal_tension" not in study.quantities  # nobody asked for its search
    data = factorial.exact(study, factorial.axes(study), curves=True)
    model = training.fit(study, data)
    assert isinstance(model, CurveGP)
    assert curves.given(study, data)
    fresh = factorial.sample(study, 20, (7, 0))
    table = training.validate(study, data, fresh, model)  # 30 cases, over a decade of loads and one of radii
    assert (table["max_error"] < [5e-4, 2e-3, 5e-4]).all()
    assert np.ptp(fresh["peak_von_mises"].values) > 1e8
    assert (table["baseline_max_error"].sel(output="peak_pressure") < 1e-3).all()


def test_calibration_cases_have_curves_which_correct_the_largest_stresses() -> None:
    text = re.sub(r"  (radius|load):.*\n|groups:\n(  .*\n)*", "", STUDY)
    text = text.replace("composite: fibrous", "radius: 0.05, load: 5e4")
    text = text.replace("high: 0.6}", "high: 0.8, levels: 7}").replace("high: 0.3}", "high: 0.5, levels: 6}")
    study = made(f"{text}validation: {{cases: 100, calibration: 200, tolerance: 1e-5}}")
    held, fresh = (factorial.cases(study, sample) for sample in ("calibration", "validation"))
    assert curves.given(study, held)
    assert not curves.given(study, fresh)
    model = training.fit(study, factorial.exact(study, factorial.axes(study), curves=True))
    points = {name: fresh[name] for name in study.factors}
    before = model.predict(points, return_std=False)["peak_von_mises"]
    after = model.calibrate(curves.training_data(study, held)).predict(points, return_std=False)["peak_von_mises"]
    errors = [np.median(np.abs(predicted - fresh["peak_von_mises"])) for predicted in (before, after)]
    assert errors[1] < 0.3 * errors[0]


TEXT = """\
title: Fields as a surrogate
fixed: {composite: fibrous, magnetic_charge: 1e-5}
factors:
  volume_fraction: {low: 0.4, high: 0.8, levels: 16}
  friction: {low: 0.0, high: 0.5, levels: 8}
  load: {low: 5e3, high: 5e4, levels: 9, scale: log}
  charge: {low: -1e-6, high: 1e-6, levels: 2}
  radius: {low: 0.02, high: 0.1, levels: 7, scale: log}
surrogate: {outputs: [pressure_exponent], fields: 20}
validation: {cases: 4000, calibration: 2000, tolerance: 1e-4}
"""


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> tuple[GridGP, GaussianProcess]:
    study = made(TEXT)
    path = tmp_path_factory.mktemp("model") / "surface.nc"
    save(surface.fit(study), path)
    fields = load(path)
    assert isinstance(fields, GridGP)
    return fields, fitted(study)


def test_fields_are_the_exact_ones_up_to_the_edges(models: tuple[GridGP, GaussianProcess]) -> None:
    study = made(TEXT)
    random = np.random.default_rng(3)
    shares = {axis: random.uniform(-1, 1, 200) for axis in factorial.inputs(study)}
    points = {axis.name: xr.DataArray(axis.from_unit(share), dims="case") for axis, share in shares.items()}
    X = np.array([-1 + 1e-6, -0.97, -0.5, 0.0, 0.3, 0.9, 0.999, 1 - 1e-6])
    with pytest.raises(ValueError, match="positions: 1 is not under the punch"):
        surface.predict(*models, points, np.array([0.0, 1.0]))
    with pytest.raises(OutOfBoxError, match="load = 10 is outside"):
        surface.predict(*models, {**points, "load": 10.0}, np.array([0.0]))
    predicted = surface.predict(*models, points, X)
    exact = solve({**study.fixed, **points}, X)
    for name in surface.NAMES:
        assert predicted[name].dims == ("case", "position")
        assert predicted[name].attrs["units"] == exact[name].attrs["units"]
        # singular fields are as good as their regular parts
        weight = 1.0 if name == "contact_pressure" else np.sqrt(1 - X**2)
        error, size = np.abs(predicted[name].values - exact[name].values) * weight, np.abs(exact[name].values) * weight
        assert error.max() < 2e-5 * size.max()
        assert bool((predicted[f"{name}_std"] >= 0).all())


def test_intervals_of_the_regular_parts_hold(models: tuple[GridGP, GaussianProcess]) -> None:
    study = made(TEXT)
    table = surface.validate(study, models[0])
    np.testing.assert_allclose(table["coverage"], 0.95, rtol=0, atol=0.025)
    assert float(table["worst_decile_coverage"].min()) >= 0.85
    assert float(table["max_error"].max()) < 1e-4
