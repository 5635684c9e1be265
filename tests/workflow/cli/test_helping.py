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
def test_every_command_has_an_example_that_it_takes(name: str, command: Command) -> None:
    module, _, function = main._parser().parse_args(example(name, command)).function.partition(".")
    assert callable(getattr(import_module(f"workflow.cli.{module}"), function))


@pytest.mark.parametrize("name", ["list", "material", "solve"])
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    assert command(*example(name, command))[0]


@pytest.mark.slow
def test_the_help_solves_nothing_and_a_case_fits_nothing(tmp_path: Path) -> None:
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
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    assert [line for line in done.stderr.split("\n") if not line.startswith(("wrote", "left out", "empty"))] == [""] * 4


def example(name: str, command: Command) -> list[str]:
    """The words of the example below a command's help."""
    program, *words = shlex.split(command(name, "--help")[0].split("example:\n")[1].replace("\\\n", " "))
    assert (program, words[0]) == ("meecontact", name)
    return words


def test_no_name_of_a_command_stands_alone_on_its_line(command: Command) -> None:
    lines = command()[0].splitlines()
    for name in COMMANDS:
        assert any(len(line.split()) > 2 and line.split()[0] == name for line in lines), name
