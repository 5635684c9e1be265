"""The first error of a study, in one line."""

from collections.abc import Mapping
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from workflow.language.spelling import nearest

#: Keys of former releases: section and name.
_REMOVED = {
    ("factors", "kinks"),
    ("factors", "grown_from"),
    ("surrogate", "budget"),
    ("surrogate", "until"),
    ("surrogate", "kernel"),
}
_NOT_OF_TYPE = ("list_type", "dict_type", "string_type")


def first_problem(error: ValidationError, model: type[BaseModel], content: Mapping[str, Any]) -> str:
    """The first finding of pydantic as ``key: value: what is allowed``."""
    findings = error.errors()
    # an unknown key is named before what is missing for it
    finding = next((finding for finding in findings if finding["type"] == "extra_forbidden"), None)
    # of a list or a mapping, what is wrong within it says more than that it is not the other
    finding = finding or next((finding for finding in findings if finding["type"] not in _NOT_OF_TYPE), findings[0])
    place = _written(finding["loc"], content)
    where = ".".join(place)
    message = finding["msg"].removeprefix("Value error, ")
    if finding["type"] == "extra_forbidden" and (place[0], place[-1]) in _REMOVED:
        return f"{where}: was removed in 0.3.0; leave it out"
    if finding["type"] == "extra_forbidden":
        return f"{where}: unknown key; {nearest(place[-1], _keys_at(model, place[:-1]))}"
    if finding["type"] == "missing":
        return f"{'.'.join([*place, str(finding['loc'][-1])])}: missing"
    if finding["type"] == "value_error":
        return f"{where}: {message}" if where else message
    return f"{where}: {finding['input']!r}: {message[0].lower()}{message[1:]}"


def _written(loc: tuple[int | str, ...], content: Any) -> list[str]:
    """The part of a location that stands in the file: pydantic adds the branches of its unions."""
    place: list[str] = []
    for part in loc:
        try:
            content = content[part]
        except (LookupError, TypeError):
            continue
        place.append(str(part))
    return place


def _keys_at(model: type[BaseModel], place: list[str]) -> list[str]:
    """Names of the fields that a model allows at a place in the file, whichever branch of a union it is in."""
    nodes: list[Any] = [model]
    for part in place:
        nodes = [inner for node in nodes for inner in _within(node, part)]
    return [name for node in nodes if _is_model(node) for name in node.model_fields]


def _within(node: Any, part: str) -> list[Any]:
    """Types that a type may hold under a key or an index."""
    if _is_model(node):
        return _branches(node.model_fields[part].annotation) if part in node.model_fields else []
    return _branches(get_args(node)[-1]) if get_origin(node) in (dict, list) else []


def _branches(node: Any) -> list[Any]:
    """A type without what only annotates it; each one of a union."""
    if get_origin(node) is Annotated:
        return _branches(get_args(node)[0])
    if get_origin(node) in (Union, UnionType):
        return [branch for arg in get_args(node) for branch in _branches(arg)]
    return [node]


def _is_model(node: object) -> bool:
    return isinstance(node, type) and issubclass(node, BaseModel)
