"""Readers of YAML files (safe, YAML 1.2 numbers, no key twice) and of numbers; a study's first error in one line."""

import re
import unicodedata
from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import yaml

from solver.units import plain
from storage.files import regular
from workflow.language.spelling import nearest

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError

    from solver import Material

_LARGEST = 1 << 20  # bytes; a study or a material is a few kB
_DEEPEST = 40  # nested brackets or indents; a study needs five, and the reader's time grows with their square
_MOST_DIGITS = 40  # of an integer; a number of thousands of digits is no input, and breaks what formats it
_INTEGER = re.compile(r"[-+]?(?:0|[1-9][0-9]*)")
_FLOAT = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
# letters for names of files, figures and attributes: no $, which begins a formula in figures
_MATERIAL_NAME = re.compile(r"[\w(][\w ()+.,:/%-]{0,59}")
#: Keys of former releases: section and name.
_REMOVED = {
    ("factors", "kinks"),
    ("factors", "grown_from"),
    ("surrogate", "budget"),
    ("surrogate", "until"),
    ("surrogate", "kernel"),
}
_COLON = "a colon and a blank within a text; write the text in quotes"
_NOT_OF_TYPE = ("list_type", "dict_type", "string_type")


class InputError(ValueError):
    """Bad input, in one line that names file, key, value and what is allowed."""


@contextmanager
def located(where: object, refusal: type[Exception] | tuple[type[Exception], ...] = ValueError) -> Iterator[None]:
    """Raise a refusal as InputError that opens with its place."""
    try:
        yield
    except refusal as error:
        raise InputError(f"{where}: {error}") from None


def one_line(message: str) -> str:
    """Return a message as one line of at most 1000 characters, without characters that command a terminal."""
    shown = "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode("ascii") for letter in message
    )
    return shown if len(shown) <= 1000 else f"{shown[:600]} ... {shown[-300:]}"


def number(text: str) -> float:
    """Read a decimal number, inf or nan; ValueError for any other text, as 1_000 or Arabic digits."""
    ascii_text = plain(text)
    if not ascii_text.strip().isascii() or "_" in ascii_text:
        raise ValueError(f"{text!r} is not a number")
    return float(ascii_text)


class _Loader(yaml.SafeLoader):
    def fetch_flow_collection_start(self, kind: type[yaml.Token]) -> None:
        self._check_depth(self.flow_level)
        super().fetch_flow_collection_start(kind)

    def fetch_tag(self) -> None:  # `!!int ''`: a text forced to be what it is not
        raise yaml.scanner.ScannerError(None, None, "tags, as !!int, are not allowed", self.get_mark())

    def add_indent(self, column: int) -> bool:
        self._check_depth(len(self.indents))
        return super().add_indent(column)

    def _check_depth(self, depth: int) -> None:
        if depth > _DEEPEST:
            raise yaml.scanner.ScannerError(None, None, "nested too deeply", self.get_mark())

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable) or key in seen:
                raise yaml.constructor.ConstructorError(None, None, f"key {key!r} is given twice", key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep)

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):  # nested aliases grow without bound
            raise yaml.composer.ComposerError(None, None, "aliases are not allowed", None)
        return super().compose_node(parent, index)

    def decimal(self, node: yaml.ScalarNode) -> int | float:
        """Read a decimal number: YAML 1.1 takes 010 for 8, 1:30 for 90, 0b11 for 3 and 1_0 for 10."""
        text = node.value
        if _INTEGER.fullmatch(text):
            if len(text) > _MOST_DIGITS:
                reason = f"a number of {len(text)} digits; at most {_MOST_DIGITS}, or write it as 1e{len(text) - 1}"
                raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark)
            return int(text)
        if not _FLOAT.fullmatch(text) or text.lstrip("+-").isdigit():
            reason = f"{text[:_MOST_DIGITS]!r} is not a decimal number; in quotes it is a text"
            raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark)
        return super().construct_yaml_float(node)

    def text(self, node: yaml.ScalarNode) -> str:
        """Read a text; refuse halves of surrogate pairs, and characters that command a terminal."""
        text = super().construct_yaml_str(node)
        bad = next(
            (letter for letter in text if unicodedata.category(letter) in ("Cs", "Cc") and letter not in "\n\t"), None
        )
        if bad is not None:
            reason = f"a text must not hold the character {bad!r}"
            raise yaml.constructor.ConstructorError(None, None, reason, node.start_mark)
        return str(text)


_Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(f"^(?:{_FLOAT.pattern})$"), list("-+.0123456789"))
for _tag in ("int", "float"):
    _Loader.add_constructor(f"tag:yaml.org,2002:{_tag}", _Loader.decimal)
_Loader.add_constructor("tag:yaml.org,2002:str", _Loader.text)


def read_yaml(path: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file."""
    try:
        with regular(path).open("rb") as file:
            raw = file.read(_LARGEST + 1)
        if len(raw) > _LARGEST:
            raise InputError(f"{path}: larger than {_LARGEST} bytes")
        content = _Loader(raw.decode("utf-8")).get_single_data()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a UTF-8 text") from None
    except RecursionError:
        raise InputError(f"{path}: nested too deeply") from None
    except (yaml.YAMLError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        where = f" line {mark.line + 1}:" if mark else ""
        reason = getattr(error, "problem", None) or str(error).splitlines()[0]
        reason = _COLON if reason == "mapping values are not allowed here" else reason
        raise InputError(f"{path}:{where} not valid YAML: {reason}") from None
    if not isinstance(content, dict) or not all(isinstance(key, str) for key in content):
        raise InputError(f"{path}: not a mapping of names to values")
    return content


def read_material(path: Path) -> "tuple[str, Material]":
    """Name and constants of a user's material file: numbers in SI, or with a unit, as ``c11: 115 GPa``.

    Raises
    ------
    InputError
        One line that names file, constant, value and what is allowed.
    """
    from solver import Material, MaterialError

    content = {"name": path.stem, **read_yaml(path)}
    try:
        material = Material.from_mapping(content)
    except MaterialError as error:
        raise InputError(f"{path}: {error}") from None
    if not _MATERIAL_NAME.fullmatch(material.name):
        raise InputError(
            f"{path}: name: {material.name[:80]!r} must be up to 60 letters, digits, blanks and any of _()+.,:/%-"
        )
    return material.name, material


def first_problem(error: "ValidationError", model: "type[BaseModel]", content: Mapping[str, Any]) -> str:
    """Return the first finding of pydantic as ``key: value: what is allowed``."""
    findings = error.errors()
    # an unknown key comes before the key that is missing for it
    finding = next((finding for finding in findings if finding["type"] == "extra_forbidden"), None)
    # a fault within a list or a mapping says more than the branch of a union that it does not fit
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
    if finding["type"] == "model_type":
        return f"{where}: {finding['input']!r}: must be a mapping of {', '.join(_keys_at(model, place))}"
    return f"{where}: {finding['input']!r}: {message[0].lower()}{message[1:]}"


def _written(loc: tuple[int | str, ...], content: Any) -> list[str]:
    """Return the part of a location that is in the file: pydantic adds the branches of its unions."""
    place: list[str] = []
    for part in loc:
        try:
            content = content[part]
        except (LookupError, TypeError):
            continue
        place.append(str(part))
    return place


def _keys_at(model: "type[BaseModel]", place: list[str]) -> list[str]:
    """Return the names of fields that a model allows at a place in the file, in any branch of a union."""
    models = [model]
    for part in place:  # the name of a field, or of an entry of a mapping or list
        fields = [(known, known.model_fields.get(part)) for known in models]
        models = [inner for known, field in fields for inner in (models_in(field.annotation) if field else [known])]
    return [name for known in models for name in known.model_fields]


def models_in(annotation: Any) -> "list[type[BaseModel]]":
    """Return the models in an annotation: itself, entries of a mapping or list, or members of a union."""
    if isinstance(annotation, type) and hasattr(annotation, "model_fields"):
        return [annotation]
    return [model for part in get_args(annotation) for model in models_in(part)]
