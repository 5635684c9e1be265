"""The best thickness of a film: a composite's lies where the contact is about as wide as the film is thick."""

import numpy as np
import pytest

from solver import solve
from tests.studies import fitted, made
from workflow.design.search import targets
from workflow.design.wording import words

STUDY = """\
title: A film, thin to thick
fixed:
  {{surroundings: insulated,
    composite: fibrous, volume_fraction: {fraction}, base: rigid, friction: 0.2, radius: 0.05, load: 1e4, charge: 0.0}}
factors:
  thickness: {{low: 2e-5, high: 1e-3, levels: 16, scale: log}}
surrogate: {{outputs: [charge_per_force, capacitance_per_length, trailing_tension]}}
validation: {{cases: 20, calibration: 40, tolerance: 1e-2}}
device:
  electrode_length: 10 mm
  amplifier: {{input_capacitance: 10 pF, input_resistance: 1 TOhm, cable_capacitance: 100 pF, charge_noise: 1 fC}}
design:
  charge: {{maximise: abs(charge_per_force), over: [thickness]}}
  voltage: {{maximise: abs(signal_voltage), over: [thickness], subject_to: [time_constant >= 100 s]}}
"""
DENSE = np.geomspace(2e-5, 1e-3, 241)


@pytest.mark.soak  # test_films.py searches a film, too
@pytest.mark.parametrize(("fraction", "interior"), [(0.5, True), (1.0, False)])  # of BaTiO3
def test_the_optimum_in_thickness_comes_out_by_itself(fraction: float, interior: bool) -> None:
    study = made(STUDY.format(fraction=fraction))
    model = fitted(study)
    exact = solve({**study.fixed, "thickness": DENSE})
    answer = targets.solve_target(study, "charge", model)
    best = float(abs(exact["charge_per_force"]).max())
    assert answer.terms[0].exact >= best * (1 - 1e-3)
    thickness = answer.variable("thickness").value
    assert (2.1e-5 < thickness < 0.95e-3) == interior
    assert (words.AT_EDGE in words.verdict(answer).kind) != interior

    voltage = targets.solve_target(study, "voltage", model)
    circuit = exact["capacitance_per_length"] * 0.01 + 110e-12
    signal = abs(exact["charge_per_force"] * 1e4 * 0.01 / circuit).where(circuit * 1e12 >= 100)
    assert voltage.terms[0].exact >= float(signal.max()) * (1 - 1e-3)
    figures = {figure.figure: figure.figure_low for figure in voltage.figures}
    assert figures["force"] == pytest.approx(100.0)
    assert abs(figures["signal_voltage"]) == pytest.approx(voltage.terms[0].exact, rel=1e-9)
    noise = figures["smallest_force"] * abs(figures["signal_charge"]) / figures["force"]
    heat = 1.380649e-23 * 293.15 * abs(figures["signal_charge"] / figures["signal_voltage"])
    assert noise == pytest.approx(np.sqrt(1e-30 + heat), rel=1e-6, abs=0)
    assert "time constant" in words.verdict(voltage).device
