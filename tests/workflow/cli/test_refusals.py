"""Options are refused in one line with status 2, before anything is read or written."""

import json
import os
import subprocess
from pathlib import Path

import pytest
from snakemake.cli import parse_config

from tests.programs import Command
from workflow.language.spelling import nearest
from workflow.run.provenance import ROOT
from workflow.study import location


@pytest.mark.parametrize("count", ["0", "-1", "x", "1.5", "", "１", "9" * 4301])
def test_cores_are_a_number_from_one_on_or_all(count: str, command: Command) -> None:
    assert "--cores: " in command.refused("run", "quickstart", f"--cores={count}")


@pytest.mark.parametrize("words", [["solve"], ["interior", "--x=0", "--y=-1"]])
def test_netcdf_has_no_other_suffix(words: list[str], tmp_path: Path, command: Command) -> None:
    out = tmp_path / "x.xlsx"
    assert "must end in .nc" in command.refused(*words, ROOT / "examples/cases.csv", "-o", out)
    assert not out.exists()


def test_a_composite_is_no_misspelt_material(command: Command) -> None:
    refusal = command.refused("material", "AlScN")
    assert "is a composition, not one material: a case says composite=AlScN and scandium_fraction" in refusal
    assert "scandium_fraction" in refusal
    assert "did you mean" not in refusal


def test_the_page_s_own_names_lead_to_the_interface_s() -> None:
    known = ["voltage_noise", "voltage_per_load", "contact_trailing"]
    assert "did you mean 'contact_trailing'?" in nearest("trailing extent of the contact", known)


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["müller", "a'b", 'a"b', "a b", "a: b #c", "100%25", "a\\b"])
def test_snakemake_hands_on_any_path_of_a_study(folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "environ", {**os.environ})
    path = tmp_path / folder / "mine.yaml"
    path.parent.mkdir()
    path.write_text("title: Mine\n", encoding="utf-8")
    assert location.given(str(path)) == "mine"
    handed = parse_config([f"study={location.address('mine')}"])["study"]
    quoted = subprocess.run(["bash", "-c", f"printf %s {handed}"], capture_output=True, text=True, check=True)
    assert quoted.stdout == handed
    os.environ.pop("MEECONTACT_STUDIES")
    assert location.given(handed) == "mine"
    assert location.location("mine") == path


def test_a_folder_in_which_no_netcdf_file_can_be_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    (tmp_path / "a\\b").mkdir()
    monkeypatch.chdir(tmp_path / "a\\b")
    assert "backslash" in command.refused("run", "quickstart")


STUDY = """\
title: Mine
fixed: {material: PZT-4, radius: 0.05}
factors: {load: {low: 5e3, high: 5e4, levels: 4}}
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(os, "environ", {**os.environ})
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    (tmp_path / "other/mine.yaml").write_text(STUDY, encoding="utf-8")
    return tmp_path / "other/mine.yaml"


def test_a_bad_study_is_one_line_and_nothing_is_written(mine: Path, command: Command) -> None:
    mine.write_text(STUDY.replace("load:", "laod:"), encoding="utf-8")
    line = command.refused("run", mine)
    assert "other/mine.yaml: factors.laod: 'laod' is not a factor; did you mean 'load'" in line
    assert {file.name for file in Path().rglob("*")} == {"other", "mine.yaml"}


@pytest.mark.parametrize("name", ["results", "logs", "results/mine", "logs/mine"])
def test_a_file_where_results_would_go_is_named(name: str, mine: Path, command: Command) -> None:
    Path(name).parent.mkdir(exist_ok=True)
    Path(name).write_text("", encoding="utf-8")
    assert f"{name}: is no folder" in command.refused("run", mine, "-n")


def test_results_of_a_namesake_are_not_replaced(mine: Path, command: Command) -> None:
    first = Path("config/mine.yaml")
    first.parent.mkdir()
    first.write_text(STUDY, encoding="utf-8")
    results = Path("results/mine")
    results.mkdir(parents=True)
    (results / "provenance.json").write_text(json.dumps({"study": "../../config/mine.yaml"}), encoding="utf-8")
    assert "results/mine: holds the results of" in command.refused("run", mine, "-n")
    location.given(str(mine))
    first.unlink()  # the study has moved
    location.check_owner("mine", results)
