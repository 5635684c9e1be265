"""The rule of the verdict, and rows that are refused."""

from pathlib import Path
from typing import Any

import pytest

from tests.studies import edited, refusal
from workflow.measured.comparison import AGREES_WITHIN, judged
from workflow.measured.values import Spread
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


def test_deviations_hold_the_error_and_the_spread_together() -> None:
    verdict = judged(row(), [spread(20.0, 4.0)])
    assert verdict.deviations == pytest.approx((2.0,))  # 10 over the root of 9 and 16


@pytest.mark.parametrize(
    ("off", "word"), [(1.99, "agrees"), (-1.99, "agrees"), (2.01, "disagrees"), (-2.01, "disagrees")]
)
def test_two_standard_deviations_decide(off: float, word: str) -> None:
    assert AGREES_WITHIN == 2
    assert judged(row(), [spread(10 + 3 * off)]).word == word


def test_a_spread_of_constants_can_make_a_row_agree_which_its_own_value_does_not() -> None:
    assert judged(row(), [spread(20.0)]).word == "disagrees"
    assert judged(row(), [spread(20.0, 8.0)]).word == "agrees"


def test_a_row_says_which_rules_it_rules_out() -> None:
    rival = [D33, {"quantity": "clamped_d33", "case": {"material": "PZT-4"}}]
    verdict = judged(row(rivals=rival), [spread(10.0)], [spread(30.0), spread(12.0)])
    assert verdict.because.endswith("; free d33 does not fit; clamped d33 fits too")


def test_without_an_error_only_what_is_the_same_agrees() -> None:
    assert judged(row(error=None), [spread(10.0)]).word == "agrees"
    verdict = judged(row(error=None), [spread(11.0)])
    assert (verdict.word, verdict.deviations) == ("cannot be told", (None,))
    assert "10 % off" in verdict.because
    assert judged(row(error=None, outside="domains turn"), [spread(11.0)]).word == "disagrees"


def test_an_open_row_cannot_be_told_however_near_the_numbers_are() -> None:
    verdict = judged(row(open="nobody says how"), [spread(10.0)])
    assert (verdict.word, verdict.because) == ("cannot be told", "nobody says how")
    assert judged(row(open="no constants", model=[]), []).deviations == ()


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
        ("force: 1.0e-4}", "farce: 1.0e-4}", "measurements.lithium_niobate_tip.model.0.case.farce: "),
        (MODEL, "    model: []", "measurements.lithium_niobate_tip: model: 0 values; must be one"),
    ],
)
def test_a_bad_row_is_refused_in_one_line(old: str, new: str, expected: str) -> None:
    text = Path("config/measured.yaml").read_text(encoding="utf-8")
    assert refusal(edited(text, old, new)).startswith(expected)
