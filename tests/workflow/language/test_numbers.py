"""Numbers for people: short, with a prefix, the same in Python and in the page's script."""

import json
from pathlib import Path

import numpy as np
import pytest

from solver.units import prefixed
from tests.workflow.report.browser import in_node, needs_node
from workflow.language.numbers import label, number, shown
from workflow.report.page import TEMPLATES


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [(5e4, 4, "50000"), (260.4, 2, "260"), (-31960.0, 4, "\N{MINUS SIGN}31960"), (3e5, 4, "3×10⁵"), (0.0, 3, "0"),
     (99999.6, 5, "1×10⁵"), (9.9999e-4, 2, "0.001"), (-1.5e-7, 2, "\N{MINUS SIGN}1.5×10⁻⁷"), (2.5, 1, "3"),
     (float("nan"), 4, "–"), (None, 4, "–")],
)  # fmt: skip
def test_a_number_is_short_and_never_in_the_notation_of_programs(
    value: float | None, digits: int, expected: str
) -> None:
    assert number(value, digits) == expected


@pytest.mark.parametrize(
    ("value", "units", "digits", "expected"),
    [(260.4, "Pa", 2, "260 Pa"), (4.1e-10, "m", 2, "410 pm"), (999.96, "Pa", 4, "1 kPa"),
     (5e4, "N m-1", 4, "50 kN/m"),
     (0.0493, "V m N-1", 4, "49.3 mV·m/N"), (0.67, "1", 4, "0.67"), (2e-3, "kg m-3", 4, "0.002 kg/m³"),
     (3e-9, "m2 s-1", 2, "3×10⁻⁹ m²/s")],
)  # fmt: skip
def test_a_value_has_a_prefix_where_its_unit_takes_one(value: float, units: str, digits: int, expected: str) -> None:
    assert shown(value, units, digits) == expected


def test_a_label_is_wrapped_and_never_cut() -> None:
    text = "worst-case abs(stroke_per_volt) * 3e5 * (contact_trailing + contact_leading)"
    lines = label(text, "m²/V", 34).splitlines()
    assert " ".join(lines).replace("\N{NO-BREAK SPACE}", " ") == f"{text} [m²/V]"
    assert max(map(len, lines)) <= 34


@needs_node
def test_the_page_writes_numbers_as_python_does(tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    values = [0.0, 2.5, 0.25, 1.25, 999.96, 99999.6, 1e5, 1e-3, 5e4, *(10.0 ** np.arange(-15, 13)).tolist()]
    values += (random.choice([-1, 1], 300) * 10 ** random.uniform(-17, 14, 300)).tolist()
    units = ["Pa", "V m N-1", "1", "m2 s-1", "T m1/2", "kg m-3", "N m-1 V-1", "s-1", "C m-3/2", "%"]
    cases = [[value, units[k % len(units)], 1 + k % 6] for k, value in enumerate(values)]
    expected = [[number(v, d), shown(v, u, d), *prefixed(v, u)] for v, u, d in cases]
    script = (TEMPLATES / "numbers.js").read_text(encoding="utf-8")
    written = "cases.map(([v, u, d]) => [digits(v, d), said(v, u, d), engineering(v, u).size, engineering(v, u).units])"
    script += f"const cases = {json.dumps(cases)};"
    assert in_node(script, written, tmp_path) == expected
