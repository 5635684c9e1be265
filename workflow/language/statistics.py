"""Statistics of uncertain cases in an objective; `workflow.design.question.risk` has the numbers to each."""

import re
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

_MEAN = re.compile(r"mean(?:\s*-\s*(?P<count>\d+\.?\d*|\.\d+)\s*std)?")


@dataclass(frozen=True)
class Worst:
    """The worst case, which lies at the ends of all ranges."""

    drawn: ClassVar[bool] = False  # Whether it needs draws of distributions rather than the ends of all ranges
    told: ClassVar[str] = "at worst"  # Words for it in a goal

    def __str__(self) -> str:
        return "worst-case"


@dataclass(frozen=True)
class Mean:
    """The mean, or the mean minus some standard deviations."""

    drawn: ClassVar[bool] = True
    deviations: float

    @property
    def told(self) -> str:
        """Words for the statistic in a goal."""
        return f"(mean less {self.deviations:g} std)" if self.deviations else "on average"

    def __str__(self) -> str:
        return f"mean minus {self.deviations:g} std of" if self.deviations else "mean"


Statistic: TypeAlias = Worst | Mean


def statistic(text: str) -> Statistic:
    """Read a statistic, as ``mean - 2 std``."""
    words = " ".join(text.split())
    if words == "worst case":
        return Worst()
    if match := _MEAN.fullmatch(words):
        return Mean(float(match["count"] or 0.0))
    raise ValueError(f"{text!r} is not 'worst case', 'mean' or 'mean - K std'")
