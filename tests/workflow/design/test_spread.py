"""Spread of a design from the spread of the materials' constants, against materials that are moved by hand."""

from dataclasses import replace

import numpy as np

from solver import find, solve
from tests.studies import fitted, made
from workflow.design.search import targets
from workflow.design.wording import asides
from workflow.study.uncertainty import FAMILIES, uncertain

STUDY = """\
title: A punch on BaTiO3
fixed: {material: BaTiO3, load: 1e4}
factors:
  friction: {low: 0.1, high: 0.3, levels: 3}
  radius: {low: 0.05, high: 0.1, levels: 5, scale: log}
surrogate: {outputs: [voltage_per_load, trailing_tension]}
validation: {cases: 20, calibration: 100, tolerance: 1e-2}
design:
  sensor:
    maximise: abs(voltage_per_load)
    over: [radius]
    worst_case: {friction: [0.1, 0.3]}
    subject_to: [trailing_tension <= 30 MPa, trailing_tension <= 90 MPa with probability 0.9]
    tolerance: {radius: 1 %}
"""


def test_the_spread_of_a_design_is_that_of_materials_moved_by_hand() -> None:
    study = made(STUDY)
    answer = targets.solve_target(study, "sensor", fitted(study))
    constants = uncertain(study)
    assert [constant.constant for constant in answer.constants] == [constant.name for constant in constants]
    material, squares = find("BaTiO3"), np.zeros(2)
    for place, constant in enumerate(constants):
        values = []
        for share in (1.001, 0.999):
            moved = replace(
                material, **{name: getattr(material, name) * share for name in FAMILIES[constant.family]}, name="moved"
            )
            for term in range(2):
                solved = solve(
                    {**answer.terms[term].worst, "load": 1e4, "material": "moved"}, materials={"moved": moved}
                )
                values.append(float(abs(solved["voltage_per_load"]) if term == 0 else solved["trailing_tension"]))
        slopes = np.log(np.array(values[:2]) / values[2:]) / np.log(1.001 / 0.999) * constant.std
        effects = [term.effect[place] for term in answer.terms[:2]]
        np.testing.assert_allclose(effects, slopes, rtol=1e-4, atol=1e-7)
        squares += slopes**2
    np.testing.assert_allclose([term.spread for term in answer.terms[:2]], np.sqrt(squares), rtol=1e-4)
    assert np.isnan(answer.terms[2].spread)  # it counts over draws: no one case says what constants make of it
    goal = f"± {100 * np.sqrt(squares[0]):.2g} %"
    sentence = asides.spread(answer)
    largest = max(abs(effect) for effect in answer.terms[0].effect)
    assert f"changes the goal by {goal} (± {100 * largest:.2g} % by BaTiO3 " in sentence
    assert sentence.count("tension behind the contact by") == 1
    assert ("which may exceed its limit" in sentence) == (abs(answer.terms[1].margin) < 1e-3)


def test_what_has_no_uncertain_constant_has_no_spread() -> None:
    alloy = STUDY.replace("material: BaTiO3", "composite: AlScN, scandium_fraction: 0.3").replace("30 MPa", "300 MPa")
    study = made(alloy)
    answer = targets.solve_target(study, "sensor", fitted(study))
    assert answer.constants == ()
    assert np.isnan(answer.terms[0].spread)
    assert asides.spread(answer) == ""
