"""Surface fields from their surrogate against the exact solver."""

import numpy as np
import pytest
import xarray as xr

from solver import solve
from surrogate import GaussianProcess, GridGP, OutOfBoxError, load, save
from tests.studies import fitted, made
from workflow.dataset import factorial
from workflow.learning import surface
from workflow.study.model import Study

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
def study() -> Study:
    return made(TEXT)


@pytest.fixture(scope="module")
def models(study: Study, tmp_path_factory: pytest.TempPathFactory) -> tuple[GridGP, GaussianProcess]:
    path = tmp_path_factory.mktemp("model") / "surface.nc"
    save(surface.fit(study), path)
    fields = load(path)
    assert isinstance(fields, GridGP)
    return fields, fitted(study)


def test_fields_are_the_exact_ones_up_to_the_edges(study: Study, models: tuple[GridGP, GaussianProcess]) -> None:
    random = np.random.default_rng(3)
    points = {
        i.name: xr.DataArray(i.from_unit(random.uniform(-1, 1, 200)), dims="case") for i in factorial.inputs(study)
    }
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


def test_intervals_of_the_regular_parts_hold(study: Study, models: tuple[GridGP, GaussianProcess]) -> None:
    table = surface.validate(study, models[0])
    np.testing.assert_allclose(table["coverage"], 0.95, rtol=0, atol=0.025)
    assert float(table["worst_decile_coverage"].min()) >= 0.85
    assert float(table["max_error"].max()) < 1e-4
