"""Studies by name, by path and from their results; bad names and unread configuration are refused."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from tests.workflow.conftest import Copy
from workflow.cli import main
from workflow.study import configuration, location
from workflow.study.reading import InputError

STUDY = "title: t\neffects: {baseline: {material: PZT-4, radius: 0.05, load: 1e5}, vary: {friction: [0.0, 0.4]}}\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder, and no study given by a path."""
    monkeypatch.setenv("MEECONTACT_STUDIES", "{}")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(STUDY, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["my study.yaml", "a.b.yaml", "größe.yaml", "-x.yaml", f"{'x' * 101}.yaml"])
def test_names_that_snakemake_cannot_bear_are_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    path = write(folder / "config" / name)
    for text in (str(path), path.stem):
        assert main.main(["run", "--cores", "1", "--", text]) == 2
        line = capsys.readouterr().err
        assert line.count("\n") == 1
        assert "a study's file must be named with up to 100 of the letters a to z, digits, - and _" in line
    assert [file.name for file in folder.iterdir()] == ["config"]


def test_outside_of_a_project_it_says_what_to_do(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["run", "quickstar"]) == 2
    line = capsys.readouterr().err
    assert f"study: 'quickstar' is unknown: {folder} has no config/*.yaml; go to a folder that has one" in line
    assert "did you mean 'quickstart'?" in line
    assert line.count("\n") == 1


def test_a_study_comes_with_the_program_unless_the_folder_has_one_of_its_name(folder: Path) -> None:
    path = write(folder / "config/film.yaml")
    assert location.given("film") == "film"
    assert not location.by_path("film")
    assert location.location("film").resolve() == path.resolve()
    assert location.given("quickstart") == "quickstart"
    assert location.by_path("quickstart")
    assert location.location("quickstart") == location.BUNDLED / "quickstart.yaml"


def test_what_is_no_file_is_not_waited_for(folder: Path) -> None:
    os.mkfifo(folder / "pipe.yaml")
    for name, reason in (("absent.yaml", "No such file"), ("pipe.yaml", "not a file")):
        with pytest.raises(InputError, match=f"{name}: {reason}; a study is given by its name in config/, or by the"):
            location.given(name)


def test_a_study_that_was_given_by_a_path_keeps_its_name(folder: Path) -> None:
    write(folder / "config/mine.yaml")
    mine, other = write(folder / "far/mine.yaml"), write(folder / "other/mine.yaml")
    assert location.location("mine") == Path("config/mine.yaml")
    assert location.given("far/mine.yaml") == location.given(str(mine)) == "mine"
    with pytest.raises(InputError, match="another study named 'mine' was given before"):
        location.given(str(other))
    assert location.location("mine") == mine


def test_results_know_the_file_that_they_were_made_from(folder: Path) -> None:
    results = folder / "results/mine"
    results.mkdir(parents=True)
    near, far = write(folder / "config/mine.yaml"), write(folder / "far/mine.yaml")
    assert location.of_results(Path("results/mine")) == near
    location.given("far/mine.yaml")
    record = location.from_results("mine", Path("results/mine"))
    assert record == "../../far/mine.yaml"
    for study, expected in ((record, far), ("../../gone.yaml", near), (3, near), ("../../../../etc/passwd", near)):
        (results / "provenance.json").write_text(json.dumps({"study": study}), encoding="utf-8")
        assert location.of_results(Path("results/mine")) == expected


@pytest.mark.parametrize(
    ("config", "entries", "reason"),
    [
        ({"stduy": "peaks"}, (), "'stduy': not read; did you mean 'study'"),
        ({"study": "peaks", "friction": 0.4}, (), "'friction': not read; the pipeline reads"),
        ({"study": None}, (), "None is no study"),
        ({"study": {"friction": "0.4"}}, (), "is no study"),
        ({"study": "film"}, ("study=peaks", "study=film"), "study=peaks study=film: study is given 2 times"),
    ],
)
def test_unread_configuration_is_refused(config: dict[str, Any], entries: tuple[str, ...], reason: str) -> None:
    with pytest.raises(InputError, match=reason) as refusal:
        configuration.study(config, entries)
    assert "\n" not in str(refusal.value)


@pytest.mark.slow  # Snakemake's command line looks for Slurm
@pytest.mark.parametrize(
    "profile", ["config: {friction: 0.4}", "config: [study=film, friction=0.4]", "configfile: more.yaml"]
)
def test_configuration_of_a_profile_is_refused_where_the_command_line_overrides_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, profile: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("SNAKEMAKE_PROFILE", raising=False)
    for folder in ("mine", "profiles/default", "profiles/other"):
        (tmp_path / folder).mkdir(parents=True)
    configuration.check_profiles(["--config", "study=film"])
    (tmp_path / "more.yaml").write_text("friction: 0.4\n", encoding="utf-8")
    (tmp_path / "mine/config.yaml").write_text(profile, encoding="utf-8")
    (tmp_path / "profiles/other/config.yaml").write_text(profile, encoding="utf-8")
    for command in (["--profile", "mine"], ["--workflow-profile", "other"], ["--workflow-profile", "mine"]):
        with pytest.raises(InputError, match="'friction': not read"):
            configuration.check_profiles([*command, "--config", "study=film", "-n"])
    monkeypatch.setenv("SNAKEMAKE_PROFILE", str(tmp_path / "mine"))
    with pytest.raises(InputError, match="'friction': not read"):
        configuration.check_profiles(["--config", "study=film"])


def test_a_run_with_unread_configuration_plans_nothing(copy: Copy) -> None:
    project = copy("configuration")
    done = project.snakemake("-n", "--config", "study=small", "friction=0.4", check=False)
    assert done.returncode == 1
    assert "'friction': not read" in done.stdout + done.stderr
    (project.folder / "profiles/mine").mkdir(parents=True)
    (project.folder / "profiles/mine/config.yaml").write_text("cores: 1\nconfig: {friction: 0.4}\n", encoding="utf-8")
    done = project.run("meecontact", "run", "small", "--profile", "mine", check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "'friction': not read" in done.stderr
