"""The best design of one choice of materials, profiles and listed values, as far as the search for it has come."""

from dataclasses import dataclass, replace

import numpy as np

from approximation.arrays import Array
from surrogate.search.optimise import Optimum, Problem, improve, maximise, retreat
from surrogate.search.pareto import Front, scalarised
from workflow.design.question.question import Question
from workflow.design.question.sources import Source
from workflow.language import titles

_SMALL = 1e-3  # share of its range below which an objective is no scale of its own
_NOTHING = Optimum(np.empty(0), -np.inf, np.empty(0), False)


@dataclass(frozen=True)
class Candidate:
    """The best design of one choice, as far as the search for it has come."""

    choice: dict[str, float | str]  # Values of the variables with a list, and names of the categories
    question: Question  # for this choice
    best: Optimum = _NOTHING  # The best design
    front: Front | None = None  # The Pareto front, where there are several objectives
    normalisation: tuple[Array, Array] | None = None  # Reference and weights of the one objective that stands for them
    # How the best design was polished, and in how many cases that are searched for
    polish: str = ""
    cases: int = 0
    # Better choices by the surrogate, none of whose designs keeps every limit on the exact solver
    passed: "tuple[Candidate, ...]" = ()

    @property
    def design(self) -> Question:
        """The question at the best design."""
        return self.question.at(self.best.x)

    @property
    def words(self) -> str:
        """The choice in words: names as they are, numbers with theirs."""
        return ", ".join(
            value if isinstance(value, str) else f"{titles.title(key)} {titles.value(key, value, 4)}"
            for key, value in self.choice.items()
            if key in self.question.target.variables
        )

    def problem(self, source: Source, safety: Array | None = None) -> Problem:
        """The optimiser's question with safety margins, (limits,); several objectives as the fronts' compromise."""
        problem = self.question.problem(source, safety)
        if self.normalisation is None:
            return problem
        return scalarised(problem, self.question.objectives, *self.normalisation)

    def sought(self, source: Source) -> "Candidate":
        """The best design of the whole box."""
        return replace(self, best=maximise(self.problem(source), scan=self.question.scan))

    def improved(self, source: Source, safety: Array) -> "Candidate":
        """The best design near this one, with a safety margin to every limit; safety: (limits,), relative margins."""
        best = self.best
        return replace(self, best=improve(self.problem(source, safety), best.x, self.size(best.objective)))

    def retreated(self, source: Source, safety: Array) -> "Candidate":
        """The nearest design behind the limits with their safety margins; safety: (limits,), relative margins."""
        problem = self.problem(source, safety)
        return replace(self, best=replace(self.best, x=retreat(problem, self.best.x))).counted(source)

    def counted(self, source: Source) -> "Candidate":
        """The same design, with what it comes to on another source."""
        objective, excess = (rows[0] for rows in self.problem(source).value(self.best.x[None]))
        return replace(self, best=replace(self.best, objective=float(objective.min()), excess=excess))

    def size(self, objective: float) -> float:
        """Scale of the objective at a value; next to zero, a share of its range."""
        spread = self.question.spread if self.normalisation is None else 1.0
        return max(abs(objective), _SMALL * spread) or 1.0
