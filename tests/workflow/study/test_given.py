"""Numbers of a study: in every section a bare one is in SI, and a text has its unit."""

from pathlib import Path

import yaml

from tests.studies import edited, made
from workflow.study.model import remade, thawed

STUDY = """
title: a sensor
phases: [BaTiO3, CoFe2O4]
fixed: {{composite: fibrous, volume_fraction: {share}, friction: 0.2, charge: 0}}
factors:
  radius: {{low: {low}, high: {high}, levels: 3}}
  load: {{low: {load}, high: 2e4, levels: 3}}
effects: {{baseline: {{composite: fibrous, volume_fraction: 0.5, radius: {low}, load: 1e4, friction: 0.1, charge: 0}},
  vary: {{radius: [{low}, {high}]}}}}
design:
  mine: {{maximise: voltage, over: {{radius: {{low: {low}}}}}, worst_case: {{load: [{load}, 2e4]}},
    tolerance: {{radius: {off}}}}}
"""
BARE = {"share": "0.5", "low": "0.02", "high": "0.2", "load": "1e4", "off": "1e-4"}
WITH_UNITS = {"share": "50 %", "low": "20 mm", "high": "20 cm", "load": "10 N/mm", "off": "0.1 mm"}


def test_a_unit_says_what_a_bare_number_of_si_says() -> None:
    bare, other = made(STUDY.format(**BARE)), made(STUDY.format(**WITH_UNITS))
    assert other.physics == bare.physics
    assert other.design["mine"].tolerances == bare.design["mine"].tolerances == {"radius": (1e-4, 0.0)}
    sections = {"fixed", "factors", "effects"}
    assert other.model_dump(include=sections) == bare.model_dump(include=sections)
    assert other.design["mine"].worst_case == {"load": [1e4, 2e4]}
    assert other.design["mine"].variables["radius"].low == 0.02


POINT = """\
title: a ball
fixed: {material: PZT-4, profile: sphere, radius: 0.01, surroundings: insulated}
factors: {force: {low: 1.0, high: 2.0, levels: 3}}
validation: {cases: 20, calibration: 40}
"""


def test_a_box_that_no_material_bears_is_told_before_it_runs() -> None:
    assert not made(POINT).defaults
    heavy = made(edited(edited(POINT, "0.01", "0.001"), "low: 1.0, high: 2.0", "low: 500, high: 900")).defaults
    assert [line.partition(":")[0] for line in heavy] == ["pressure"]
    assert heavy[0].endswith("check force and radius: bare numbers are in SI")


def test_the_template_of_a_study_reads_with_the_unit_that_it_promises() -> None:
    text = Path("workflow/cli/study.yaml").read_text(encoding="utf-8")
    assert "`high: 20 mm`" in text
    content = yaml.safe_load(text)
    content["factors"]["radius"] |= {"low": "10 mm", "high": "20 mm"}
    content["design"]["sensor"]["over"] = ["volume_fraction"]
    content["design"]["sensor"]["at"] = {"load": 1e4, "radius": "15 mm"}
    assert made(yaml.safe_dump(content)).factors["radius"].high == 0.02


def test_a_number_with_its_unit_passes_again_when_a_job_thaws_the_study() -> None:
    study = made(edited(edited(POINT, "0.01", "20 m"), "low: 1.0, high: 2.0", "low: 1 GN, high: 5 GN"))
    assert thawed(study.frozen()).fixed["radius"] == remade(study, title="again").fixed["radius"] == 20.0
