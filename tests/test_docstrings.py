"""Docstrings say what every parameter is: one section a function, whose names are those of its arguments."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from workflow.run.provenance import ROOT

ROOMS = (
    "approximation",
    "storage",
    "solver",
    "surrogate",
    "workflow",
    "verification",
    "benchmarks",
    "docs",
    "examples",
)
SECTION = re.compile(r"^Parameters\n-{10}\n(.*?)(?=\n\n|\Z)", re.MULTILINE | re.DOTALL)


def public(scope: ast.Module | ast.ClassDef) -> Iterator[ast.FunctionDef]:
    """Functions and methods without an underscore, and not inside another function; of overloads the whole one.

    An override has the section of what it overrides.
    """
    for node in scope.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public(node)
        elif isinstance(node, ast.FunctionDef) and not (node.name.startswith("_") or marked(node)):
            yield node


def marked(function: ast.FunctionDef) -> bool:
    return any(isinstance(mark, ast.Name) and mark.id in ("overload", "override") for mark in function.decorator_list)


def arguments(function: ast.FunctionDef) -> set[str]:
    """Names of what a caller gives; an underscore begins those that are taken and not used."""
    given = function.args
    named = [*given.posonlyargs, *given.args, *given.kwonlyargs, *filter(None, [given.vararg, given.kwarg])]
    return {argument.arg for argument in named if not argument.arg.startswith("_")} - {"self", "cls"}


def documented(docstring: str) -> set[str]:
    """Names before the colon, or alone on a line, of the section's lines that are not indented."""
    found = SECTION.search(docstring)
    lines = re.findall(r"^\S.*", found[1], re.MULTILINE) if found else []
    return {name.strip(" *") for line in lines for name in line.split(" :")[0].split(",")}


def of_module(path: Path) -> Iterator[str]:
    for function in public(ast.parse(path.read_text(encoding="utf-8"))):
        asked = arguments(function)
        if len(asked) > 1 and documented(ast.get_docstring(function) or "") != asked:
            yield f"{path.relative_to(ROOT)}:{function.lineno} {function.name}: {', '.join(sorted(asked))}"


def test_a_section_says_what_every_parameter_is() -> None:
    modules = [path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))]
    assert len(modules) > 400
    assert [found for path in modules for found in of_module(path)] == []


def test_a_section_that_lacks_a_name_or_has_another_is_found() -> None:
    whole = "One.\n\nParameters\n----------\na, b : float, m\nmany\n    Of them.\n\nReturns\n-------\nc : int"
    assert documented(whole) == {"a", "b", "many"}
    function = ast.parse("def f(self, a, *many, b=1): ...").body[0]
    assert isinstance(function, ast.FunctionDef)
    assert arguments(function) == documented(whole)
    assert documented("One.") == set()
