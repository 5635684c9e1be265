"""Random cases of a box that has grown are as even over it as any, those towards the ends of groups among them."""

import numpy as np
import pytest
from scipy.stats import kstest

from tests.studies import made, refusal
from workflow.dataset import draws

STUDY = """\
title: A film in a wider box
fixed: {composite: fibrous, friction: 0.2, base: rigid, interface_electric: grounded, interface_magnetic: grounded,
        charge: 0.0, magnetic_charge: 0.0}
factors:
  volume_fraction: {low: 0.1, high: 0.9, grown_from: [0.2, 0.8]}
  thickness: {low: 2e-4, high: 4e-3, scale: log}
  radius: {low: 0.03, high: 0.12, scale: log, grown_from: [0.03, 0.09]}
  load: {low: 2e3, high: 1e4, scale: log}
groups:
  volume_fraction: {levels: 6, scale: logit}
  load * radius / thickness^2: {levels: 9, scale: log}
"""


@pytest.mark.parametrize("ends", [False, True])
def test_cases_of_a_grown_box_are_even_and_those_of_before_stay(ends: bool) -> None:
    study = made(STUDY)
    before = draws.before(study)
    assert before is not None
    found, even = draws.sample(study, 4000, (3, 2), ends)
    old, old_even = draws.sample(before, 4000, (3, 2), ends)
    assert int(even.sum()) == 4000
    assert even.size == 4000 * (1 + ends)
    # as many as the volume of the box of before is, in whole places
    share = 0.75 * np.log(3) / np.log(4)
    taken = int(share * 400) * 10 * (1 + ends)
    for name, values in found.items():
        np.testing.assert_array_equal(values[:taken], old[name][:taken])
        axis = study.factors[name]
        size = np.log if axis.scale == "log" else np.asarray
        low, high = float(size(axis.low)), float(size(axis.high))
        u = (size(values.values[even > 0]) - low) / (high - low)
        # places of ten are as good as 400 independent cases, whose distance is beyond 0.081 once in a hundred
        assert kstest(u, "uniform").statistic < 0.081
    np.testing.assert_array_equal(even[:taken], old_even[:taken])
    beyond = (np.abs(found["volume_fraction"][taken:] - 0.5) > 0.3) | (found["radius"][taken:] > 0.09)
    assert beyond[even[taken:] > 0].all()


def test_a_range_of_before_must_lie_in_that_of_now() -> None:
    told = refusal(STUDY.replace("[0.2, 0.8]", "[0.2, 0.95]"))
    assert "grown_from: 0.2 to 0.95 must ascend and lie in 0.1 to 0.9" in told
    same = made(STUDY.replace("[0.2, 0.8]", "[0.1, 0.9]").replace("[0.03, 0.09]", "null"))
    assert draws.before(same) is None
