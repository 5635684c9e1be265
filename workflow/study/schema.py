"""The study's JSON schema and documented default; ``python -m workflow.study.schema`` writes both from the model."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import to_jsonable_python

from storage.files import write_text
from workflow.study.model import Study
from workflow.study.reading import models_in

SCHEMA = Path("config/schema/study.schema.json")
DEFAULT = Path("config/schema/default.yaml")


def schema_text() -> str:
    """Return the JSON schema of a study."""
    return json.dumps(Study.model_json_schema(), indent=2) + "\n"


def default_text() -> str:
    """Return every key of a study with its meaning and default, as YAML."""
    head = (
        "# Every key of a study with its meaning and default. Written from the model by `make schema`; do not edit.\n"
    )
    return head + "\n".join(_documented(Study, "")) + "\n"


def write() -> None:
    """Write both files."""
    SCHEMA.parent.mkdir(parents=True, exist_ok=True)
    write_text(SCHEMA, schema_text())
    write_text(DEFAULT, default_text())


def _documented(model: type[BaseModel], indent: str) -> Iterator[str]:
    for name, field in model.model_fields.items():
        yield f"{indent}# {field.description}"
        inner = next(iter(models_in(field.annotation)), None)
        if field.annotation is inner and inner is not None:
            yield f"{indent}{name}:"
            yield from _documented(inner, indent + "  ")
            continue
        yield f"{indent}{name}: {_value(field)}"
        if inner is not None:  # named entries, or an optional part: what it would hold
            yield f"{indent}#   {'each entry' if get_origin(field.annotation) in (dict, list) else 'its keys'}:"
            yield from (
                f"{indent}#     {key}: {_value(field)} - {field.description}"
                for key, field in inner.model_fields.items()
            )


def _value(field: FieldInfo) -> str:
    if field.is_required():
        return "(required)"
    return json.dumps(to_jsonable_python(field.get_default(call_default_factory=True)))


if __name__ == "__main__":
    write()
