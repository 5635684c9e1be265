"""Designs of a small study without a fit: the exact solver stands for the surrogate."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from tests.studies import made
from workflow.design.question.pilot import ask
from workflow.design.question.question import Question
from workflow.design.question.sources import Exact, Factors, Predicted
from workflow.study.model import Study
from workflow.study.target import Target

Array = NDArray[np.float64]

FACTORS = {
    "radius": {"low": 0.02, "high": 0.2, "levels": 4, "scale": "log"},
    "load": {"low": 5e3, "high": 5e4, "levels": 4, "scale": "log"},
}
FIXED = {"material": "BaTiO3", "friction": 0.2}


class StandIn(Predicted):
    """The exact solver as a surrogate that takes itself for sure."""

    step = Exact.step

    def __init__(self, study: Study) -> None:
        self._exact = Exact(study)

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        return self._exact.values(factors, names)

    def errors(self, factors: Factors, weights: Mapping[str, Array]) -> tuple[float, float]:
        return 0.0, 0.0


def study(**changed: Any) -> Study:
    """A punch on BaTiO3 of which radius and load are factors."""
    validation = {"cases": 20, "calibration": 40, "tolerance": 1e-2}
    text = {"title": "small", "fixed": FIXED, "factors": FACTORS, "validation": validation}
    return made(yaml.safe_dump(text | changed))


def design(study: Study, point: dict[str, float], **target: Any) -> Question:
    """One design of a question, by its variables in SI."""
    question = ask(study, "mine", Target.model_validate(target), StandIn(study), Exact(study))
    return question.at(np.array([axis.to_unit(point[name]) for name, axis in question.inputs.items()], dtype=float))
