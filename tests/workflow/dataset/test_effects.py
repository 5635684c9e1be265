"""Effects of one factor at a time, and those about one baseline together."""

import numpy as np

import solver
from tests.studies import made
from workflow.dataset import effects

SWEEPS = """\
title: Sweeps
effects:
  baseline: {composite: fibrous, volume_fraction: 0.5, radius: 0.05, load: 3e4, friction: 0.3}
  vary: {friction: [0.0, 0.3, 0.6], load: [1e4, 3e4], speed: [0.0, 500.0], composite: [fibrous, laminate]}
  positions: {inside: 5, outside: 4}
"""


def test_effects_about_one_baseline_stand_together() -> None:
    study = made(SWEEPS)
    assert study.effects is not None
    assert study.effects.of_baseline == ["friction", "load", "composite"]  # the baseline states no speed
    single = {name: effects.effect(study, name) for name in study.effects.of_baseline}
    together = effects.together(single)
    assert dict(together.sizes) == {"case": 7, "position": single["load"].sizes["position"]}
    assert set(together.coords) == {*study.effects.baseline, "varied", "position"}
    for name, alone in single.items():
        cases = np.flatnonzero(together["varied"] == name)
        np.testing.assert_array_equal(together[name][cases], alone[name])
        np.testing.assert_array_equal(together["stress_xx"][cases], alone["stress_xx"])
    rows = {name: together[name].values.tolist() for name in study.effects.baseline}
    again = solver.solve([dict(zip(rows, row, strict=True)) for row in zip(*rows.values(), strict=True)])
    np.testing.assert_allclose(again["voltage"], together["voltage"], rtol=1e-12)
