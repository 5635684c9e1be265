"""A press in time, as the study's model has it: on which design, how hard and for how long."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from solver.units import in_si
from workflow.study.types import Number, Strict


def _read(units: str) -> BeforeValidator:
    def number(given: object) -> object:
        value = in_si(given, units) if isinstance(given, str) else given
        if isinstance(value, int | float) and not 0 < value < float("inf"):
            raise ValueError(f"{value:g} is not a finite number > 0 [{units}]")
        return value

    return BeforeValidator(number)


class Pressing(Strict):
    """A punch is pressed, held and let go; numbers in SI, or with a unit, as ``100 ms``."""

    design: str = Field(description="the design target whose punch it is")
    force: Annotated[Number, _read("N")] = Field(description="that is held [N]")
    press: Annotated[Number, _read("s")] = Field(0.1, description="how long pressing takes, and letting go [s]")
    hold: Annotated[Number, _read("s")] = Field(10.0, description="how long the force is held [s]")
