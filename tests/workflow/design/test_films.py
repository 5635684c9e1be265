"""A design question about films: exact cases are costly, and few are asked for; the verdict is the exact solver's."""

import numpy as np
import pytest

import solver
from approximation.arrays import Array
from tests.studies import fitted, made
from workflow.design.question import costly, sources
from workflow.design.search import targets

FILM = """\
title: A film
fixed: {surroundings: insulated, composite: fibrous, volume_fraction: 0.55, radius: 0.05, load: 3e4}
categories: {base: [rigid, steel]}
factors:
  friction: {low: 0.0, high: 0.2, levels: 3}
  thickness: {low: 2e-4, high: 3e-4, levels: 5, scale: log}
surrogate: {outputs: [voltage, voltage_per_load, trailing_tension]}
validation: {cases: 20, calibration: 40, tolerance: 1e-3}
design:
  thick:
    maximise: abs(voltage_per_load)
    over: [thickness, base]
    worst_case: {friction: [0.05, 0.15]}
    subject_to: [nominal_field <= 0.8 kV/mm]
"""


def test_a_thickness_is_found_with_few_exact_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    study = made(FILM)
    model = fitted(study)
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
