"""The polish of candidates: it loses nothing, and passes a choice over only where none of its designs is feasible."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.workflow.design.test_verdict import small
from workflow.design.question.pilot import ask
from workflow.design.question.sources import Factors, shape
from workflow.design.search import polish
from workflow.design.search.polish import Candidate
from workflow.study.target import Target

Array = NDArray[np.float64]

STUDY = small(
    fixed={"material": "PZT-4", "load": 1e4},
    factors={"radius": {"low": 0.01, "high": 0.1, "levels": 4}, "friction": {"low": 0.1, "high": 0.4, "levels": 4}},
)
TARGET = Target(
    maximise="voltage_per_load",
    over=["radius"],
    worst_case={"friction": [0.1, 0.4]},
    subject_to=["trailing_tension <= 50 MPa"],
)


def rising(radius: Array, friction: Array) -> Array:
    return 1e9 * radius * (0.5 + friction)


@dataclass(frozen=True)
class Closed:
    """A source in closed form: a sensitivity that is the radius, and a tension."""

    tension: Callable[[Array, Array], Array] = rising
    step: float | None = 1e-6
    edge: None = None

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        radius, friction = (factors[name] + np.zeros(shape(factors)) for name in ("radius", "friction"))
        quantities = {"voltage_per_load": radius, "trailing_tension": self.tension(radius, friction)}
        return {name: quantities[name] for name in names}

    def slopes(self, factors: Factors, names: Sequence[str], over: Sequence[str]) -> dict[str, Array]:
        raise NotImplementedError


def found(exact: Closed | None = None, choice: str = "PZT-4") -> Candidate:
    """The best design by a source in closed form, to be polished on another."""
    predicted, other = cast(Any, Closed()), cast(Any, exact or Closed())
    candidate = Candidate({"material": choice}, ask(STUDY, "test", TARGET, predicted, other))
    return candidate.sought(predicted)


def radius(design: Candidate) -> float:
    return float(design.design.variables["radius"][0])


def test_the_exact_solver_is_searched_where_the_surrogate_leads_astray() -> None:
    """The surrogate leads to 56 mm, where no design is feasible; all designs up to 20 mm are."""

    def steep(radius: Array, friction: Array) -> Array:
        return np.where(radius < 0.02, 2.5e9 * radius, 200e6 + 1e9 * (0.1 - radius)) * (1 + 0 * friction)

    polished = polish.first_feasible([found(Closed(steep))])
    assert polished.best.feasible
    assert radius(polished) == pytest.approx(0.02, rel=1e-3)


def test_a_choice_that_is_truly_infeasible_is_passed_over_and_told() -> None:
    nowhere = found(Closed(lambda radius, friction: 60e6 + rising(radius, friction)), "PZT-5H")
    worse = found(choice="BaTiO3")
    taken = polish.first_feasible([nowhere, worse])
    assert taken.choice == {"material": "BaTiO3"}
    assert [passed.choice for passed in taken.passed] == [{"material": "PZT-5H"}]
    assert "is better and not taken: it misses trailing_tension <= 50 MPa by 0.38 of it" in taken.polish
    assert not polish.first_feasible([nowhere]).best.feasible
