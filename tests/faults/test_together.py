"""Two runs at once, one core or two, few slabs or many: no interference, and the same bytes."""

import re
import time
from collections.abc import Callable
from pathlib import Path

from storage.netcdf import ANSWERS, read_whole
from tests.faults.conftest import REPORT, RESULTS, TINY, contents
from tests.faults.processes import jobs, start
from tests.workflow.conftest import Project

Maker = Callable[[str], Project]


def test_neither_a_second_run_nor_an_edit_of_the_study_disturbs_the_first(tiny: Maker, undisturbed: Project) -> None:
    project = tiny("twice")
    study = project.folder / "config/tiny.yaml"
    first = start(project, "tiny")
    while first.poll() is None and not jobs(first):
        time.sleep(0.1)
    study.write_text(TINY.replace("fibrous", "laminate"), encoding="utf-8")
    for command in (["meecontact", "run", "tiny"], ["snakemake", "--cores", "1", REPORT]):
        second = project.run(*command, check=False)
        assert second.returncode == 1
        assert re.search(r"^study 'tiny' is already being run \(process \d+\): wait", second.stderr, re.MULTILINE)
    assert first.wait() == 0
    assert contents(project) == contents(undisturbed)
    assert (project.folder / RESULTS / "study.yaml").read_text(encoding="utf-8") == TINY  # of the crate: as it began
    assert {"slab", "cases", "surrogate", "report"} <= project.planned(REPORT)  # the edit is seen now
    study.write_text(TINY, encoding="utf-8")
    again = project.run("meecontact", "run", "tiny")
    assert "Nothing to be done" in again.stdout + again.stderr
    assert contents(project) == contents(undisturbed)


def same(first: Path, second: Path) -> bool:
    """Return True for files with equal bytes, or equal data but for the state of the study, which counts slabs."""
    if first.suffix != ".nc":
        return first.read_bytes() == second.read_bytes()
    data, others = read_whole(first), read_whole(second)
    for attributes in (data.attrs, others.attrs):
        del attributes["checksum"]
        attributes.pop(ANSWERS, None)
    return data.identical(others)


def test_cores_and_slabs_do_not_change_a_digit(tiny: Maker, undisturbed: Project) -> None:
    targets = {1: ("validation.nc", "figures/fields.svg"), 3: ("quantities.nc",)}
    for slabs, files in targets.items():
        project = tiny(f"slabs{slabs}")
        study = project.folder / "config/tiny.yaml"
        study.write_text(TINY.replace("slabs: 2", f"slabs: {slabs}"), encoding="utf-8")
        results = project.folder / RESULTS
        (results / "fields").mkdir(parents=True)
        for orphan in ("fields/slab_7.nc", "levels.nc"):  # of earlier states of the study
            (results / orphan).write_bytes(b"old")
        project.run("snakemake", "--cores", "1", *(str(RESULTS / name) for name in files))
        result = contents(project)
        assert sum("slab_" in name for name in result) == slabs
        others = {name for name in result if "slab_" not in name}
        assert others >= set(files)
        assert [name for name in others if not same(results / name, undisturbed.folder / RESULTS / name)] == []
