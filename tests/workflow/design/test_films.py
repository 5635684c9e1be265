"""A design question about films: exact cases are costly, and few are asked for; the verdict is the exact solver's."""

import numpy as np
import pytest

import solver
from approximation.arrays import Array
from solver import solve
from tests.studies import fitted, made
from workflow.design.question import costly, sources
from workflow.design.search import targets
from workflow.design.wording import words

FILM = """\
title: A film
fixed: {surroundings: insulated, composite: fibrous, radius: 0.05, load: 3e4}
categories: {base: [rigid, steel]}
factors:
  friction: {low: 0.0, high: 0.2, levels: 3}
  volume_fraction: {low: 0.5, high: 0.6, levels: 3}
  thickness: {low: 2e-4, high: 3e-4, levels: 5, scale: log}
surrogate: {outputs: [voltage, voltage_per_load, trailing_tension]}
validation: {cases: 40, calibration: 60, tolerance: 1e-3}
design:
  thick:
    maximise: abs(voltage_per_load)
    over: [thickness, base]
    at: {volume_fraction: 0.55}
    worst_case: {friction: [0.05, 0.15]}
    subject_to: [nominal_field <= 0.8 kV/mm]
"""


def test_a_thickness_is_found_with_few_exact_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    study = made(FILM)
    model = fitted(study, calibrated=True)
    counts: list[int] = []
    exact = sources.Exact.values

    def counted(self: sources.Exact, factors: sources.Factors, names: list[str]) -> dict[str, Array]:
        counts.append(int(np.prod(sources.shape(factors))))
        return exact(self, factors, names)

    monkeypatch.setattr(sources.Exact, "values", counted)
    answer = targets.solve_target(study, "thick", model)
    # the verdict of a half-plane would solve 201 scenarios at once, and every step of the polish some more
    assert max(counts) <= 14  # loads up to the first limit, of one table
    assert sum(counts) <= costly.AFFORDABLE_FILMS
    assert "led by the surrogate" in answer.polish
    assert answer.feasible
    design = {name: answer.variable(name).value for name in study.factors}
    base = answer.combination["base"]
    goal, field = answer.terms
    for term, limit in ((goal, False), (field, True)):
        case = design | {"friction": term.worst["friction"], "base": base} | study.fixed
        solved = solver.solve(case)
        value = solved["nominal_field"] if limit else abs(solved["voltage_per_load"])
        assert term.exact == pytest.approx(float(value), rel=1e-6)
    assert field.exact <= 8e5 * (1 + 1e-9)


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
