"""Designs of a question, with the sources that tell what they come to: what search, front and verdict hand on."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from approximation.arrays import Array
from workflow.design.asking.question import Question
from workflow.design.asking.scenarios import Scenarios
from workflow.design.asking.sources import Exact, Factors, Predicted, Source
from workflow.design.asking.terms import Key, Term


@dataclass(frozen=True)
class Designs:
    """Designs of one question."""

    question: Question  # What they answer
    # The surrogate and the exact solver, for the question's categories
    predicted: Predicted
    exact: Exact
    x: Array  # Scaled variables, (n, d)

    @cached_property
    def variables(self) -> dict[str, Array]:
        """The design variables, (n,) each."""
        return self.question.physical(self.x)

    def at(self, x: Array) -> "Designs":
        """Others of the same question, (n, d) or one (d,)."""
        return replace(self, x=np.atleast_2d(x))

    def factors(self, chosen: Scenarios) -> Factors:
        """Every factor of the factorial, over (designs, scenarios)."""
        return self.question.factors(self.variables, chosen)

    def factors_of(self, values: Array) -> Factors:
        """Every factor over the corners, of the verdict or of the search, that some values are over."""
        sets = (self.question.judged[False], self.question.searched[False])
        chosen = next((scenarios for scenarios in sets if scenarios.count == values.shape[-1]), sets[0])
        return self.factors(chosen)

    def values(self, source: Source, chosen: Scenarios, term: Term) -> Array:
        """A term over some scenarios, (designs, groups, draws)."""
        return self.question.values(source, self.variables, chosen, [term])[0]

    def count(self, source: Source, sets: Mapping[Key, Scenarios]) -> Array:
        """What every term counts as, (designs, terms)."""
        return self.question.count(source, self.variables, sets)
