"""Statistics of uncertain cases in an objective: each has a form in a study, words and needs."""

import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self


class Statistic(ABC):
    """One way to count uncertain cases; `workflow.design.question.risk` has the numbers to it."""

    forms: ClassVar[tuple[str, ...]]  # What a study writes for it
    drawn: ClassVar[bool] = True  # Whether it needs draws of distributions rather than the ends of all ranges

    @classmethod
    @abstractmethod
    def read(cls, text: str) -> Self | None:
        """The statistic that a text of single spaces writes; None where it writes another."""

    @property
    @abstractmethod
    def told(self) -> str:
        """Words for the statistic in a goal, as ``on average``."""


@dataclass(frozen=True)
class Worst(Statistic):
    """The worst case."""

    forms = ("worst case",)
    drawn = False

    @classmethod
    def read(cls, text: str) -> Self | None:
        """Read the statistic by its name."""
        return cls() if text in cls.forms else None

    @property
    def told(self) -> str:
        """Words for the statistic in a goal."""
        return "at worst"

    def __str__(self) -> str:
        return "worst-case"


@dataclass(frozen=True)
class Mean(Statistic):
    """The mean, or that minus some standard deviations."""

    forms = ("mean", "mean - K std")
    deviations: float

    @classmethod
    def read(cls, text: str) -> Self | None:
        """Read the statistic by its form; K is a number."""
        match = re.fullmatch(r"mean(?:\s*-\s*(?P<count>\d+\.?\d*|\.\d+)\s*std)?", text)
        return cls(float(match["count"] or 0.0)) if match else None

    @property
    def told(self) -> str:
        """Words for the statistic in a goal."""
        return f"(mean less {self.deviations:g} std)" if self.deviations else "on average"

    def __str__(self) -> str:
        return f"mean minus {self.deviations:g} std of" if self.deviations else "mean"


def statistic(text: str) -> Statistic:
    """Read one of the family, as ``mean - 2 std``."""
    family = Statistic.__subclasses__()
    for member in family:
        if read := member.read(" ".join(text.split())):
            return read
    *forms, last = (repr(form) for member in family for form in member.forms)
    raise ValueError(f"{text!r} is not {', '.join(forms)} or {last}")
