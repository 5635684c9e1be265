"""The regret of every shipped target that a dense exact search can reach; under all kernels in `make soak`."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import qmc

from surrogate import GaussianProcess
from tests import studies
from workflow.design.question import costly
from workflow.design.search import targets
from workflow.design.search.polish import Candidate
from workflow.run.provenance import ROOT
from workflow.study.model import Study, load

STUDIES = ("actuator", "catalogue", "quickstart", "sensor")
TARGETS = [
    (name, target)
    for name in STUDIES
    for target, shipped_target in studies.shipped(name).design.items()
    if len(shipped_target.objectives) == 1 and not studies.shipped(name).open
]
_CASES = 1 << 22  # of a dense search
_KEPT = 1e-12  # relative excess that is rounding


@cache
def trained(name: str) -> tuple[Study, GaussianProcess]:
    study = load(Path(ROOT / "config" / f"{name}.yaml"))
    return study, studies.fitted(study)


def dense(candidate: Candidate) -> float:
    """The best exact goal of many designs of one choice that keep every limit, larger is better; -inf for none."""
    question = candidate.question
    scenarios = sum(chosen.count for chosen in question.searched.values())
    d = len(question.inputs)
    X = 2 * qmc.Sobol(d, rng=1).random_base2(int(np.log2(_CASES / scenarios))) - 1 if d else np.empty((1, 0))
    best = -np.inf
    for part in np.array_split(X, max(1, len(X) // 4096)):
        counts = question.at(part).count(question.exact, question.searched)
        feasible = np.ones(len(part), dtype=bool)
        for place, term in enumerate(question.terms):
            feasible &= term.oriented(counts[:, place]) <= _KEPT if term.limited else True
        goal = question.terms[0]
        best = max(best, float((goal.sign * counts[feasible, 0]).max(initial=-np.inf)))
    return best


@pytest.mark.soak
@pytest.mark.parametrize(("name", "target"), TARGETS)
def test_no_design_of_a_dense_search_is_better(name: str, target: str) -> None:
    study, model = trained(name)
    chosen_target = study.design[target]
    choices = [
        targets._asked(study, target, chosen_target, model, choice)
        for choice in targets.combinations(study, chosen_target)
    ]
    # cases that take milliseconds: test_costly.py
    assert not any(costly.asked(choice.question) for choice in choices)
    best = max(map(dense, choices))
    answer = targets.solve_target(study, target, model)
    goal = choices[0].question.terms[0]
    reached = goal.sign * answer.terms[0].exact
    assert answer.feasible == np.isfinite(best)
    # the dense search counts over the few scenarios, the verdict over many: a worst case is worse by what lies between
    assert not np.isfinite(best) or reached >= best - 1e-4 * abs(best)
