"""Whatever the code shows of its use runs and prints what it says; public docstrings list the parameters."""

import doctest
import importlib
import inspect
import re
import runpy
import sys
from pathlib import Path
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

#: One line of what each script prints, a number in it.
SAID = {
    "benchmark_elements.py": "disc-layer,contact_stiffness,1.1468e+09",
    "design.py": "abs(voltage_per_load): exact 0.051077",
    "fields_inside.py": "largest on the grid: 178.8 MPa at x = -1.00 h, y = -0.05 h",
    "film_interface.py": "0.2 mm: shear 105.8 MPa at X = -0.90, tension 6.42 MPa at X = 2.28",
    "film_on_steel.py": "charge per load of 0.5 mm over that of the half-plane: 0.6879",
    "film_pressure.py": "largest pressure [MPa]: 316.8, 383.1, 647.3",
    "film_voltage.py": "rigid: most charge, 47.66 pC/N, at 0.22 mm",
    "graded_film.py": "20% to 80%: largest pressure 385.1 MPa, 40.46 pC/N",
    "half_plane.py": "half-width 166.1 um, 1.000000000000 times that of Hertz",
    "intervals.py": "95% intervals hold a share of 0.97 of 3,000 fresh cases",
    "inversion.py": "load: 2e+04 [1.996e+04, 2.004e+04], true 20000",
    "own_material.py": "my PZT: 427.9 pC/N, -48.30 mV m/N",
    "own_punch.py": "quartic: largest pressure 169.3 MPa at |X| = 0.71",
    "peaks.py": "friction 0.4: von Mises 200.4 MPa at 0.027 mm, tension 58.0 MPa",
    "scikit_learn.py": "GridGP, 432 cases: largest error 3.0e-05 of range",
    "sobol_indices.py": "volume_fraction 0.325 0.001",
    "surrogate_query.py": "voltage -527.5683 V, exact -527.5681 V; -50.116 mV for another N/m",
    "volume_fraction.py": "fibrous: most volts per load, 52.04 mV m/N, with 66 % of BaTiO3",
}
SERVER = ROOT / "examples/umbridge_server.py"  # needs a package that is not installed
SCRIPTS = sorted({*(ROOT / "examples").glob("*.py")} - {SERVER})
#: Left to `make soak`; what they ask: workflow/design/test_search.py, solver/face/test_films.py, surrogate/intervals/,
#: solver/line/test_grading.py.
LONG = {"design.py", "film_voltage.py", "graded_film.py", "intervals.py"}
GALLERY = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("module", SHOWING)
def test_examples_of_docstrings_print_what_they_say(module: str) -> None:
    assert doctest.testmod(importlib.import_module(module)).failed == 0


@pytest.mark.parametrize(
    "script",
    [pytest.param(script, marks=pytest.mark.soak) if script.name in LONG else script for script in SCRIPTS],
    ids=lambda script: script.name,
)
def test_a_script_says_its_number_and_draws_what_the_gallery_shows(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script))
    printed = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert SAID[script.name] in printed
    assert f"](../examples/{script.name})" in GALLERY
    # some number of what it says stands in the gallery; below a figure all of them do
    numbers = re.findall(r"\d+\.\d+(?:e[+-]\d+)?", SAID[script.name])
    assert any(number in GALLERY for number in numbers)
    for drawn in tmp_path.glob("*.svg"):
        assert f"({drawn.name})" in GALLERY
        assert all(number in GALLERY for number in numbers)


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
