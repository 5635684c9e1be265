"""Numbers for people: short, with a prefix, the same in Python and in the page's script."""

import json
from pathlib import Path

import numpy as np
import pytest

from solver.body import KINDS
from solver.names import ALL_QUANTITIES
from solver.units import prefixed
from tests.workflow.report.browser import in_node, needs_node
from workflow.language import renamed as module
from workflow.language.constants import DEVICE
from workflow.language.numbers import label, number, shown
from workflow.language.renamed import renamed, renamed_study
from workflow.language.spelling import nearest
from workflow.language.wordings import RENAMED
from workflow.report.page import TEMPLATES


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [(5e4, 4, "50000"), (260.4, 2, "260"), (-31960.0, 4, "\N{MINUS SIGN}31960"), (3e5, 4, "3×10⁵"), (0.0, 3, "0"),
     (99999.6, 5, "1×10⁵"), (9.9999e-4, 2, "0.001"), (-1.5e-7, 2, "\N{MINUS SIGN}1.5×10⁻⁷"), (2.5, 1, "3"),
     (float("nan"), 4, "–"), (None, 4, "–")],
)  # fmt: skip
def test_a_number_is_short_and_never_as_programs_write_it(value: float | None, digits: int, expected: str) -> None:
    assert number(value, digits) == expected


@pytest.mark.parametrize(
    ("value", "units", "digits", "expected"),
    [(260.4, "Pa", 2, "260 Pa"), (4.1e-10, "m", 2, "410 pm"), (999.96, "Pa", 4, "1 kPa"),
     (5e4, "N m-1", 4, "50 kN/m"),
     (0.0493, "V m N-1", 4, "49.3 mV·m/N"), (0.67, "1", 4, "0.67"), (2e-3, "kg m-3", 4, "0.002 kg/m³"),
     (3e-9, "m2 s-1", 2, "3000 µm²/s"), (3e-7, "m2", 2, "0.3 mm²"), (2.3e-9, "m2", 2, "2300 µm²"),
     (5.0, "m2", 2, "5 m²"), (np.pi / 4, "rad", 3, "45 deg"), (1e-4, "rad", 3, "100 µrad")],
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
    units = ["Pa", "V m N-1", "1", "m2 s-1", "m2", "T m1/2", "kg m-3", "N m-1 V-1", "s-1", "C m-3/2", "%", "rad"]
    cases = [[value, units[k % len(units)], 1 + k % 6] for k, value in enumerate(values)]
    expected = [[number(v, d), shown(v, u, d), *prefixed(v, u)] for v, u, d in cases]
    script = (TEMPLATES / "numbers.js").read_text(encoding="utf-8")
    written = "cases.map(([v, u, d]) => [digits(v, d), said(v, u, d), engineering(v, u).size, engineering(v, u).units])"
    script += f"const cases = {json.dumps(cases)};"
    assert in_node(script, written, tmp_path) == expected


@pytest.fixture(autouse=True)
def _nothing_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_reported", set())


def test_studies_with_old_names_are_read(capsys: pytest.CaptureFixture[str]) -> None:
    line = {"design": {"d": {"maximise": "abs(voltage_sensitivity) / capacitance"}}, "title": "voltage_sensitivity"}
    expected = {"d": {"maximise": "abs(voltage_per_load) / capacitance_per_length"}}
    for _ in range(2):
        assert renamed_study(line) == {"design": expected, "title": "voltage_sensitivity"}
    first, _ = capsys.readouterr().err.splitlines()  # each name once
    assert first == "voltage_sensitivity is now called voltage_per_load; the old name is read until the next release"
    point = {
        "fixed": {"profile": "sphere"},
        "surrogate": {"outputs": ["contact_capacitance", "capacitance", "charge_sensitivity"]},
        "readout": {"r": {"measured": {"charge_sensitivity": "1 %"}}},
    }
    study = renamed_study(point)
    assert study["surrogate"]["outputs"] == ["capacitance", "capacitance", "charge_per_force"]
    assert study["readout"]["r"]["measured"] == {"charge_per_force": "1 %"}
    capsys.readouterr()
    for fixed in ({"fixed": {"profile": "ball"}}, {"fixd": {"profile": "sphere"}, "factors": {"force": {}}}):
        wanted = {"surrogate": {"outputs": ["capacitance"]}, **fixed}
        assert renamed_study(wanted) == wanted  # not a line's capacitance, for a slip that is refused afterwards
    assert not capsys.readouterr().err


def test_columns_and_options_of_a_quantity_follow_its_name() -> None:
    known = ["voltage_per_load", "capacitance_per_length"]
    assert renamed("capacitance_std", known) == "capacitance_per_length_std"
    assert renamed(["capacitance_gain=3%"], known) == ["capacitance_per_length_gain=3%"]
    assert renamed("charge_sensitivity", known) == "charge_sensitivity"  # whose new name is unknown, too


def test_every_old_name_has_a_new_one_and_every_unit_one_name() -> None:
    assert {*RENAMED.values()} <= ALL_QUANTITIES.keys()
    for name in ALL_QUANTITIES:
        units = {kind.every_quantity[name].units for kind in KINDS.values() if name in kind.every_quantity}
        assert len(units) <= 1


def test_a_name_that_is_half_written_or_old_leads_to_the_present_one() -> None:
    known = [*ALL_QUANTITIES, *DEVICE]
    for name, present in (("voltage_sens", "voltage_per_load"), ("contact_capacitance", "capacitance"),
                          ("feedback_resistence", "feedback_resistance")):  # fmt: skip
        assert f"did you mean {present!r}?" in nearest(name, known)
    assert "did you mean 'voltage_per_force'?" in nearest(
        "voltage_sens", [*KINDS["point", True, True].every_quantity, *DEVICE]
    )
