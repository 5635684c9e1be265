"""The best design of one choice of materials, profiles and listed values, as far as the search for it has come."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from surrogate.search.optimise import Optimum, Problem, improve
from surrogate.search.pareto import Front, scalarised
from workflow.design.asking import program
from workflow.design.asking.designs import Designs
from workflow.design.asking.question import Question
from workflow.design.asking.sources import Source

Array = NDArray[np.float64]

_SMALL = 1e-3  # share of its range below which an objective is no scale of its own
_NOTHING = Optimum(np.empty(0), -np.inf, np.empty(0), False)


@dataclass(frozen=True)
class Candidate:
    """The best design of one choice, as far as the search for it has come.

    Attributes
    ----------
    choice
        Values of the variables with a list, and names of the categories.
    asked
        The question for these, with its sources; no design yet.
    best
        The best design.
    front
        The Pareto front, where there are several objectives.
    normalisation
        Reference and weights of the one objective that stands for them.
    polish, cases
        How the best design was polished, and in how many cases that are searched for.
    """

    choice: dict[str, float | str]
    asked: Designs
    best: Optimum = _NOTHING
    front: Front | None = None
    normalisation: tuple[Array, Array] | None = None
    polish: str = ""
    cases: int = 0

    @property
    def question(self) -> Question:
        """What is asked."""
        return self.asked.question

    @property
    def design(self) -> Designs:
        """The best design, with its question and sources."""
        return self.asked.at(self.best.x)

    def problem(self, source: Source, safety: Array | None = None) -> Problem:
        """The question for the optimiser; several objectives as the compromise that the fronts normalise."""
        problem = program.problem(self.question, source, safety)
        if self.normalisation is None:
            return problem
        return scalarised(problem, self.question.objectives, *self.normalisation)

    def improved(self, source: Source, safety: Array) -> "Candidate":
        """The best design near this one, with a safety margin to every limit."""
        best = self.best
        return replace(self, best=improve(self.problem(source, safety), best.x, self.size(best.objective)))

    def size(self, objective: float) -> float:
        """Scale of the objective at a value; next to zero, a share of its range."""
        spread = self.question.spread if self.normalisation is None else 1.0
        return max(abs(objective), _SMALL * spread) or 1.0
