"""Docstrings of the public API name every parameter: one section a function, whose names are those of its arguments."""

import inspect
import re
from collections.abc import Iterator

import solver
import surrogate

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
                if base.__module__.partition(".")[0] in ("solver", "surrogate"):
                    for method, member in vars(base).items():
                        function = getattr(member, "__func__", member)
                        overridden = getattr(member, "__override__", False) or getattr(function, "__override__", False)
                        if inspect.isfunction(function) and not method.startswith("_") and not overridden:
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
