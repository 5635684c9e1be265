"""Random cases are even over the box, and of groups as many again lie towards its ends."""

import numpy as np
import pytest
from scipy.stats import kstest

from tests.studies import made, shipped
from workflow.dataset import draws, factorial

STUDY = """\
title: A film
fixed: {composite: fibrous, friction: 0.2, base: rigid, interface_electric: grounded, interface_magnetic: grounded,
        charge: 0.0, magnetic_charge: 0.0}
factors:
  volume_fraction: {low: 0.1, high: 0.9}
  thickness: {low: 2e-4, high: 4e-3, scale: log}
  radius: {low: 0.03, high: 0.12, scale: log}
  load: {low: 2e3, high: 1e4, scale: log}
groups:
  volume_fraction: {levels: 6, scale: logit}
  load * radius / thickness^2: {levels: 9, scale: log}
"""


@pytest.mark.parametrize("ends", [False, True])
def test_cases_are_even_and_as_many_again_lie_towards_the_ends(ends: bool) -> None:
    study = made(STUDY)
    cases, even = draws.sample(study, 4000, (3, 2), ends)
    assert (int(even.sum()), even.size) == (4000, 4000 * (1 + ends))
    for name, values in cases.items():
        axis = study.factors[name]
        size = np.log if axis.scale == "log" else np.asarray
        low, high = float(size(axis.low)), float(size(axis.high))
        shares = (size(values.values) - low) / (high - low)
        # places of ten are as good as 400 independent cases, whose distance is beyond 0.081 once in a hundred
        assert kstest(shares[even > 0], "uniform").statistic < 0.081
        if ends and name not in study.tabled:
            assert (np.abs(shares[even == 0] - 0.5) > 0.4).mean() > 0.4


def test_samples_are_in_the_box_and_follow_the_seed() -> None:
    study = shipped("quickstart")
    first, again, other = (factorial.sample(study, 400, seed) for seed in ((1, 0), (1, 0), (1, 1)))
    assert first.equals(again)
    assert not first.equals(other)
    for name, axis in study.factors.items():
        values = first[name].values
        assert axis.low <= values.min() <= values.max() <= axis.high
        middle = np.sqrt(axis.low * axis.high) if axis.scale == "log" else (axis.low + axis.high) / 2
        assert abs(np.mean(values < middle) - 0.5) < 0.1  # uniform in the axis's own scale
