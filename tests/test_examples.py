"""Whatever the code shows of its use runs and says what is printed there; public docstrings name every parameter."""

import doctest
import importlib
import inspect
import re
import runpy
import sys
from collections.abc import Iterator
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

PUBLIC = [getattr(room, name) for room in (solver, surrogate) for name in room.__all__]
STORED = {"state", "restore", "make_factor", "members"}  # for `save` and `load`
TRAINED = {"blocks", "whole"}  # for the pipeline, which trains in pieces
ROUNDED = {"allowed", "followed", "witnesses", "described"}  # for `surrogate.use.export`
#: Methods that models and transforms give each other: a sentence each, with the shapes.
BETWEEN_MODELS = {
    "all_mean_std", "mean_std", "means", "calibrated_at", "variance", "physical_slopes", "unit_slopes", "physical",
    "slope_stds", "checked_level", "mean_variance", "slopes", "slope_variances", "parts", "corrected", "over",
    "calibrate_under",
}  # fmt: skip
INNER = {"Grouping"}  # its methods are for GroupedGP


def shown(*objects: object) -> str:
    """The lines of examples in docstrings."""
    text = "\n".join(map(str, map(inspect.getdoc, objects)))
    return "\n".join(re.findall(r"^\s*(?:>>>|\.\.\.) (.*)", text, re.MULTILINE))


@pytest.mark.parametrize("thing", PUBLIC, ids=lambda thing: getattr(thing, "__name__", ""))
def test_everything_public_is_shown_in_an_example(thing: Any) -> None:
    """A function by its own docstring, a class by one of a class, a method by its own or by one of its classes."""
    if not inspect.isclass(thing):
        assert thing.__name__ in shown(thing)
    elif not issubclass(thing, Exception):
        assert thing.__name__ in shown(*filter(inspect.isclass, PUBLIC))
        family = [owner for owner in thing.__mro__ if owner.__module__.startswith(("solver", "surrogate"))]
        names = {name for owner in family for name in vars(owner) if name.strip("_") == name}
        for name in names - STORED - TRAINED - ROUNDED - BETWEEN_MODELS:
            member = inspect.getattr_static(thing, name)
            if thing.__name__ not in INNER and (callable(member) or isinstance(member, property | classmethod)):
                assert re.search(rf"\b{name}\b", shown(*family, getattr(thing, name, None), member)), name


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
    assert len(script.read_text(encoding="utf-8").splitlines()) < 40
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


def public_functions() -> Iterator[tuple[str, object]]:
    """Functions of `__all__`, and the public methods that their classes define in this project."""
    for room in (solver, surrogate):
        for name in room.__all__:
            thing = getattr(room, name)
            if not inspect.isclass(thing):
                yield name, thing
                continue
            for base in thing.__mro__:
                if base.__module__.partition(".")[0] in ("solver", "surrogate") and name not in INNER:
                    for method, member in vars(base).items():
                        function = getattr(member, "__func__", member)
                        overridden = getattr(member, "__override__", False) or getattr(function, "__override__", False)
                        inner = method.startswith("_") or method in STORED | BETWEEN_MODELS
                        if inspect.isfunction(function) and not inner and not overridden:
                            yield f"{base.__name__}.{method}", function


def arguments(function: object) -> set[str]:
    """Names that a caller passes; an underscore opens those that are ignored."""
    assert callable(function)
    return {name for name in inspect.signature(function).parameters if not name.startswith("_")} - {"self", "cls"}


def documented(docstring: str) -> set[str]:
    """Names in front of the colon on the section's lines that are not indented."""
    section = SECTION.search(docstring)
    lines = re.findall(r"^\S.*", section[1], re.MULTILINE) if section else []
    return {name.strip(" *") for line in lines for name in line.split(" :")[0].split(",")}


def test_public_functions_document_every_parameter() -> None:
    functions = dict(public_functions())
    assert len(functions) > 40
    wrong = {}
    for name, function in functions.items():
        expected = arguments(function)
        if len(expected) > 1 and documented(inspect.getdoc(function) or "") != expected:
            wrong[name] = sorted(expected)
    assert wrong == {}
