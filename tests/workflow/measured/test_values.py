"""Every value of the model against closed formulas and published digits, with constants that stand here."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from docs import measurements
from storage.netcdf import read_whole, write_whole
from workflow.measured import comparison
from workflow.measured.comparison import Row, Spread, compared, dataset, judged, modelled, valued
from workflow.report import sentences
from workflow.report.figures import measured_rows
from workflow.study.reading import InputError
from workflow.study.sections import Measurement, ModelQuantity, ModelValue

TIP: dict[str, Any] = {"profile": "sphere", "radius": 1e-6, "force": 1e-4}
ELASTIC: dict[str, Any] = {"electric": "insulating", "magnetic": "insulating", "base": "rigid"}


def value(quantity: ModelQuantity, **case: Any) -> float:
    return modelled(ModelValue(quantity=quantity, case=case)).value


def test_every_quantity_of_a_row_has_an_answer() -> None:
    assert set(comparison._ANSWERS) == set(get_args(ModelQuantity))


PAD: dict[str, Any] = {
    "material": "AlN", "thickness": 1e-6, "electrode": "top", "collector": 2, "profile": "sphere", "radius": 1e-5,
    "force": 1e-6, "electric": "insulating", "magnetic": "insulating",
}  # fmt: skip
FILM: dict[str, Any] = {"material": "polyimide", "profile": "sphere", "radius": 1.0, "thickness": 1e-3, **ELASTIC}
DISC: dict[str, Any] = {"material": "steel", "profile": "disc", "force": 1.0, "thickness": 1e-3, **ELASTIC}


@pytest.mark.parametrize(
    ("quantity", "case", "expected", "room"),
    [
        ("charge_per_force", {"material": "PZT-4", **TIP}, 250.1001e-12, 2.5e-16),  # theory of points
        ("charge_per_force", {"material": "BaTiO3", **TIP}, 168.2812e-12, 1.7e-16),
        ("clamped_d33", {"material": "LiNbO3"}, 5.3e-12, 1e-13),
        # LiNbO3 from d33 = 6 pC/N, of which its e were made; the others by Voigt's matrices (materials, 2)
        ("free_d33", {"material": "LiNbO3 (alternative 1)"}, 6.0e-12, 5e-14),
        ("free_d33", {"material": "PZT-4"}, 291.3e-12, 5e-14),
        ("free_d33", {"material": "PZT-5H"}, 594.2e-12, 5e-14),
        ("pad_stroke_per_volt", {**PAD, "base": "rigid", "patch_size": 1e-4}, 1.55 / 389e9, 4e-18),  # e33/c33
        ("indentation_exponent", {"material": "PZT-4", **TIP}, 1.5, 1e-12),
        ("indentation_exponent", {**FILM, "force": 1e7}, 2.0, 1e-3),  # wide against the film
        ("indentation_exponent", {**FILM, "force": 1.0, "thickness": "1 m"}, 1.5, 1e-3),
        # linear theory knows no dependence on load or charge
        ("response_under_load", {"material": "PZT-4", **TIP}, 1.0, 1e-12),
        ("stiffness_under_charge", {"material": "PMN-PT 67:33", **TIP}, 1.0, 1e-9),
        ("layer_factor", {**DISC, "width": 2e-3}, 2.48352, 6e-6),  # a layer of Hayes, whose others verification has
    ],
)
def test_values_of_theory(quantity: ModelQuantity, case: dict[str, Any], expected: float, room: float) -> None:
    assert value(quantity, **case) == pytest.approx(expected, rel=0, abs=room)


def test_other_published_constants_spread_a_value() -> None:
    """13.517 and 13.444: the eigenvalue problem of `verification.oracles.surface` gives both."""
    niobate = modelled(ModelValue(quantity="charge_per_force", case={"material": "LiNbO3", **TIP}))
    assert [1e12 * niobate.value, 1e12 * niobate.deviation] == pytest.approx([13.444, 13.517 - 13.444], abs=1e-3)
    assert niobate.sets == 1
    nitride = modelled(ModelValue(quantity="clamped_d33", case={"material": "AlN"}))
    assert 1e12 * nitride.value == pytest.approx(1550 / 389, rel=1e-12)
    assert 1e12 * nitride.deviation == pytest.approx(1550 / 389 - 1460 / 385, rel=1e-9)


def test_alloys_by_their_composition() -> None:
    """d33 by the inverse of the stiffness matrix, of constants written out by hand at a tenth of scandium."""
    c11, c12, c13, c33 = 379.783, 142.449, 119.741, 334.994
    stiffness = np.array([[c11, c12, c13], [c12, c11, c13], [c13, c13, c33]])
    d33 = (np.array([-0.67155, -0.67155, 1.60122]) @ np.linalg.inv(stiffness))[2] * 1e3
    assert 1e12 * value("free_d33", composite="AlScN", scandium_fraction=0.1) == pytest.approx(d33, abs=1e-3)


def test_the_front_of_a_pad_on_silicon_changes_its_sign_at_a_pad_of_0_14_mm() -> None:
    narrow, wide = (value("pad_stroke_per_volt", **PAD, base="silicon", patch_size=size) for size in (1.3e-4, 1.5e-4))
    assert narrow > 0 > wide


D33 = {"quantity": "free_d33", "case": {"material": "PZT-4"}}
ROW: dict[str, Any] = {
    "of": "a thing", "value": 10.0, "error": 3.0, "unit": "pC/N", "model": [D33], "source": "paper", "decides": "more",
}  # fmt: skip


def row(**changed: Any) -> Measurement:
    return Measurement.model_validate(ROW | changed)


def spread(value: float, deviation: float = 0.0) -> Spread:
    return Spread(value * 1e-12, deviation * 1e-12, 1)


def told(measured: Measurement, model: list[Spread], rivals: Sequence[Spread] = ()) -> tuple[str, str]:
    """The verdict on a row by values of the model and of rivals."""
    pairs = (zip(measured.model, model, strict=True), zip(measured.rivals, rivals, strict=True))
    parts = [[valued(measured, entry, value) for entry, value in part] for part in pairs]
    return judged(measured, *parts)


@pytest.mark.parametrize(
    ("changed", "modelled", "word"),
    [
        ({}, spread(10 + 3 * 1.99), "agrees"),
        ({}, spread(10 - 3 * 2.01), "disagrees"),
        ({}, spread(20.0, 8.0), "agrees"),  # by the spread of constants
        ({"error": None}, spread(10.0), "agrees"),
        ({"error": None}, spread(11.0), "cannot be told"),
        ({"error": None, "outside": "domains turn"}, spread(11.0), "disagrees"),
        ({"open": "nobody says how"}, spread(10.0), "cannot be told"),
        ({"value": None}, spread(10.0), "predicted"),
    ],
)
def test_two_standard_deviations_decide(changed: dict[str, Any], modelled: Spread, word: str) -> None:
    assert told(row(**changed), [modelled])[0] == word


def test_a_verdict_has_its_deviations_and_its_reason() -> None:
    measured = row()
    # 10 over the root of 9 and 16
    assert valued(measured, measured.model[0], spread(20.0, 4.0))["off"] == pytest.approx(2.0)
    assert "10 % off" in told(row(error=None), [spread(11.0)])[1]
    assert judged(row(open="no constants", model=[]), []) == ("cannot be told", "no constants")
    rival = [D33, {"quantity": "clamped_d33", "case": {"material": "PZT-4"}}]
    because = told(row(rivals=rival), [spread(10.0)], [spread(30.0), spread(12.0)])[1]
    assert because.endswith("; free d33 does not fit; clamped d33 fits too")


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return measurements.rows()


def test_the_page_and_the_file_have_the_numbers_of_the_run(rows: list[Row], tmp_path: Path) -> None:
    text = measurements.PAGE.read_text(encoding="utf-8")
    assert measurements.table(rows) in text
    assert all(row["because"] and row["source"] and row["decides"] for row in rows)
    write_whole(dataset(rows), tmp_path / "measurements.nc")
    data = read_whole(tmp_path / "measurements.nc")
    assert float(data["measured"][0]) == pytest.approx(13e-12)
    off = (data["model"] - data["measured"]) / np.hypot(data["measured_std"], data["model_std"])
    np.testing.assert_allclose(off, data["deviations"], atol=1e-9)
    (ax,) = measured_rows.figure(rows).axes
    assert [text.get_text() for text in ax.texts] == [row["verdict"] for row in rows if row["value"]]
    (quartz,) = (row for row in rows if row["verdict"] == "predicted")
    assert quartz["model"][0]["value"] == pytest.approx(0.7331, rel=2e-3)  # of the oracle without grid, docs/space.md


def test_the_readme_begins_with_rows_of_the_run(rows: list[Row]) -> None:
    text = (measurements.ROOT / "README.md").read_text(encoding="utf-8")
    first = text.split("## How far to trust it")[1].split("\n| all quantities")[0]
    assert sentences.measurements(rows).removesuffix(".") in first
    tip, film = rows[0], rows[1]
    assert f"13 ± 2 pC/N measured, {tip['model'][0]['value']:.1f} by the model" in first
    assert f"4.0 ± 0.1 pm/V measured, {film['model'][0]['value']:.1f} by the model" in first


@pytest.mark.parametrize(
    ("changed", "expected"),
    [({"radius": -1.0}, r"radius: -1 [^\n]*"), ({"electric": "insulating"}, r"model: charge_per_force: not a [^\n]*")],
)
def test_a_case_that_the_solver_refuses_names_its_row(changed: dict[str, Any], expected: str) -> None:
    case = {"material": "PZT-4", "profile": "sphere", "radius": 1.0, "force": 1.0, **changed}
    with pytest.raises(InputError, match=f"^measurements: mine: {expected}$"):
        compared({"mine": row(model=[{"quantity": "charge_per_force", "case": case}])})
