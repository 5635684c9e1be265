"""A study of one's own to begin with, and the names that it may use."""

import re
from pathlib import Path

import pytest

from solver.names import ALL_QUANTITIES
from workflow.cli import studies
from workflow.cli.main import main
from workflow.run.sources import ROOT
from workflow.study.model import load
from workflow.study.reading import InputError, read_yaml


def test_what_init_writes_is_a_study_with_a_comment_on_every_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["init", "mine"]) == 0
    assert capsys.readouterr().err == "wrote config/mine.yaml: meecontact run mine\n"
    study = load(tmp_path / "config/mine.yaml")
    assert study.design["sensor"].limits
    assert study.cases == 12 * 4 * 6 * 6
    text = (tmp_path / "config/mine.yaml").read_text(encoding="utf-8")
    assert "meecontact run mine" in text
    assert text.count("#") > 12
    assert main(["init", "mine"]) == 2
    assert capsys.readouterr().err == (
        "meecontact: init: config/mine.yaml is there already; remove it, or choose another name\n"
    )
    with pytest.raises(InputError, match=r"^init: '\.\./mine': a study's file must be named"):
        studies.begin("../mine")
    assert [file.name for file in tmp_path.rglob("*.yaml")] == ["mine.yaml"]
    assert main(["init", "balls", "--like", "point_sensor"]) == 0
    assert read_yaml(tmp_path / "config/balls.yaml") == read_yaml(ROOT / "config/point_sensor.yaml")
    with pytest.raises(InputError, match=r"^--like: 'point_senor' is unknown; did you mean 'point_sensor'\?"):
        studies.begin("other", "point_senor")


def test_list_tells_every_name_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    printed = studies.listed(None)
    assert [line for line in printed.splitlines() if line.endswith(":") and " " not in line] == [
        "studies:", "factors:", "quantities:", "materials:"
    ]  # fmt: skip
    quantities = studies.listed("quantities").splitlines()
    assert [line.split()[0] for line in quantities] == list(ALL_QUANTITIES)
    assert any(line.split()[:2] == ["voltage_per_load", "V·m/N"] for line in quantities)
    assert re.search(r"^quickstart +Which composite", studies.listed("studies"), re.MULTILINE)
    with pytest.raises(InputError, match=r"^list: 'material' is unknown; did you mean 'materials'\?"):
        studies.listed("material")
    local = studies.listed("studies")
    monkeypatch.chdir(tmp_path)
    assert studies.listed("studies") == local  # those that come with the program
    (tmp_path / "config").mkdir()
    (tmp_path / "config/mine.yaml").write_text("title: My own\n", encoding="utf-8")
    first, *others = studies.listed("studies").splitlines()
    assert first.split() == ["mine", "My", "own"]
    assert [line.split() for line in others] == [line.split() for line in local.splitlines()]
