"""Numbers of a study: in every section a bare one is in SI, and a text has its unit."""

from pathlib import Path

import pytest
import yaml

from tests.studies import made, refusal

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


@pytest.mark.parametrize(
    ("entries", "told"),
    [
        ({"low": "20 V"}, "factors: radius: low: '20 V': unit mismatch: 'V' does not measure what 'm' measures"),
        ({"low": "20e mm"}, "radius: low: '20e mm' is not a finite number [m], nor one with its unit"),
        ({"share": "half"}, "fixed: volume_fraction: 'half' is not a finite number [1]"),
        ({"off": "1 V"}, "tolerance: radius: unit mismatch: '1 V' for a number in m"),
    ],
)
def test_a_text_that_is_no_number_of_the_factor_is_refused(entries: dict[str, str], told: str) -> None:
    assert told in refusal(STUDY.format(**(BARE | entries)))


def test_the_template_of_a_study_reads_with_the_unit_that_it_promises() -> None:
    text = Path("workflow/cli/study.yaml").read_text(encoding="utf-8")
    assert "`high: 20 mm`" in text
    content = yaml.safe_load(text)
    content["factors"]["radius"] |= {"low": "10 mm", "high": "20 mm"}
    content["design"]["sensor"]["over"] = ["volume_fraction"]
    content["design"]["sensor"]["at"] = {"load": 1e4, "radius": "15 mm"}
    assert made(yaml.safe_dump(content)).factors["radius"].high == 0.02
