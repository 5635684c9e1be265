"""The rule of the verdict, and rows that are refused."""

from pathlib import Path
from typing import Any

import pytest

from tests.studies import edited, refusal
from workflow.measured.comparison import AGREES_WITHIN, Spread, judged
from workflow.study.sections import Measurement

D33 = {"quantity": "free_d33", "case": {"material": "PZT-4"}}
ROW: dict[str, Any] = {
    "of": "a thing", "value": 10.0, "error": 3.0, "unit": "pC/N", "model": [D33], "source": "paper", "decides": "more",
}  # fmt: skip


CASE = "{material: LiNbO3, profile: sphere, radius: 1.0e-6, force: 1.0e-4}"
MODEL = f"    model: [{{quantity: charge_per_force, case: {CASE}}}]"


def row(**changed: Any) -> Measurement:
    return Measurement.model_validate(ROW | changed)


def spread(value: float, deviation: float = 0.0) -> Spread:
    return Spread(value * 1e-12, deviation * 1e-12, 1)


@pytest.mark.parametrize(
    ("changed", "modelled", "word"),
    [
        ({}, spread(10 + 3 * 1.99), "agrees"),
        ({}, spread(10 - 3 * 1.99), "agrees"),
        ({}, spread(10 + 3 * 2.01), "disagrees"),
        ({}, spread(10 - 3 * 2.01), "disagrees"),
        ({}, spread(20.0, 8.0), "agrees"),  # by the spread of constants
        ({"error": None}, spread(10.0), "agrees"),
        ({"error": None}, spread(11.0), "cannot be told"),
        ({"error": None, "outside": "domains turn"}, spread(11.0), "disagrees"),
        ({"open": "nobody says how"}, spread(10.0), "cannot be told"),
    ],
)
def test_two_standard_deviations_decide(changed: dict[str, Any], modelled: Spread, word: str) -> None:
    assert judged(row(**changed), [modelled]).word == word


def test_a_verdict_has_its_deviations_and_its_reason() -> None:
    assert AGREES_WITHIN == 2
    assert judged(row(), [spread(20.0, 4.0)]).deviations == pytest.approx((2.0,))  # 10 over the root of 9 and 16
    assert "10 % off" in judged(row(error=None), [spread(11.0)]).because
    assert judged(row(open="no constants", model=[]), []).deviations == ()
    rival = [D33, {"quantity": "clamped_d33", "case": {"material": "PZT-4"}}]
    verdict = judged(row(rivals=rival), [spread(10.0)], [spread(30.0), spread(12.0)])
    assert verdict.because.endswith("; free d33 does not fit; clamped d33 fits too")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "value: 13.0",
            "value: -13.0",
            "measurements.lithium_niobate_tip.value: -13.0: input should be greater than 0",
        ),
        ("value: 13.0", "value: .nan", "measurements.lithium_niobate_tip.value: nan: "),
        ("error: 2.0", "error: 0.0", "measurements.lithium_niobate_tip.error: 0.0: input should be greater than 0"),
        ("unit: pC/N", "unit: nC/N", "measurements.lithium_niobate_tip.unit: 'nC/N': "),
        ("unit: pC/N", "units: pC/N", "measurements.lithium_niobate_tip.units: unknown key"),
        ("quantity: charge_per_force", "quantity: charge", "measurements.lithium_niobate_tip.model.0.quantity: "),
        ("{material: LiNbO3, profile", "{material: LiNbO, profile", "measurements.lithium_niobate_tip.model.0: "),
        ("{material: LiNbO3, profile", "{profile", "measurements.lithium_niobate_tip.model.0: case: material: missing"),
        (
            ", scandium_fraction: 0.1}",
            "}",
            "measurements.scandium_nitride_diffraction.model.0: case: scandium_fraction: mi",
        ),
        (
            "composite: AlScN, scandium_fraction: 0.1",
            "composite: fibrous, volume_fraction: 0.5",
            "measurements.scandium_nitride_diffraction.model.0: case: composite: 'fibrous' is not one of AlScN",
        ),
        (
            "collector: 2, patch_size: 1.0e-5",
            "collector: 2",
            "measurements.aluminium_nitride_full_electrode.rivals.2: case: patch_size: missing",
        ),
        ("force: 1.0e-4}", "farce: 1.0e-4}", "measurements.lithium_niobate_tip.model.0.case.farce: "),
        (MODEL, "    model: []", "measurements.lithium_niobate_tip: model: 0 values; must be one"),
    ],
)
def test_a_bad_row_is_refused_in_one_line(old: str, new: str, expected: str) -> None:
    text = Path("config/measured.yaml").read_text(encoding="utf-8")
    assert refusal(edited(text, old, new)).startswith(expected)
