"""Old names of quantities are read for one release; each is replaced by its new name and reported once."""

import pytest

from solver.body import KINDS
from solver.names import ALL_QUANTITIES
from workflow.language import renamed as module
from workflow.language.constants import DEVICE
from workflow.language.renamed import renamed, renamed_study
from workflow.language.spelling import nearest
from workflow.language.wordings import RENAMED

LINE = {"design": {"d": {"maximise": "abs(voltage_sensitivity) / capacitance"}}, "title": "voltage_sensitivity"}
POINT = {
    "fixed": {"profile": "sphere"},
    "surrogate": {"outputs": ["contact_capacitance", "capacitance", "charge_sensitivity"]},
    "readout": {"r": {"measured": {"charge_sensitivity": "1 %"}}},
}


@pytest.fixture(autouse=True)
def _nothing_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_reported", set())


def test_a_study_of_lines_reads_old_names(capsys: pytest.CaptureFixture[str]) -> None:
    expected = {"d": {"maximise": "abs(voltage_per_load) / capacitance_per_length"}}
    assert renamed_study(LINE) == {"design": expected, "title": "voltage_sensitivity"}
    assert renamed_study(LINE)["design"] == expected
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2  # once, not twice
    assert lines[0] == "voltage_sensitivity is now called voltage_per_load; the old name is read until the next release"


def test_a_point_has_a_capacitance_and_reads_old_names(capsys: pytest.CaptureFixture[str]) -> None:
    study = renamed_study(POINT)
    assert study["surrogate"]["outputs"] == ["capacitance", "capacitance", "charge_per_force"]
    assert study["readout"]["r"]["measured"] == {"charge_per_force": "1 %"}
    assert len(capsys.readouterr().err.splitlines()) == 2
    for fixed in ({"fixed": {"profile": "ball"}}, {"fixd": {"profile": "sphere"}, "factors": {"force": {}}}):
        wanted = {"surrogate": {"outputs": ["capacitance"]}, **fixed}
        assert renamed_study(wanted) == wanted  # not a line's capacitance, for a slip that is refused afterwards
    assert not capsys.readouterr().err
    assert renamed_study({"fixed": {"profile": 3}, "categories": [], "design": None})["design"] is None


def test_columns_and_options_of_a_quantity_follow_its_name() -> None:
    known = ["voltage_per_load", "capacitance_per_length"]
    assert renamed("capacitance_std", known) == "capacitance_per_length_std"
    assert renamed(["capacitance_gain=3%", "input_capacitance"], known) == [
        "capacitance_per_length_gain=3%", "input_capacitance",
    ]  # fmt: skip
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
