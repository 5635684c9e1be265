"""A press in time, as the study's model has it: on what, how hard and for how long."""

from typing import Annotated, Self

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from workflow.language.given import number
from workflow.study.device import Device
from workflow.study.types import BY_FACTOR, InputName, Number, Strict


def _read(name: str, units: str) -> BeforeValidator:
    def positive(value: object, info: ValidationInfo) -> object:
        if isinstance(value, str | int | float) and not isinstance(value, bool):
            value = number(name, value, units, info.context)
            if not 0 < value < float("inf"):
                raise ValueError(f"{value:g} is not a finite number > 0 [{units}]")
        return value

    return BeforeValidator(positive)


class Pressing(Strict):
    """A punch is pressed, held and let go; numbers in SI, or with a unit, as ``100 ms``.

    The punch is that of a design, or one of its own beside the study's, on a body of its own.
    """

    title: str = Field("", max_length=200, description="above its card, of a contact of its own; made if empty")
    design: str = Field("", description="the design target whose punch it is; empty: case")
    case: Annotated[dict[InputName, Number | str], BY_FACTOR] = Field(
        default_factory=dict, description="all factors but the force, of a contact of its own in place of a design's"
    )
    device: Device | None = Field(None, description="what reads that contact; null: the study's")
    force: Annotated[Number, _read("force", "N")] = Field(description="that is held [N]")
    press: Annotated[Number, _read("press", "s")] = Field(
        0.1, description="how long pressing takes, and letting go [s]"
    )
    hold: Annotated[Number, _read("hold", "s")] = Field(10.0, description="how long the force is held [s]")

    @model_validator(mode="after")
    def _of_one(self) -> Self:
        if bool(self.design) == bool(self.case):
            raise ValueError("design: is given beside a case" if self.design else "design: missing; or give a case")
        if self.design and (self.device or self.title):
            raise ValueError("case: missing; a design has the study's device, and its own title")
        return self
