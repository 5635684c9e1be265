"""What people write: YAML files (safe, with YAML 1.2 numbers, no key twice), numbers, and how it is shown again."""

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from solver import Material, MaterialError
from workflow.files import regular

_LARGEST = 1 << 20  # bytes; a study or a material is a few kB
_DEEPEST = (
    40  # brackets or indents within each other; a study needs five, and the reader's time grows with their square
)


class InputError(ValueError):
    """Bad input, in one line that names file, key, value and what is allowed."""


def one_line(message: str) -> str:
    """A message as one line of at most 1000 characters; what came from a hostile file cannot command the terminal."""
    shown = "".join(one if one.isprintable() else one.encode("unicode_escape").decode("ascii") for one in message)
    return shown if len(shown) <= 1000 else f"{shown[:600]} ... {shown[-300:]}"


def number(text: str) -> float:
    """A decimal number in plain digits, inf or nan; ValueError for any other text, such as 1_000 or Arabic digits.

    Examples
    --------
    >>> number(" 1e5")
    100000.0
    """
    if not text.isascii() or "_" in text:
        raise ValueError(f"{text!r} is not a number")
    return float(text)


class _Loader(yaml.SafeLoader):
    def fetch_flow_collection_start(self, kind: type[yaml.Token]) -> None:
        self._check_depth(self.flow_level)
        super().fetch_flow_collection_start(kind)

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


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?$|^[-+]?\.(?:inf|Inf|INF)$|^\.(?:nan|NaN|NAN)$"),
    list("-+.0123456789"),
)


def read_yaml(path: Path) -> dict[str, Any]:
    """The mapping in a YAML file.

    Raises
    ------
    InputError
        Missing, unreadable, oversized or malformed file, or not a mapping.
    """
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
        raise InputError(f"{path}:{where} not valid YAML: {reason}") from None
    if not isinstance(content, dict) or not all(isinstance(key, str) for key in content):
        raise InputError(f"{path}: not a mapping of names to values")
    return content


def read_material(path: Path) -> tuple[str, Material]:
    """Name and constants of a user's material file.

    Raises
    ------
    InputError
        One line that names file, constant, value and what is allowed.
    """
    content = read_yaml(path)
    try:
        material = Material.from_mapping({"name": path.stem, **content})
    except MaterialError as error:
        raise InputError(f"{path}: {error}") from None
    return material.name, material
