"""Locks of results; the sources and files that a job works on are those of its run, or it ends in one line."""

import ast
import fcntl
import json
import os
import re
import shutil
import socket
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import IO, Any

import numpy as np
import pytest
import xarray as xr

from storage import netcdf
from storage.blocks import write_blocks
from storage.sealed import FormatError
from tests import layers
from tests.refusals import assert_refused
from tests.workflow.conftest import job
from workflow.run import joblog, lock, provenance
from workflow.run.provenance import ChangedError

SCRIPTS = provenance.ROOT / "workflow" / "scripts"


def test_imports_by_their_lines_are_those_that_python_reads() -> None:
    files = sorted(file for room in provenance.ROOMS for file in (provenance.ROOT / room).rglob("*.py"))
    for path in files if layers.SOAK else files[::4]:
        text = path.read_text(encoding="utf-8")
        parsed = set()
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ImportFrom):
                parsed |= {(node.module, alias.name) for alias in node.names}
            elif isinstance(node, ast.Import):
                parsed |= {("", alias.name) for alias in node.names}
        assert set(provenance.imports(text)) == parsed, path


@pytest.mark.parametrize(
    ("script", "held", "left_out"),
    [
        ("slab.py", "solver/halfplane/contact.py solver/material/materials.toml workflow/dataset/factorial.py",
         "workflow/report/page.py workflow/design/search/targets.py workflow/cli/main.py surrogate/gp/gridgp.py"),
        ("target.py", "solver/halfplane/contact.py surrogate/search/optimise.py", "workflow/report/page.py"),
        ("report.py", "workflow/report/templates/report.html.j2", "workflow/design/search/targets.py"),
    ],
)  # fmt: skip
def test_a_script_reaches_the_modules_and_data_that_it_needs(script: str, held: str, left_out: str) -> None:
    files = {file.relative_to(provenance.ROOT).as_posix() for file in provenance.sources(SCRIPTS / script)}
    assert files >= set(held.split())
    assert not files & set(left_out.split())
    first = provenance.code(f"workflow/scripts/{script}")  # the hash follows the bytes
    assert first == provenance.code(f"workflow/scripts/{script}")
    assert first != provenance.code(f"workflow/scripts/{script}", "workflow/report/captions/design.rst")


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A program of a script, an imported module with its data, and a module that nobody imports."""
    for name in ("workflow/scripts/slab.py", "solver/fields.py", "solver/constants.toml", "solver/other.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"# {name}\n", encoding="utf-8")
    monkeypatch.setattr(provenance, "ROOT", tmp_path.resolve())
    module = ModuleType("solver.fields")
    module.__file__ = str(tmp_path / "solver/fields.py")
    monkeypatch.setitem(sys.modules, "solver.fields", module)
    return tmp_path.resolve()


@pytest.mark.parametrize("name", ["workflow/scripts/slab.py", "solver/fields.py", "solver/constants.toml"])
def test_a_job_refuses_what_was_edited_or_is_gone(root: Path, name: str) -> None:
    planned, script, whole = provenance.digests(), str(root / "workflow/scripts/slab.py"), (root / name).read_bytes()
    assert len(planned) == 4
    (root / "solver/other.py").write_text("edited", encoding="utf-8")  # what the job does not import may change
    provenance.check(planned, script)
    (root / name).write_text("edited", encoding="utf-8")
    with pytest.raises(ChangedError, match=f"^{name}: was changed after this job was planned; run the study again$"):
        provenance.check(planned, script)
    provenance.check({}, script)  # a script that runs alone
    (root / name).write_bytes(whole)
    provenance.check(planned, script)
    (root / name).unlink()
    if not name.endswith(".toml"):  # no file names data that is gone; who reads it fails
        assert_refused(ChangedError, name, provenance.check, planned, script)


@pytest.mark.usefixtures("here")
def test_a_job_is_held_to_the_sources_of_its_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """The edit lies between the start of the run and that of the job, here in what the run is told of its sources."""
    monkeypatch.setattr(joblog, "_log_to", lambda _: None)
    own_job = job("own", "mee/results/own/fields/slab_0.nc")
    script = {"snakemake": own_job, "__file__": str(provenance.ROOT / "workflow/scripts/slab.py")}
    began = provenance.digests()
    assert joblog.start(script) is own_job  # no run
    for digests, refused in ((began, ""), (began | {"workflow/run/joblog.py": "other"}, "workflow/run/joblog.py")):
        lock.claim({"own": {}}, "mee/results", digests)
        try:
            if refused:
                assert_refused(ChangedError, refused, joblog.start, script)
            else:
                assert joblog.start(script) is own_job
        finally:
            lock.release()


STATE, OTHER = "fixed factors: 0123", "fixed factors: 4567"
DATA = xr.Dataset({"x": ("case", np.arange(3.0))})


@pytest.fixture
def _run(here: Path) -> Iterator[None]:
    """A run of the study ``own`` in an empty folder."""
    lock.claim({"own": {}}, "mee/results", None, {"own": [STATE]})
    yield
    lock.release()
    netcdf.bind({}, {})


def begin(study: str, output: str, *inputs: str, state: str = STATE) -> None:
    joblog.bind(job(study, output, *inputs, parameter=state))


def slab(study: str, number: int, state: str = STATE) -> str:
    path = Path(f"mee/results/{study}/fields/slab_{number}.nc")
    path.parent.mkdir(parents=True, exist_ok=True)
    begin(study, str(path), state=state)
    if number:
        netcdf.write_whole(DATA, path)
    else:
        write_blocks(path, DATA, [((slice(None),), {"x": DATA["x"].values})], {})
    return str(path)


@pytest.mark.usefixtures("_run")
def test_a_file_answers_what_its_path_and_study_say() -> None:
    first, second, foreign = slab("own", 0), slab("own", 1), slab("other", 0)
    begin("own", "mee/results/own/quantities.nc", first, second)
    for path in (first, second):
        assert netcdf.read_whole(path).attrs.keys().isdisjoint([netcdf.ANSWERS])
        with netcdf.read_whole(path, lazy=True) as lazy, netcdf.read_whole(path, names=["x"]) as part:
            np.testing.assert_array_equal(lazy["x"], part["x"])
    shutil.copy(first, "first.nc")
    for source, message in (
        (second, "holds own/fields/slab_1.nc, not own/fields/slab_0.nc; remove it, and run again"),
        (foreign, "holds other/fields/slab_0.nc, not own/fields/slab_0.nc"),
    ):
        shutil.copy(source, first)
        options: dict[str, Any]
        for options in ({}, {"lazy": True}, {"names": ["x"]}):
            with pytest.raises(FormatError, match=message):
                netcdf.read_whole(first, **options)


@pytest.mark.usefixtures("_run")
def test_a_file_of_another_state_of_the_study_is_refused() -> None:
    path = slab("own", 0, OTHER)
    begin("own", "mee/results/own/quantities.nc", path)
    with pytest.raises(FormatError, match=r"made from another state of the study \(fixed factors\); remove it"):
        netcdf.read_whole(path)
    netcdf.bind({}, {})
    netcdf.write_whole(DATA, path)  # by nobody's job
    begin("own", "mee/results/own/quantities.nc", path)
    assert_refused(FormatError, "holds no name of a file", netcdf.read_whole, path)
    lock.release()  # a script that runs alone knows the path only
    begin("own", path, state=OTHER)
    netcdf.write_whole(DATA, path)
    begin("own", "mee/results/own/quantities.nc", path)
    assert netcdf.read_whole(path).sizes == {"case": 3}


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A large disk to which the results of two checkouts lead; the first of them is the current folder."""
    for name in ("disk", "one", "two"):
        (tmp_path / name).mkdir()
    for name in ("one", "two"):
        (tmp_path / name / "results").symlink_to(tmp_path / "disk")
    monkeypatch.chdir(tmp_path / "one")
    yield tmp_path / "disk"
    lock.release()


def test_checkouts_that_share_results_share_the_lock(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock.claim({"tiny": {"title": "one"}})
    monkeypatch.chdir(disk.parent / "two")
    busy = rf"^study 'tiny' is .* \(process {os.getpid()}\): wait until that ends$"
    assert_refused(lock.BusyError, busy, lock.claim, {"tiny": {"title": "two"}})
    assert lock.begun("tiny") == {"title": "one"}
    lock.claim({"other": {}})
    lock.release()
    assert not [file for file in disk.rglob("*") if file.is_file()]
    lock.claim({"tiny": {"title": "two"}})
    assert lock.begun("tiny") == {"title": "two"}
    (disk / "same").symlink_to(disk / "tiny")
    assert_refused(lock.BusyError, "study 'same' is already being run", lock.claim, {"same": {}})


def test_what_a_killed_run_leaves_holds_nobody(disk: Path) -> None:
    (disk / "tiny").mkdir()
    stale = json.dumps({"host": "elsewhere", "process": 1, "study": {"title": "a much longer title than the next one"}})
    (disk / "tiny/.running").write_text(stale, encoding="utf-8")
    lock.claim({"tiny": {"title": "next"}})
    assert lock.begun("tiny") == {"title": "next"}


def test_a_lock_that_its_holder_removes_meanwhile_is_taken_anew(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock.claim({"tiny": {"title": "first"}})
    flock = fcntl.flock

    def ends_just_before(file: IO[str], operation: int) -> None:
        monkeypatch.setattr(fcntl, "flock", flock)
        lock.release()
        flock(file, operation)  # of a file that has no name any more

    monkeypatch.setattr(fcntl, "flock", ends_just_before)
    lock.claim({"tiny": {"title": "second"}})
    assert lock.begun("tiny") == {"title": "second"}
    with pytest.raises(lock.BusyError):
        lock.claim({"tiny": {}})


def test_a_holder_elsewhere_is_named_with_its_host(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lock.claim({"tiny": {}})
    monkeypatch.setattr(socket, "gethostname", lambda: "another")
    host = json.loads((disk / "tiny/.running").read_text(encoding="utf-8"))["host"]
    assert_refused(lock.BusyError, rf"\(process {os.getpid()} on {re.escape(host)}\): wait", lock.claim, {"tiny": {}})


def test_results_without_locks_are_named_in_one_line(disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_file: object, _operation: int) -> None:
        raise OSError(37, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none)
    assert_refused(OSError, r"No locks available: 'results/tiny/\.running'", lock.claim, {"tiny": {}})
