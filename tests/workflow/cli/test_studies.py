"""A study of one's own to begin with, and the names that it may use."""

import io
import logging
import re
from pathlib import Path
from typing import Any

import pytest

from solver.names import ALL_QUANTITIES
from tests.programs import Command
from workflow.cli import studies
from workflow.cli.progress import Progress, busy, step
from workflow.run.provenance import ROOT
from workflow.study.model import load
from workflow.study.reading import read_yaml


def test_what_init_writes_is_a_study_with_a_comment_on_every_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command("init", "mine") == ("", "wrote config/mine.yaml: meecontact run mine\n")
    study = load(tmp_path / "config/mine.yaml")
    assert study.design["sensor"].limits
    assert study.cases == 12 * 4 * 6 * 6
    text = (tmp_path / "config/mine.yaml").read_text(encoding="utf-8")
    assert "meecontact run mine" in text
    assert text.count("#") > 12
    refusal = "meecontact: init: config/mine.yaml is there already; remove it, or choose another name\n"
    assert command.refused("init", "mine") == refusal
    assert command.refused("init", "../mine").startswith("meecontact: init: '../mine': a study's file must be named")
    assert [file.name for file in tmp_path.rglob("*.yaml")] == ["mine.yaml"]
    command("init", "balls", "--like", "point_sensor")
    assert read_yaml(tmp_path / "config/balls.yaml") == read_yaml(ROOT / "config/point_sensor.yaml")
    said = command.refused("init", "other", "--like", "point_senor")
    assert "--like: 'point_senor' is unknown; did you mean 'point_sensor'?" in said


def test_list_tells_every_name_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    printed = studies.listed(None)
    assert re.findall(r"^\w+:$", printed, re.MULTILINE) == ["studies:", "factors:", "quantities:", "materials:"]
    quantities = studies.listed("quantities").splitlines()
    assert [line.split()[0] for line in quantities] == list(ALL_QUANTITIES)
    assert any(line.split()[:2] == ["voltage_per_load", "V·m/N"] for line in quantities)
    assert re.search(r"^quickstart +Which composite", studies.listed("studies"), re.MULTILINE)
    local = studies.listed("studies")
    monkeypatch.chdir(tmp_path)
    assert studies.listed("studies") == local  # those that come with the program
    (tmp_path / "config").mkdir()
    (tmp_path / "config/mine.yaml").write_text("title: My own\n", encoding="utf-8")
    first, *others = studies.listed("studies").splitlines()
    assert first.split() == ["mine", "My", "own"]
    assert [line.split() for line in others] == [line.split() for line in local.splitlines()]


class Terminal(io.StringIO):
    """A stream that people look at."""

    def isatty(self) -> bool:
        return True


def record(event: str = "", level: int = logging.INFO, message: str = "", **known: Any) -> logging.LogRecord:
    """Record of Snakemake's log."""
    entry = logging.LogRecord("snakemake.logging", level, "", 0, message, None, None)
    entry.__dict__.update(known, event=type("Event", (), {"value": event})())
    return entry


def test_a_log_has_a_line_a_step_and_a_terminal_one_line_in_all() -> None:
    """Two jobs that begin, one that ends, and lines of Snakemake's own."""
    study = load("config/quickstart.yaml")
    records = [
        record("run_info", message="Job stats"),
        record("job_info", jobid=3, rule_name="surrogate", wildcards={"study": "quickstart"}),
        record("job_info", jobid=4, rule_name="target", wildcards={"study": "quickstart", "name": "sensor"}),
        record("job_finished", job_id=3, message="Finished jobid: 3"),
        record("progress", done=5, total=19),
        record(message="Nothing to be done (all requested files are present and up to date)."),
        record("job_error", logging.ERROR, "Error in rule surrogate"),
    ]
    fitting = "fitting the surrogate (21 quantities, 41,600 cases)"
    log, terminal = io.StringIO(), Terminal()
    for stream in (log, terminal):
        shown = Progress(study, stream)
        assert [shown.filter(entry) for entry in records] == [False] * 5 + [True] * 2
    assert log.getvalue() == f"{fitting}\ntarget sensor\n"
    shown.clear()
    text = terminal.getvalue()
    assert text.endswith("\r\x1b[K")
    assert "\n" not in text
    lines = text.split("\r\x1b[K")
    assert lines[1:3] == [fitting, f"{fitting}, target sensor"]
    assert "5 of 19 steps done; target sensor" in lines


def test_a_step_is_said_by_what_it_does() -> None:
    study, names = load("config/quickstart.yaml"), {"slab": "1", "name": "sensor", "group": "films", "round": "1"}
    for rule, name, words in (("slab", "slab", "solving the data set, part 2 of 2"),
                              ("figure_errors", "", "drawing errors"),
                              ("figure_design", "name", "drawing design sensor"),
                              ("check", "group", "verification films"),
                              ("report", "", "writing the page")):  # fmt: skip
        wildcards = {key: value for key, value in names.items() if key == name}
        assert step(study, rule, {"study": "quickstart", **wildcards}) == words
    rules = [line.split()[1].rstrip(":") for file in (ROOT / "workflow/rules").glob("*.smk")
             for line in file.read_text(encoding="utf-8").splitlines() if line.startswith("rule ")]  # fmt: skip
    assert len(rules) > 20
    assert all(rule.startswith("figure_") or "drawing" not in step(study, rule, names) for rule in rules)


def test_only_a_terminal_sees_the_present_step(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with busy("searching"):
        pass
    assert capsys.readouterr() == ("", "")
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    with busy("searching"):
        pass
    clear = "\r\x1b[K"
    assert terminal.getvalue() == f"{clear}searching ...{clear}"
