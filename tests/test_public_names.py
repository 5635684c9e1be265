"""The public names of the rooms, which are imported when they are first used."""

import sys
from importlib import import_module
from pathlib import Path
from subprocess import run

import pytest


@pytest.mark.parametrize("room", ["solver", "surrogate"])
def test_every_public_name_is_there_and_no_other(room: str) -> None:
    module = import_module(room)
    assert all(getattr(module, name).__module__.startswith((f"{room}.", "storage.")) for name in module.__all__)
    code = f"import {room}; assert dir({room}) == sorted({room}.__all__), dir({room})"
    assert run([sys.executable, "-c", code], check=False).returncode == 0
    with pytest.raises(AttributeError, match="has no attribute 'solved'"):
        module.solved  # noqa: B018


def test_names_of_quantities_are_had_without_the_solution() -> None:
    code = "import solver.names, sys; sys.exit('scipy' in sys.modules or 'numpy' in sys.modules)"
    assert run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_module_of_another_under_a_room_s_name_is_named(tmp_path: Path) -> None:
    (tmp_path / "solver.py").write_text("", encoding="utf-8")
    done = run([sys.executable, "-c", "import meecontact"], check=False, cwd=tmp_path, capture_output=True, text=True)
    last = done.stderr.splitlines()[-1]
    assert last.startswith(
        f"ImportError: meecontact: the module 'solver' that Python finds is {tmp_path / 'solver.py'}"
    )
