"""Groups in a study: which are told apart, what is refused in one line, and similar cases that the data set holds."""

import re

import numpy as np
import pytest
import xarray as xr

from surrogate import GroupedGP
from tests.studies import fitted, made, refusal
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


def test_a_half_plane_without_the_datum_in_a_group_is_told_what_hangs_on_it() -> None:
    """Without a datum load and radius scale away: contact and stresses are told without any group that holds them."""
    text = STUDY.replace("  load * radius / datum^2: {levels: 5}\n", "")
    assert "depend on the datum, which is in no group" in refusal(text)
    without = text.replace("depth, voltage, ", "").replace("blocked_load_per_volt, ", "")
    assert made(without).outputs == ["peak_pressure", "trailing_tension", "contact_trailing"]


ELASTIC = STUDY.replace("{composite: fibrous, datum: 0.5}", "{composite: fibrous, datum: 0.5, punch: steel}")


def test_groups_that_do_not_tell_an_elastic_punch_s_depth_leave_it_out() -> None:
    """The punch's datum is its radius: the depths of two cases of one group differ by a logarithm."""
    assert "groups: depth, blocked_load_per_volt depend on an elastic punch's radius" in refusal(ELASTIC)
    rigid = made(ELASTIC.replace("punch: steel", "punch: rigid"))
    assert "depth" in rigid.outputs
    silent = made(ELASTIC.split("surrogate:")[0])
    assert {"depth", "blocked_load_per_volt", "blocked_load_per_ampere"}.isdisjoint(silent.outputs)
    assert "voltage" in silent.outputs


FOUR_FACTORS = """\
title: Groups at random
fixed: {composite: fibrous, friction: 0.2}
factors:
  volume_fraction: {low: 0.3, high: 0.6}
  radius: {low: 0.02, high: 0.04}
  load: {low: 1e4, high: 2e4}
  charge: {low: -1e-8, high: 2e-8}
dataset: {slabs: 1, positions: {inside: 4, outside: 2}}
surrogate: {outputs: [contact_trailing, peak_pressure]}
validation: {cases: 20, calibration: 40}
"""


@pytest.mark.parametrize(
    ("groups", "says"),
    [
        (["volume_fraction", "load * radius", "charge^2 / load^2"], "the sign of charge is in no group"),
        (["charge / load", "volume_fraction", "radius * charge"], "radius = -0.05.* in a corner"),
        (["charge / load", "volume_fraction * charge / load", "load * radius"], "charge = 0 is in the box, where"),
        (
            ["volume_fraction * load * radius", "load * radius", "charge / load"],
            "volume_fraction = 2.4 .* must be a finite",
        ),
        (["volume_fraction", "load * radius * volume_fraction", "charge / load"], "'volume_fraction' is a group of"),
    ],
)
def test_groups_that_cannot_be_solved_or_do_not_tell_are_refused(groups: list[str], says: str) -> None:
    """Each had passed the check, and ended in a job or with one answer to two questions."""
    levels = {text: {"levels": 3} for text in groups}
    assert re.search(f"groups: .*{says}", refusal(FOUR_FACTORS + f"groups: {levels}\n"))
