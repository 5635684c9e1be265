"""Keys of a study's file with their types, and hashes of its sections, by which results know their study."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from solver import Material
from workflow.study import layered
from workflow.study.sections import (
    Axis,
    DataSet,
    Device,
    Effects,
    Group,
    Measurement,
    Pressing,
    Readout,
    Surrogate,
    Validation,
    Verification,
)
from workflow.study.target import Target
from workflow.study.types import BY_FACTOR, CategoryName, FactorName, InputName, Number, Strict

#: Sections that decide what a case is and what the solver answers.
PHYSICS = ("phases", "materials", "fixed", "factors", "categories", "body", "groups")
#: The same without the numbers of levels, for `digest`.
BOX = "box"


@dataclass(frozen=True)
class Origin:
    """Origin of a study, beside the content of its file."""

    path: Path  # The file
    materials: dict[str, Material]  # The study's own materials by name
    # Quantities that some cases lack; None before the solver, which takes seconds for films, was asked for them
    absent: frozenset[str] | None = None
    hanging: frozenset[str] = frozenset()  # Quantities that depend on a datum which is in none of the groups
    in_si: bool = False  # the content comes from a checked study, whose numbers are bare and in SI


class Keys(Strict):
    """Everything that a run can be asked for; unchecked but for each part alone."""

    title: str = Field(min_length=1, max_length=200, description="headline of the report")
    description: str = Field("", description="what the study is for")
    materials: list[str] = Field(default_factory=list, description="files of own materials, relative to the study")
    phases: Annotated[list[str], Field(min_length=2, max_length=2)] = Field(
        default_factory=lambda: ["BaTiO3", "CoFe2O4"], description="phase one (fibres) and phase two (matrix)"
    )
    fixed: Annotated[dict[InputName, Number | str], BY_FACTOR] = Field(
        default_factory=dict, description="factors with one value"
    )
    factors: Annotated[dict[FactorName, Axis], BY_FACTOR] = Field(
        default_factory=dict, description="the axes of the factorial"
    )
    categories: dict[CategoryName, Annotated[list[str], Field(min_length=2, max_length=8)]] = Field(
        default_factory=dict, description="factors that take one of a few names; every case is solved for each"
    )
    groups: dict[str, Group] = Field(
        default_factory=dict,
        description="axes of the data set, each a product of powers of factors, as load * radius / thickness^2",
    )
    body: list[layered.BodyLayer] = Field(
        default_factory=list, description="layers from the top down, in place of one material and a film's factors"
    )
    dataset: DataSet = Field(default_factory=DataSet, description="what is stored of the factorial")
    surrogate: Surrogate = Field(default_factory=Surrogate, description="the Gaussian process")
    validation: Validation = Field(default_factory=Validation, description="exact cases it never saw")
    device: Device | None = Field(
        None,
        description="what the punch is connected to, for figures of a device; the punch is of steel unless it is "
        "named, and beside it is air unless fixed or categories name surroundings or air lacks what is asked for",
    )
    design: dict[str, Target] = Field(default_factory=dict, description="design targets by name")
    signal: Pressing | None = Field(None, description="a press in time on a design, as its amplifier reads it")
    readout: dict[str, Readout] = Field(default_factory=dict, description="what measurements tell, by name")
    effects: Effects | None = Field(None, description="one factor at a time, as figures")
    verification: Verification | None = Field(None, description="checks of the solver against independent methods")
    measurements: dict[str, Measurement] = Field(
        default_factory=dict,
        max_length=100,
        description="published measurements that the model is held against, by name",
    )


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
