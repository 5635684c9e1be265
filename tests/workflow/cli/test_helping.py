"""Help of every command: an example that the command itself takes."""

import shlex
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from tests.programs import Command
from workflow.cli import main
from workflow.cli.main import COMMANDS
from workflow.run.provenance import ROOT


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_an_example_that_it_takes(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    program, *words = shlex.split(command(name, "--help")[0].split("example:\n")[1].replace("\\\n", " "))
    assert (program, words[0]) == ("meecontact", name)
    module, _, function = main._parser().parse_args(words).function.partition(".")
    assert callable(getattr(import_module(f"workflow.cli.{module}"), function))
    assert any(line.split()[:1] == [name] and len(line.split()) > 2 for line in command()[0].splitlines())
    if name in ("list", "material", "solve"):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "examples").symlink_to(ROOT / "examples")
        assert command(*words)[0]


@pytest.mark.slow
def test_no_command_loads_what_it_does_not_need(tmp_path: Path) -> None:
    program = f"""
import contextlib, sys
from workflow.cli.main import main
def loaded(*names): print(*[name for name in names if name in sys.modules], file=sys.stderr)
with contextlib.suppress(SystemExit):
    main(["--help"])
loaded("numpy", "pydantic")
main(["solve", "examples/cases.csv", "-o", {str(tmp_path / "out.nc")!r}])
loaded("pydantic", "surrogate", "scipy.linalg", "scipy.optimize")
import workflow.cli.query, surrogate.gp.gridgp
loaded("pydantic", "sklearn", "scipy.linalg", "scipy.optimize", "workflow.study.model")
import workflow.dataset.slabs, workflow.dataset.datacard, workflow.cli.launch
loaded("sklearn", "matplotlib", "jinja2", "scipy.stats")
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    assert [line for line in done.stderr.split("\n") if not line.startswith(("wrote", "left out", "empty"))] == [""] * 5
