"""Designs of a small study without a fit: the exact solver, or what is off by a share, stands for the surrogate."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from tests.studies import made
from workflow.design.question.pilot import ask
from workflow.design.question.question import Question
from workflow.design.question.sources import Exact, Factors, Predicted
from workflow.design.search.polish import Candidate
from workflow.study.model import Study
from workflow.study.target import Target

Array = NDArray[np.float64]

FACTORS = {
    "radius": {"low": 0.02, "high": 0.2, "levels": 4, "scale": "log"},
    "load": {"low": 5e3, "high": 5e4, "levels": 4, "scale": "log"},
}
FIXED = {"material": "BaTiO3", "friction": 0.2}


class StandIn(Predicted):
    """The exact solver as a surrogate that is off by a share of every quantity, and takes itself for sure."""

    step = Exact.step

    def __init__(self, study: Study, off: float = 0.0) -> None:
        self._exact, self._off = Exact(study), off

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        """Quantities by name."""
        return {name: (1 + self._off) * values for name, values in self._exact.values(factors, names).items()}

    def errors(self, factors: Factors, weights: Mapping[str, Array]) -> tuple[float, float]:
        """None."""
        return 0.0, 0.0


def study(**changed: Any) -> Study:
    """A punch on BaTiO3 of which radius and load are factors."""
    validation = {"cases": 20, "calibration": 40, "tolerance": 1e-2}
    text = {"title": "small", "fixed": FIXED, "factors": FACTORS, "validation": validation}
    return made(yaml.safe_dump(text | changed))


def candidate(study: Study, off: float = 0.0, **target: Any) -> Candidate:
    """A question for which nothing is searched yet."""
    predicted = StandIn(study, off)
    return Candidate({}, ask(study, "mine", Target.model_validate(target), predicted, Exact(study)))


def design(study: Study, point: dict[str, float], off: float = 0.0, **target: Any) -> Question:
    """One design of a question, by its variables in SI."""
    question = candidate(study, off, **target).question
    return question.at(np.array([axis.to_unit(point[name]) for name, axis in question.inputs.items()], dtype=float))
