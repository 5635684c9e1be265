"""The hash of a script follows the sources that the script reaches, and nothing else."""

import ast
import sys
from pathlib import Path
from types import ModuleType

import pytest

from tests import layers
from tests.workflow.conftest import job
from workflow.run import joblog, lock, provenance
from workflow.run.provenance import ChangedError

SCRIPTS = provenance.ROOT / "workflow" / "scripts"


def reached(script: str) -> set[str]:
    return {file.relative_to(provenance.ROOT).as_posix() for file in provenance.sources(SCRIPTS / script)}


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
    files = reached(script)
    assert files >= set(held.split())
    assert not files & set(left_out.split())


def test_the_hash_follows_the_bytes() -> None:
    first = provenance.code("workflow/scripts/report.py")
    assert first == provenance.code("workflow/scripts/report.py")
    assert first != provenance.code("workflow/scripts/report.py", "workflow/report/captions/design.rst")


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
        with pytest.raises(ChangedError, match=name):
            provenance.check(planned, script)


def test_a_job_is_held_to_the_sources_of_its_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The edit lies between the start of the run and that of the job, here in what the run is told of its sources."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(joblog, "_log_to", lambda _: None)
    own_job = job("own", "mee/results/own/fields/slab_0.nc")
    script = {"snakemake": own_job, "__file__": str(provenance.ROOT / "workflow/scripts/slab.py")}
    began = provenance.digests()
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
