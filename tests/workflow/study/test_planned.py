"""The file of a study, by name, path or results; a job works on the state that was planned, or refuses."""

import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests import studies
from tests.refusals import assert_refused
from tests.workflow.conftest import SMALL, Copy, Project, job
from workflow.cli import main
from workflow.run import lock
from workflow.study import configuration, location, partition, planned
from workflow.study.contents import PHYSICS
from workflow.study.model import Study, load, named, thawed
from workflow.study.reading import InputError

STUDY = "title: t\neffects: {baseline: {material: PZT-4, radius: 0.05, load: 1e5}, vary: {friction: [0.0, 0.4]}}\n"


@pytest.fixture
def folder(here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder, and no study given by a path."""
    monkeypatch.setenv("MEECONTACT_STUDIES", "{}")
    return here


def write(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(STUDY, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["my study.yaml", "a.b.yaml", "größe.yaml", "-x.yaml", f"{'x' * 101}.yaml"])
def test_names_that_snakemake_cannot_bear(folder: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    path = write(folder / "config" / name)
    for text in (str(path), path.stem):
        assert main.main(["run", "--cores", "1", "--", text]) == 2
        line = capsys.readouterr().err
        assert line.count("\n") == 1
        assert "a study's file must be named with up to 100 of the letters a to z, digits, - and _" in line
    assert [file.name for file in folder.iterdir()] == ["config"]


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
    assert_refused(InputError, "another study named 'mine' was given before", location.given, str(other))
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


PROFILES = ("config: {friction: 0.4}", "config: [study=film, friction=0.4]", "configfile: more.yaml")


@pytest.mark.slow  # Snakemake's command line looks for Slurm
@pytest.mark.parametrize("profile", PROFILES)
def test_configuration_of_a_profile_is_refused_where_the_command_line_overrides_it(
    here: Path, monkeypatch: pytest.MonkeyPatch, profile: str
) -> None:
    monkeypatch.delenv("SNAKEMAKE_PROFILE", raising=False)
    for folder in ("mine", "profiles/default", "profiles/other"):
        (here / folder).mkdir(parents=True)
    configuration.check_profiles(["--config", "study=film"])
    (here / "more.yaml").write_text("friction: 0.4\n", encoding="utf-8")
    for folder in ("mine", "profiles/other"):
        (here / folder / "config.yaml").write_text(profile, encoding="utf-8")
    for command in (["--profile", "mine"], ["--workflow-profile", "other"], ["--workflow-profile", "mine"]):
        with pytest.raises(InputError, match="'friction': not read"):
            configuration.check_profiles([*command, "--config", "study=film", "-n"])
    monkeypatch.setenv("SNAKEMAKE_PROFILE", str(here / "mine"))
    assert_refused(InputError, "'friction': not read", configuration.check_profiles, ["--config", "study=film"])


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


MATERIAL = """\
name: mine
c11: 2.7e+11
c13: 1.2e+11
c33: 2.7e+11
c44: 7.7e+10
limits: {yield_strength: {value: 3e7, source: a}}
alternatives: [{c44: 8e+10, source: b}]
"""
OWN = """\
title: Own material
materials: [mine.yaml]
fixed: {material: mine, load: 1e5}
factors: {friction: {low: 0.0, high: 0.3, levels: 3}, radius: {low: 0.02, high: 0.2, levels: 3}}
"""


@pytest.fixture
def own_study(here: Path) -> Iterator[Study]:
    """A study with a material of its own, as it is planned, in a folder of its own."""
    Path("config").mkdir()
    Path("config/mine.yaml").write_text(MATERIAL, encoding="utf-8")
    Path("config/own.yaml").write_text(OWN, encoding="utf-8")
    yield partition.with_slabs(named("own"))
    lock.release()


def job_study(parameter: str, prefix: str = "") -> Study:
    """Study on which a job of the study `own` works."""
    return planned.study(job("own", f"{prefix}results/own/fields/slab_0.nc", parameter=parameter))


def edit(file: str, old: str, new: str) -> None:
    text = Path(file).read_text(encoding="utf-8")
    assert old in text
    Path(file).write_text(text.replace(old, new), encoding="utf-8")


@pytest.mark.parametrize(
    ("file", "old", "new", "prefix"),
    [
        ("config/own.yaml", "load: 1e5", "load: 2e5", ""),
        ("config/mine.yaml", "c44: 7.7e+10", "c44: 7.70000000001e+10", "mee/"),
        ("config/own.yaml", "load: 1e5", "load: [", ""),
    ],
)
def test_an_edit_during_a_run_reaches_no_job(own_study: Study, file: str, old: str, new: str, prefix: str) -> None:
    parameter = planned.parameter(own_study, *PHYSICS)
    lock.claim({"own": own_study.frozen()}, f"{prefix}results")
    edit(file, old, new)
    result = job_study(parameter, prefix)
    assert result.fixed["load"] == 1e5
    stated, expected = result.own_materials["mine"], own_study.own_materials["mine"]
    assert (stated.limits, stated.alternatives) == (expected.limits, expected.alternatives)
    assert result.digest(*PHYSICS) == own_study.digest(*PHYSICS)
    lock.release()
    with pytest.raises(InputError, match=r"^config/own\.yaml: ") as caught:
        job_study(parameter, prefix)
    assert "\n" not in str(caught.value)


def test_without_a_copy_of_the_start_an_edited_study_is_refused(own_study: Study) -> None:
    parameter = planned.parameter(own_study, *PHYSICS)
    edit("config/own.yaml", "Own", "My own")
    assert job_study(parameter).title == "My own material"  # not among what the job was planned with
    with pytest.raises(InputError, match=r"own\.yaml: was changed \(.*title.*\) after this job was planned; run"):
        job_study(planned.parameter(own_study))


@pytest.mark.parametrize("text", ["", '{"study": {"title"', "[]"])
def test_what_a_killed_run_has_left_half_written_is_not_believed(own_study: Study, text: str) -> None:
    Path("results/own").mkdir(parents=True)
    Path("results/own/.running").write_text(text, encoding="utf-8")
    assert job_study(planned.parameter(own_study)).digest(*PHYSICS) == own_study.digest(*PHYSICS)


@pytest.mark.parametrize("name", studies.NAMES)
def test_every_study_thaws_as_it_was_frozen(name: str) -> None:
    study = partition.with_slabs(studies.shipped(name))
    again = thawed(study.frozen())
    assert again.digest(*Study.model_fields) == study.digest(*Study.model_fields)
    assert again.quantities == study.quantities
    assert again.stores_fields == study.stores_fields


def test_a_job_on_other_cores_has_the_planned_slabs(own_study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    """The planner hands its number on by --config too: a node of fewer cores would take slab 0 for all cases."""
    monkeypatch.setattr("os.sysconf", {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": 2**22}.__getitem__)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1})
    entries = partition.settle(["study=own"], planner=True)
    two = partition.with_slabs(named("own"))
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0})
    monkeypatch.setattr("os.environ", {})
    assert (partition.count(two), partition.count(thawed(two.frozen())), partition.count(named("own"))) == (2, 2, 1)
    assert partition.with_slabs(named("own")).digest("dataset") != two.digest("dataset")
    assert partition.settle(entries, planner=False) == entries
    assert partition.with_slabs(named("own")).digest("dataset") == two.digest("dataset")


TARGET = {"target", "design", "figure_design", "sensitivity", "figure_sensitivity", "solved", "provenance", "report"}


def test_an_edit_reruns_what_hangs_on_it(ran: Project, copy: Copy) -> None:
    """Edits of a study's sections; those of sources: tests/workflow/test_pipeline.py."""
    project = copy("edits")
    for folder in ("results", ".snakemake"):
        shutil.copytree(ran.folder / folder, project.folder / folder)
    for old, new, file, expected in (
        ("maximise: abs(voltage_per_load)", "minimise: peak_pressure", "report.html", TARGET),
        ("maximise: abs(voltage_per_load)", "minimise: peak_pressure", "design/impossible.nc", set()),
        ("cases: 200", "cases: 100", "validation.nc", {"cases", "validation"}),
        ("0.5, levels: 4", "0.5, levels: 5", "surrogate.nc", {"slab", "quantities", "surrogate"}),
        ("0.5, levels: 4", "0.4, levels: 4", "surrogate.nc", {"slab", "quantities", "calibration", "surrogate"}),
    ):
        reruns = project.planned_after([("config/small.yaml", old, new)], f"results/small/{file}")
        assert reruns == expected, (new, file)


def test_a_node_of_a_cluster_works_on_the_study_of_the_start(copy: Copy, ran: Project) -> None:
    project, slab = copy("node"), "results/small/fields/slab_0.nc"
    study = partition.with_slabs(load(project.folder / "config/small.yaml"))
    lock.claim({"small": study.frozen()}, project.folder / "results")
    try:
        (project.folder / "config/small.yaml").write_text(SMALL.replace("fibrous", "laminate"), encoding="utf-8")
        job = ["--target-jobs", "slab:slab=0,study=small", "--allowed-rules", "slab"]
        project.run("snakemake", "--mode", "remote", "--no-hooks", "--nolock", "--force", "--cores", "1", *job)
    finally:
        lock.release()
    assert (project.folder / slab).read_bytes() == (ran.folder / slab).read_bytes()
