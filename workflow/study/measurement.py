"""A published measurement that the model is held against: its value, what the model answers with, its source."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from solver import find
from workflow.study.types import BY_FACTOR, InputName, Number, Strict

#: What the model can be asked for; ``workflow.measured.values`` has a function of each.
ModelQuantity = Literal[
    "charge_per_force", "clamped_d33", "free_d33", "indentation_exponent", "response_under_load",
    "stiffness_under_charge", "layer_factor",
]  # fmt: skip
#: Units of measured values, in SI.
UNITS = {"pC/N": 1e-12, "pm/V": 1e-12, "1": 1.0}


class ModelValue(Strict):
    """Question to the model, whose answer is compared with a measurement."""

    quantity: ModelQuantity = Field(description="what the model answers with")
    case: Annotated[dict[InputName, Number | str], BY_FACTOR] = Field(
        min_length=1, description="factors of the case, among them a material"
    )

    @model_validator(mode="after")
    def _of_a_material(self) -> Self:
        if not isinstance(material := self.case.get("material"), str):
            raise ValueError("case: material: missing; every value of the model is one of a material")
        find(material)
        return self


class Measurement(Strict):
    """One row: what was measured, and what the model says to it."""

    of: str = Field(min_length=1, max_length=200, description="what was measured on what")
    short: str = Field("", max_length=40, description="the same in some words, beside its row of the figure")
    value: Number = Field(gt=0, description="measured value, in its unit")
    error: Number | None = Field(None, gt=0, description="standard deviation of it; null: none is published")
    error_is: str = Field("as published", description="where the error comes from")
    unit: Literal["pC/N", "pm/V", "1"] = Field(description="unit of value and error")
    model: list[ModelValue] = Field(
        default_factory=list, max_length=4, description="the model's value; several, or none, of a row that is open"
    )
    rivals: list[ModelValue] = Field(
        default_factory=list, max_length=4, description="values of other rules, which the row may rule out"
    )
    open: str = Field("", max_length=300, description="why the row cannot be told, whatever the numbers")
    outside: str = Field("", max_length=300, description="what the model leaves out that the row shows")
    note: str = Field("", max_length=500, description="what else a reader should know of the model's value")
    source: str = Field(min_length=1, max_length=400, description="who measured it, and where it is printed")
    read: Literal["abstract", "table", "quoted"] = Field(
        "abstract", description="where the value was read: the abstract, a vendor's table, another publication"
    )
    decides: str = Field(min_length=1, max_length=300, description="what would decide the row")

    @model_validator(mode="after")
    def _told(self) -> Self:
        if len(self.model) != 1 and not self.open:
            raise ValueError(f"model: {len(self.model)} values; must be one, or `open` must say why the row is open")
        return self
