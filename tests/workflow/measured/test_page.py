"""The documents, the figure and netCDF hold the rows of the study of measurements."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from docs import measurements
from storage.netcdf import read_whole, write_whole
from workflow.measured.comparison import Row, compared, dataset
from workflow.report import sentences
from workflow.report.figures import measured_rows
from workflow.study.reading import InputError
from workflow.study.sections import Measurement


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return measurements.rows()


def test_the_page_and_the_file_have_the_numbers_of_the_run(rows: list[Row], tmp_path: Path) -> None:
    text = measurements.PAGE.read_text(encoding="utf-8")
    assert measurements.table(rows) in text
    assert measurements.written(text, rows) == text
    assert all(row["because"] and row["source"] and row["decides"] for row in rows)
    write_whole(dataset(rows), tmp_path / "measurements.nc")
    data = read_whole(tmp_path / "measurements.nc")
    assert float(data["measured"][0]) == pytest.approx(13e-12)
    off = (data["model"] - data["measured"]) / np.hypot(data["measured_std"], data["model_std"])
    np.testing.assert_allclose(off, data["deviations"], atol=1e-9)
    (ax,) = measured_rows.figure(rows).axes
    assert [text.get_text() for text in ax.texts] == [row["verdict"] for row in rows]


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
    row = Measurement.model_validate(
        {"of": "x", "value": 1.0, "unit": "pC/N", "source": "x", "decides": "x", "model": [
            {"quantity": "charge_per_force", "case": case}]}
    )  # fmt: skip
    with pytest.raises(InputError, match=re.compile(f"^measurements: mine: {expected}$")):
        compared({"mine": row})
