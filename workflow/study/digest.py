"""Hashes of parts of a study, by which results know what they were made from."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

from workflow.study.keys import Keys

#: Sections that decide what a case is and what the solver answers.
PHYSICS = ("phases", "materials", "fixed", "factors", "categories", "body", "groups")
#: The same without the numbers of levels, for `digest`.
BOX = "box"


def digest(study: Keys, sections: Sequence[str], materials: Mapping[str, Any]) -> str:
    """Hash of some sections of a study, see `Contents.digest`."""
    whole = [name for section in sections for name in (PHYSICS if section == BOX else (section.partition(".")[0],))]
    content = study.model_dump(mode="json", include=set(whole))
    parts = {name: content[name.partition(".")[0]].get(name.partition(".")[2]) for name in sections if "." in name}
    content = {
        name: section for name, section in content.items() if name in {*sections, *(PHYSICS if BOX in sections else ())}
    }
    content |= parts
    if BOX in sections:
        for axis in (*content["factors"].values(), *content["groups"].values()):
            del axis["levels"]
    for name in ("body", "groups"):  # which studies had before there were any
        if not content.get(name):
            content.pop(name, None)
    if study.surrogate.method == "factorial" and "surrogate" in content:  # the same
        content["surrogate"].pop("method")
    text = json.dumps(content, sort_keys=True)
    if {"phases", BOX} & set(sections):
        text += json.dumps(materials, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
