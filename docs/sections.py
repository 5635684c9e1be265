"""How the site reads Parameters sections that have a line each: type and shape first, then the meaning."""

import re

from griffe import Extension, Object

_SECTION = re.compile(r"(?<=Parameters\n----------\n).*?(?=\n\n|\Z)", re.DOTALL)
_LINE = re.compile(r"^(?P<names>\w+(?:, \w+)*) : (?P<said>.*)$", re.MULTILINE)
#: Up to a comma that no bracket holds.
_PART = re.compile(r"(?:[^,(\[]|\([^)]*\)|\[[^]]*\])+")


def spread(docstring: str) -> str:
    """A docstring whose lines ``name : type, shape, meaning`` have their meaning on a line of its own."""
    return _SECTION.sub(lambda section: _LINE.sub(_two_lines, section[0]), docstring)


def _two_lines(line: re.Match[str]) -> str:
    """A type a name, and the shape, are the head."""
    parts = [part.strip() for part in _PART.findall(line["said"])]
    heads = line["names"].count(",") + 1
    heads += len(parts) > heads and parts[heads].startswith("shape")
    if len(parts) <= heads:
        return line[0]
    return f"{line['names']} : {', '.join(parts[:heads])}\n    {', '.join(parts[heads:])}"


class Sections(Extension):
    """Spreads every docstring of the site."""

    def on_object(self, *, obj: Object, **_: object) -> None:
        """Spread one object's."""
        if obj.docstring:
            obj.docstring.value = spread(obj.docstring.value)
