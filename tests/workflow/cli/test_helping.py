"""Help and printed words: every command has an example that it takes, and any terminal can print it."""

import contextlib
import io
import os
import shlex
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from solver import units
from solver.material.constants import UNITS
from tests.programs import Command
from workflow.cli import main
from workflow.cli.main import COMMANDS
from workflow.cli.words import printable_streams
from workflow.language.numbers import shown
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


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
@pytest.mark.parametrize("command", [["material"], ["material", "PZT-4"], ["list"], ["--help"], ["list", "µ⁻¹ Ω – π"]])
def test_any_terminal_can_print_any_command(encoding: str, command: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    streams = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]
    for name, stream in zip(("stdout", "stderr"), streams, strict=True):
        monkeypatch.setattr(sys, name, stream)
    with contextlib.suppress(SystemExit):
        main.main(command)
    for stream in streams:
        stream.flush()
        assert b"?" not in stream.buffer.getvalue().replace(b"?\n", b"").replace(b"? ", b"")


def test_messages_that_nobody_reads_stop_no_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cases, answer = tmp_path / "cases.csv", tmp_path / "answer.csv"
    cases.write_text("material,profile,radius,force\nPZT-4,sphere,5 mm,1 N\n", encoding="utf-8")
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w", encoding="utf-8") as stream:
        monkeypatch.setattr(sys, "stderr", stream)
        assert main.main(["solve", str(cases), "-o", str(answer)]) == 0
        monkeypatch.undo()
    assert answer.read_text(encoding="utf-8").count("\n") == 2


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_numbers_are_read_as_they_are_printed(encoding: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for unit in {*UNITS.values(), "V m N-1", "N m-1", "Ohm m", "F"}:
        for value in (-1.234e-12, 5.6e-5, 0.789, 4.2e3, 1.39e11):
            stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
            monkeypatch.setattr(sys, "stdout", stream)
            printable_streams()
            print(shown(value, unit))
            stream.flush()
            printed = stream.buffer.getvalue().decode(encoding).strip()
            read = units.in_si(printed, unit) if not printed[-1].isdigit() or unit != "1" else float(printed)
            np.testing.assert_allclose(read, value, rtol=1e-4, err_msg=printed)


def test_temperatures_in_celsius_are_absolute() -> None:
    assert units.in_si("33 degC", "K") == units.in_si("33°C", "K") == 306.15
    assert units.in_si("-12.5 ℃", "K") == 260.65
    with pytest.raises(ValueError, match="'degC' is not a unit"):
        units.in_si("33 degC", "W m-1 K-1")
