"""Configuration that the pipeline does not read ends a run in one line, by whichever of Snakemake's ways it came."""

from pathlib import Path
from typing import Any

import pytest

from tests.workflow.conftest import Copy
from workflow.study import configuration
from workflow.study.reading import InputError


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
