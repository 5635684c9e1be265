"""A job works on the study that it was planned with, or refuses: never on what the file has become since."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests import studies
from tests.workflow.conftest import SMALL, Copy, Project, job
from workflow.run import lock
from workflow.study import partition, planned
from workflow.study.contents import PHYSICS
from workflow.study.model import Study, load, named, thawed
from workflow.study.reading import InputError

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
def own_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Study]:
    """A study with a material of its own, as it is planned, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
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


def test_a_job_on_other_cores_has_the_slabs_that_were_planned(
    own_study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
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
    lock.claim(
        {"small": partition.with_slabs(load(project.folder / "config/small.yaml")).frozen()}, project.folder / "results"
    )
    try:
        (project.folder / "config/small.yaml").write_text(SMALL.replace("fibrous", "laminate"), encoding="utf-8")
        job = ["--target-jobs", "slab:slab=0,study=small", "--allowed-rules", "slab"]
        project.run("snakemake", "--mode", "remote", "--no-hooks", "--nolock", "--force", "--cores", "1", *job)
    finally:
        lock.release()
    assert (project.folder / slab).read_bytes() == (ran.folder / slab).read_bytes()
