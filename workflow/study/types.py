"""Base types of the study's model: strictness, numbers and names of the interface."""

from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema

from solver.fields import INTERIOR, INTERIOR_ON_REQUEST
from solver.names import ALL_QUANTITIES, CHOICES, COMPOSITES, MATERIALS
from workflow.language.factors import FACTORS, own_kind
from workflow.language.given import entries
from workflow.language.spelling import nearest


class Strict(BaseModel):
    """No unknown keys, no silent conversions, no changes afterwards."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def _one_of(names: list[str], what: str) -> AfterValidator:
    def check(name: str) -> str:
        if name not in names and not (names[-1] in FACTORS and own_kind(name)):
            raise ValueError(f"{name!r} is not a {what}; {nearest(name, names)}")
        return name

    return AfterValidator(check)


Number = Annotated[float, Field(allow_inf_nan=False)]
#: Around a mapping of numbers by the names of factors: each is read by the one rule of `workflow.language.given`.
BY_FACTOR = BeforeValidator(entries)
#: A number below `BY_FACTOR`: a file may have it with its unit.
Given = Annotated[Number, WithJsonSchema({"type": ["number", "string"]})]
CategoryName = Annotated[str, _one_of([*MATERIALS, *CHOICES], "category")]
FactorName = Annotated[str, _one_of(list(FACTORS), "factor")]
InputName = Annotated[str, _one_of([*MATERIALS, *CHOICES, *FACTORS], "factor")]
#: Factors of a case by name.
Case = Annotated[dict[InputName, Number | str], BY_FACTOR]
CompositeName = Annotated[
    str, _one_of(list(COMPOSITES), "composite"), Field(json_schema_extra={"enum": list(COMPOSITES)})
]
QuantityName = Annotated[str, _one_of(list(ALL_QUANTITIES), "quantity")]
FieldName = Annotated[str, _one_of([*INTERIOR, *INTERIOR_ON_REQUEST], "field of the interior")]
Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Interval = Annotated[list[Given], Field(min_length=2, max_length=2)]
