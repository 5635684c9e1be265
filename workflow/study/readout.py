"""A read-out, as the study's model has it: what is measured how well, and what it shall tell."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from workflow.language.sizes import size
from workflow.study.categories import Combination
from workflow.study.types import FactorName, InputName, Number, QuantityName, Strict


class Readout(Strict):
    """Inference of factors from measured quantities, with 95 % intervals."""

    measured: dict[QuantityName, str] = Field(
        min_length=1, description="standard deviation of each measurement: '2 V', or '0.5 %' of the value"
    )
    infer: Annotated[list[FactorName], Field(min_length=1, max_length=3)] = Field(description="factors to infer")
    at: dict[InputName, Number | str] = Field(default_factory=dict, description="the other factors")
    cases: int = Field(500, ge=50, le=100_000, description="random true cases that the intervals are tried on")

    @property
    def combination(self) -> Combination:
        """Categories held at a name."""
        return {name: value for name, value in self.at.items() if isinstance(value, str)}

    @property
    def held(self) -> dict[str, float]:
        """Factors held at a value."""
        return {name: value for name, value in self.at.items() if not isinstance(value, str)}

    @model_validator(mode="after")
    def _readable(self) -> Self:
        for name, text in self.measured.items():
            error(name, text)
        return self


def error(quantity: str, text: str) -> tuple[float, float]:
    """Standard deviation of a measurement: its absolute part in SI, and its share of the value."""
    try:
        return size(quantity, text)
    except ValueError as problem:
        raise ValueError(f"measured: {quantity}: {problem}") from None
