"""A job refuses sources other than those with which its run began, also where they are put back afterwards."""

import sys
from pathlib import Path
from types import ModuleType

import pytest

from tests.workflow.conftest import job
from workflow.run import joblog, lock, sources
from workflow.run.sources import ChangedError


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A program of a script, an imported module with its data, and a module that nobody imports."""
    for name in ("workflow/scripts/slab.py", "solver/fields.py", "solver/constants.toml", "solver/other.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"# {name}\n", encoding="utf-8")
    monkeypatch.setattr(sources, "ROOT", tmp_path.resolve())
    module = ModuleType("solver.fields")
    module.__file__ = str(tmp_path / "solver/fields.py")
    monkeypatch.setitem(sys.modules, "solver.fields", module)
    return tmp_path.resolve()


@pytest.mark.parametrize("name", ["workflow/scripts/slab.py", "solver/fields.py", "solver/constants.toml"])
def test_a_job_refuses_what_was_edited_or_is_gone(root: Path, name: str) -> None:
    planned, script, whole = sources.digests(), str(root / "workflow/scripts/slab.py"), (root / name).read_bytes()
    assert len(planned) == 4
    sources.check(planned, script)
    (root / name).write_text("edited", encoding="utf-8")
    with pytest.raises(ChangedError, match=f"^{name}: was changed after this job was planned; run the study again$"):
        sources.check(planned, script)
    (root / name).write_bytes(whole)
    sources.check(planned, script)
    (root / name).unlink()
    if not name.endswith(".toml"):  # no file names data that is gone; who reads it fails
        with pytest.raises(ChangedError, match=name):
            sources.check(planned, script)


def test_what_a_job_does_not_import_may_change(root: Path) -> None:
    planned = sources.digests()
    (root / "solver/other.py").write_text("edited", encoding="utf-8")
    sources.check(planned, str(root / "workflow/scripts/slab.py"))
    sources.check({}, str(root / "workflow/scripts/slab.py"))  # a script that runs alone


def test_a_job_is_held_to_the_sources_of_the_run_that_holds_its_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The edit lies between the start of the run and that of the job, here in what the run is told of its sources."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(joblog, "_log_to", lambda _: None)
    own_job = job("own", "mee/results/own/fields/slab_0.nc")
    script = {"snakemake": own_job, "__file__": str(sources.ROOT / "workflow/scripts/slab.py")}
    began = sources.digests()
    assert joblog.start(script) is own_job  # no run
    for digests, refused in ((began, ""), (began | {"workflow/run/joblog.py": "other"}, "workflow/run/joblog.py")):
        lock.claim({"own": {}}, "mee/results", digests)
        try:
            if refused:
                with pytest.raises(ChangedError, match=refused):
                    joblog.start(script)
            else:
                assert joblog.start(script) is own_job
        finally:
            lock.release()
