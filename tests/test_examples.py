"""Public names are there and documented; what the code shows of its use runs and prints what it says."""

import doctest
import importlib
import inspect
import re
import runpy
import sys
from pathlib import Path
from subprocess import run
from types import SimpleNamespace
from typing import Any

import pytest
import xarray as xr

import solver
import surrogate
from workflow.run.provenance import ROOT

SHOWING = [
    ".".join(file.relative_to(ROOT).with_suffix("").parts)
    for room in ("meecontact", "approximation", "storage", "solver", "surrogate", "workflow", "verification")
    for file in sorted((ROOT / room).rglob("*.py"))
    if ">>> " in file.read_text(encoding="utf-8")
]

SERVER = ROOT / "examples/umbridge_server.py"  # needs a package that is not installed
SCRIPTS = sorted({*(ROOT / "examples").glob("*.py")} - {SERVER})
#: Left to `make soak`; `make test` asks as much in workflow/design/test_search.py, solver/face/test_films.py
#: and surrogate/intervals/.
LONG = {"design.py", "film_voltage.py", "graded_film.py", "intervals.py"}
GALLERY = (ROOT / "docs/gallery.md").read_text(encoding="utf-8").split("\n### ")
NUMBER = r"\d+\.\d+(?:e[+-]\d+)?"
#: Numbers of the gallery that a script is asked, or that follow from what it prints.
NOT_PRINTED = {"benchmark_elements.py": {"0.05"}, "film_pressure.py": {"0.2", "0.04"}, "inversion.py": {"0.1"}}


@pytest.mark.parametrize("module", SHOWING)
def test_examples_of_docstrings_print_what_they_say(module: str) -> None:
    assert doctest.testmod(importlib.import_module(module)).failed == 0


@pytest.mark.parametrize(
    "script",
    [pytest.param(script, marks=pytest.mark.soak) if script.name in LONG else script for script in SCRIPTS],
    ids=lambda script: script.name,
)
def test_a_script_prints_the_numbers_and_draws_the_figures_of_the_gallery(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (entry,) = (entry for entry in GALLERY if f"\n[`examples/{script.name}`](../examples/{script.name})" in entry)
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script))
    printed = capsys.readouterr().out + script.read_text(encoding="utf-8")
    numbers = set(re.findall(NUMBER, entry)) - NOT_PRINTED.get(script.name, set())
    assert numbers <= set(re.findall(NUMBER, printed))
    assert {figure.name for figure in tmp_path.glob("*.svg")} == set(re.findall(r"\]\(([\w-]+\.svg)\)", entry))


def test_the_umbridge_example_serves_values_and_derivatives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stand-in for the package: the base class, and a server that keeps the models."""
    served: list[Any] = []

    class Model:
        def __init__(self, name: str) -> None:
            self.name = name

    package = SimpleNamespace(Model=Model, serve_models=lambda models, port: served.extend(models))
    x, y = surrogate.Input("x", 1.0, 2.0), surrogate.Input("y", 0.0, 1.0)
    grid = xr.Dataset(coords={"x": x.levels(5), "y": y.levels(4)})
    surrogate.save(surrogate.GridGP([x, y]).fit(grid.assign(f=grid.x * grid.y, g=grid.x**2)), tmp_path / "model.nc")
    monkeypatch.setitem(sys.modules, "umbridge", package)
    monkeypatch.setattr(sys, "argv", ["server", str(tmp_path / "model.nc")])
    runpy.run_path(str(SERVER))
    (model,) = served
    assert (model.get_input_sizes({}), model.get_output_sizes({})) == ([2], [2])
    assert model([[1.5, 0.5]], {})[0] == pytest.approx([0.75, 2.25], rel=1e-6)
    assert model.apply_jacobian(0, 0, [[1.5, 0.5]], [1.0, 0.0], {}) == pytest.approx([0.5, 3.0], rel=1e-4)


SECTION = re.compile(r"^Parameters\n-{10}\n(.*?)(?=\n\n|\Z)", re.MULTILINE | re.DOTALL)


def parameters(docstring: str) -> set[str]:
    """Names in front of the colon on the section's lines that are not indented."""
    section = SECTION.search(docstring)
    lines = re.findall(r"^\S.*", section[1], re.MULTILINE) if section else []
    return {name.strip(" *") for line in lines for name in line.split(" :")[0].split(",")}


def public(thing: Any) -> list[Any]:
    """Return a public function, or the public methods that a public class has from this project."""
    if not inspect.isclass(thing):
        return [thing]
    methods = inspect.getmembers(thing, lambda member: inspect.isfunction(member) or inspect.ismethod(member))
    return [method for name, method in methods if name[0] != "_" and method.__module__.startswith(("solver", "surr"))]


@pytest.mark.parametrize("room", [solver, surrogate])
def test_public_docstrings_list_the_parameters_that_exist(room: Any) -> None:
    for thing in (getattr(room, name) for name in room.__all__):
        for function in public(thing):
            taken = {name for name in inspect.signature(function).parameters if name[0] != "_"} - {"self"}
            listed = parameters(inspect.getdoc(function) or "")
            assert listed == taken or (not listed and (inspect.isclass(thing) or len(taken) < 2)), function


@pytest.mark.parametrize("room", ["solver", "surrogate"])
def test_every_public_name_is_there_and_no_other(room: str) -> None:
    module = importlib.import_module(room)
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
