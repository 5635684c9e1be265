"""Groups in a study: which are told apart, what is refused in one line, and similar cases that the data set holds."""

import numpy as np
import pytest
import xarray as xr

from surrogate import GroupedGP
from tests.studies import edited, fitted, made
from workflow.dataset import factorial
from workflow.learning import training
from workflow.study import representatives
from workflow.study.model import Study
from workflow.study.reading import InputError

STUDY = """\
title: A half-plane in groups
fixed: {composite: fibrous, datum: 0.5}
factors:
  volume_fraction: {low: 0.2, high: 0.8}
  friction: {low: 0.0, high: 0.4}
  radius: {low: 0.02, high: 0.2, scale: log}
  load: {low: 5e3, high: 5e4, scale: log}
  charge: {low: -1e-6, high: 2e-6}
groups:
  volume_fraction: {levels: 8, scale: logit}
  friction: {levels: 4}
  load * radius / datum^2: {levels: 5}
  charge / load: {levels: 3}
dataset: {slabs: 2, positions: {inside: 6, outside: 2}}
surrogate: {outputs: [depth, voltage, peak_pressure, trailing_tension, blocked_load_per_volt, contact_trailing]}
validation: {cases: 300, calibration: 600, tolerance: 1e-3}
"""


@pytest.fixture(scope="module")
def half_plane() -> Study:
    return made(STUDY)


@pytest.fixture(scope="module")
def model(half_plane: Study) -> GroupedGP:
    grouped = fitted(half_plane, calibrated=True)
    assert isinstance(grouped, GroupedGP)
    return grouped


def test_axes_are_the_groups_over_the_box(half_plane: Study) -> None:
    assert list(half_plane.axes) == ["volume_fraction", "friction", "load_radius_per_datum2", "charge_per_load"]
    pressed, charged = half_plane.axes["load_radius_per_datum2"], half_plane.axes["charge_per_load"]
    np.testing.assert_allclose([pressed.low, pressed.high], [5e3 * 0.02 / 0.25, 5e4 * 0.2 / 0.25], rtol=1e-9)
    np.testing.assert_allclose([charged.low, charged.high], [-1e-6 / 5e3, 2e-6 / 5e3], rtol=1e-12)
    assert (pressed.scale, charged.scale, half_plane.axes["volume_fraction"].scale) == ("log", "linear", "logit")
    assert half_plane.cases == 8 * 4 * 5 * 3
    assert list(half_plane.factors) == ["volume_fraction", "friction", "radius", "load", "charge"]


def test_stored_cases_have_the_values_of_the_groups(half_plane: Study) -> None:
    axes = factorial.levels(half_plane)
    factors = representatives.factors(half_plane, axes)
    assert factors["radius"] == pytest.approx(np.sqrt(0.02 * 0.2))
    load, charge = xr.DataArray(factors["load"]), xr.DataArray(factors["charge"])
    np.testing.assert_allclose(load * factors["radius"] / 0.25, axes["load_radius_per_datum2"], rtol=1e-12)
    np.testing.assert_allclose((charge / load).isel(load_radius_per_datum2=2), axes["charge_per_load"], rtol=1e-12)


def test_what_the_surrogate_says_in_the_factors_is_exact(half_plane: Study, model: GroupedGP) -> None:
    fresh = factorial.cases(half_plane, "validation")
    table = training.validate(half_plane, factorial.exact(half_plane, factorial.axes(half_plane)), fresh, model)
    assert float(table.max_error.max()) < 1e-4
    assert float(np.abs(table.coverage - 0.95).max()) < 0.05
    assert list(table.axis.values) == list(half_plane.axes)
    assert list(model.box) == list(half_plane.factors)


def test_logarithms_are_chosen_by_decay_and_refused_of_signs() -> None:
    wide = STUDY.replace("low: 0.02, high: 0.2", "low: 0.005, high: 0.2").replace("5e3, high: 5e4", "3e3, high: 3e5")
    wide = wide.replace("datum: 0.5", "datum: 1.0")
    half_plane = made(wide)
    data = factorial.exact(half_plane, factorial.axes(half_plane))
    learned = factorial.with_factors(half_plane, factorial.training_data(half_plane, data))
    chosen = factorial.grouping(half_plane, learned)
    assert chosen.scalings["blocked_load_per_volt"].logarithm == -1
    assert chosen.scalings["depth"].logarithm == 0
    named = made(wide.replace("surrogate: {", "surrogate: {log: [trailing_tension], "))
    logs = {name: scaling.logarithm for name, scaling in factorial.grouping(named, learned).scalings.items()}
    assert logs.pop("trailing_tension") == 1
    assert not any(logs.values())
    signs = made(wide.replace("surrogate: {", "surrogate: {log: [voltage], "))
    wrong = learned.assign(voltage=learned["voltage"] - learned["voltage"].mean())
    with pytest.raises(InputError, match=r"surrogate: log: 'voltage' is from -.* to .*: no logarithm"):
        factorial.grouping(signs, wrong)


def test_groups_that_do_not_tell_the_datum_or_an_elastic_punch_leave_out_what_hangs_on_them() -> None:
    """Without a datum load and radius scale away; that of an elastic punch is its radius."""
    without = edited(STUDY, "  load * radius / datum^2: {levels: 5}\n", "")
    without = edited(without, "depth, voltage, ", "").replace("blocked_load_per_volt, ", "")
    assert made(without).outputs == ["peak_pressure", "trailing_tension", "contact_trailing"]
    elastic = made(edited(STUDY, "datum: 0.5}", "datum: 0.5, punch: steel}").split("surrogate:")[0])
    assert {"depth", "blocked_load_per_volt", "blocked_load_per_ampere"}.isdisjoint(elastic.outputs)
    assert "voltage" in elastic.outputs
