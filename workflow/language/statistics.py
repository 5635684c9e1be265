"""Statistics of uncertain cases in an objective; `workflow.design.question.risk` has the numbers to each."""

import re
from dataclasses import dataclass

_MEAN = re.compile(r"mean(?:\s*-\s*(?P<count>\d+\.?\d*|\.\d+)\s*std)?")


@dataclass(frozen=True)
class Statistic:
    """The mean minus some standard deviations, or the worst case, which lies at the ends of all ranges."""

    deviations: float | None  # None: the worst case

    @property
    def drawn(self) -> bool:
        """Return whether it needs draws of distributions rather than the ends of all ranges."""
        return self.deviations is not None

    @property
    def told(self) -> str:
        """Words for the statistic in a goal."""
        if self.deviations is None:
            return "at worst"
        return f"(mean less {self.deviations:g} std)" if self.deviations else "on average"

    def __str__(self) -> str:
        if self.deviations is None:
            return "worst-case"
        return f"mean minus {self.deviations:g} std of" if self.deviations else "mean"


def statistic(text: str) -> Statistic:
    """Read one of the family, as ``mean - 2 std``."""
    words = " ".join(text.split())
    if words == "worst case":
        return Statistic(None)
    if match := _MEAN.fullmatch(words):
        return Statistic(float(match["count"] or 0.0))
    raise ValueError(f"{text!r} is not 'worst case', 'mean' or 'mean - K std'")
