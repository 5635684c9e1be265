"""The hash of a script follows the sources that the script reaches, and nothing else."""

import ast
import subprocess
import sys

import pytest

from workflow.run import provenance

SCRIPTS = provenance.ROOT / "workflow" / "scripts"


def reached(script: str) -> set[str]:
    return {file.relative_to(provenance.ROOT).as_posix() for file in provenance.sources(SCRIPTS / script)}


def test_imports_by_their_lines_are_those_that_python_reads() -> None:
    for path in (file for room in provenance.ROOMS for file in (provenance.ROOT / room).rglob("*.py")):
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
        (
            "slab.py",
            "solver/face/solution.py solver/halfplane/contact.py solver/material/materials.toml "
            "workflow/dataset/factorial.py",
            "workflow/report/page.py workflow/design/search/targets.py workflow/cli/main.py surrogate/gp/gridgp.py",
        ),
        (
            "target.py",
            "solver/halfplane/contact.py surrogate/search/optimise.py workflow/design/search/targets.py",
            "workflow/report/page.py",
        ),
        ("sensitivity.py", "surrogate/gp/gridgp.py surrogate/face/persistence.py", ""),
        ("report.py", "workflow/report/templates/report.html.j2", "workflow/design/search/targets.py"),
    ],
)
def test_a_script_reaches_the_modules_and_data_that_it_needs(script: str, held: str, left_out: str) -> None:
    files = reached(script)
    assert files >= set(held.split())
    assert not files & set(left_out.split())


@pytest.mark.process
def test_jobs_and_commands_without_models_and_figures_start_without_their_libraries() -> None:
    modules = "solver, workflow.dataset.slabs, workflow.dataset.datacard, workflow.cli.launch, workflow.cli.main"
    code = f"import sys, {modules}; print(*{{'sklearn', 'matplotlib', 'jinja2', 'scipy.stats'}} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


def test_the_hash_follows_the_bytes() -> None:
    first = provenance.code("workflow/scripts/report.py")
    assert first == provenance.code("workflow/scripts/report.py")
    assert first != provenance.code("workflow/scripts/report.py", "workflow/report/captions/design.rst")


def test_versions_name_every_named_package() -> None:
    assert set(provenance.versions()) == {"python", *provenance.PACKAGES}
