"""A factor of a design: its role, the end of the range at which it stands, what small errors in it cost."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

import numpy as np

from workflow.language import titles


class Role(StrEnum):
    """Role of a factor or a category in a design."""

    VARIABLE = "variable"
    WORST_CASE = "worst case"
    UNCERTAIN = "uncertain"
    GIVEN = "given"


class End(StrEnum):
    """An end of a range: of the studied one, or of the part of it that was asked for."""

    UPPER = "upper end of the studied range"
    LOWER = "lower end of the studied range"
    UPPER_ASKED = "upper end of the range asked for"
    LOWER_ASKED = "lower end of the range asked for"

    @classmethod
    def of(cls, *, upper: bool, studied: bool) -> "End":
        """The end of that side and range."""
        if upper:
            return cls.UPPER if studied else cls.UPPER_ASKED
        return cls.LOWER if studied else cls.LOWER_ASKED

    @property
    def outward(self) -> float:
        """1 at an upper end, -1 at a lower one."""
        return 1.0 if self in (End.UPPER, End.UPPER_ASKED) else -1.0

    @property
    def words(self) -> str:
        """The end in a sentence about its variable."""
        range_words = " of the range asked for" if self in (End.UPPER_ASKED, End.LOWER_ASKED) else " of its range"
        return f"the {'upper' if self.outward > 0 else 'lower'} end{range_words}"


@dataclass(frozen=True)
class Sensitivity:
    """Effects of small errors in building one variable."""

    elasticity: Annotated[tuple[float, ...], "relative change of the term for a relative change of the factor"]
    cost: Annotated[float, "share of the objective lost by an error of 1 % in the factor"] = np.nan
    loss: Annotated[float, "what an error of 1 % in the factor takes from the objective, over its unit in units"] = (
        np.nan
    )
    matters: Annotated[bool, "whether an error of 1 % in the factor changes any objective"] = True
    margin_left: Annotated[float, "least margin of all limits after an error of 1 % in the factor"] = np.nan


@dataclass(frozen=True)
class Variable:
    """A factor of the design, chosen or given."""

    name: str  # Of the factor
    value: Annotated[float, "factor of the design, over its SI unit"]
    role: Annotated[Role, "what the factor is in the design"]
    sensitivity: Sensitivity  # What small errors in it make of the design
    tolerance: Annotated[str, "how far the factor may be off as built"] = ""
    edge: Annotated[End | None, "which end of its range the factor stands at, if any"] = None

    @property
    def chosen(self) -> bool:
        """Return whether the design chooses the factor."""
        return self.role == Role.VARIABLE

    @property
    def title(self) -> str:
        """The factor in words."""
        return titles.title(self.name)

    @property
    def words(self) -> str:
        """Value with its unit."""
        return titles.value(self.name, self.value)
