"""Designs whose exact cases are costly, searched stresses and films: affordable, no regret, no broken limit."""

from collections.abc import Sequence
from typing import cast

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import brentq

from solver import solve
from surrogate import GaussianProcess
from tests.studies import fitted, made
from workflow.dataset import factorial
from workflow.design.question import costly
from workflow.design.question.question import Question
from workflow.design.question.sources import Exact, Factors, Predicted, shape
from workflow.design.search import targets
from workflow.learning import training
from workflow.study.model import Study
from workflow.study.target import Target

Array = NDArray[np.float64]

STUDY = Study.model_validate(
    {
        "title": "The largest stresses as limits",
        "fixed": {"composite": "fibrous", "load": 5e4},
        "factors": {
            "volume_fraction": {"low": 0.5, "high": 0.8, "levels": 10},
            "friction": {"low": 0.1, "high": 0.4, "levels": 14},
            "radius": {"low": 0.02, "high": 0.15, "levels": 5, "scale": "log"},
        },
        "dataset": {"peaks": True},
        "surrogate": {"outputs": ["voltage_per_load", "peak_principal_tension"]},
        "validation": {"cases": 20, "calibration": 40, "tolerance": 1e-2},
    }
)
RANGE = {"friction": [0.1, 0.4]}
DRAWN = {"friction": {"triangular": [0.1, 0.2, 0.4]}}
CRACK = "peak_principal_tension <= 60 MPa"


def target(**words: object) -> Target:
    wanted = {} if "minimise" in words else {"maximise": "abs(voltage_per_load)"}
    return Target.model_validate({**wanted, "over": ["volume_fraction", "radius"], **words})


@pytest.fixture(scope="module")
def quantities() -> xr.Dataset:
    return factorial.exact(STUDY, dict(factorial.levels(STUDY)))


@pytest.fixture(scope="module")
def model(quantities: xr.Dataset) -> GaussianProcess:
    return training.fit(STUDY, quantities)


@pytest.fixture(scope="module")
def dense() -> xr.Dataset:
    """Exact cases all over the box; without charges a share of the largest pressure depends on no radius."""
    over = {"volume_fraction": np.linspace(0.5, 0.8, 61), "friction": np.linspace(0.1, 0.4, 7)}
    fixed = {"composite": "fibrous", "load": 5e4}
    searched = solve({**fixed, **over, "radius": 0.05}, peaks=True)
    whole = solve({**fixed, **over, "radius": np.geomspace(0.02, 0.15, 200)})
    share = searched["peak_principal_tension"] / searched["peak_pressure"]
    return whole.assign(peak_principal_tension=share * whole["peak_pressure"])


def test_a_limit_on_a_searched_stress_costs_nothing(model: GaussianProcess, dense: xr.Dataset) -> None:
    answer = targets.answer(STUDY, "sensor", target(worst_case=RANGE, subject_to=[CRACK]), model)
    name, bound = "peak_principal_tension", 60e6
    allowed = dense[name].max("friction") <= bound
    best = float(abs(dense["voltage_per_load"]).min("friction").where(allowed).max())
    case = {"composite": "fibrous", "load": 5e4, "friction": np.linspace(0.1, 0.4, 61)}
    exact = solve(case | {key: answer.variable(key).value for key in ("volume_fraction", "radius")}, peaks=True)
    assert float(exact[name].max()) <= bound
    assert float(exact[name].max()) >= bound * (1 - 1e-5)
    assert float(abs(exact["voltage_per_load"]).min()) >= best * (1 - 1e-6)
    assert answer.feasible
    assert answer.polish.startswith(f"on the exact solver; {name} led by the surrogate, limits shifted to")
    assert answer.variable("radius").sensitivity.margin_left == pytest.approx(-0.005, abs=2e-4)  # ~ 1/sqrt(radius)


KINK = """\
title: Kink
fixed: {composite: fibrous, load: 1e4, radius: 0.1}
factors:
  volume_fraction: {low: 0.5, high: 0.95, levels: 6}
  friction: {low: 0.0, high: 0.6, levels: 24}
dataset: {peaks: true}
surrogate: {outputs: [peak_von_mises, peak_pressure]}
validation: {cases: 20, calibration: 40, tolerance: 1e-1}
design:
  most: {maximise: friction, over: [friction], at: {volume_fraction: 0.9}, subject_to: [peak_von_mises <= 44 MPa]}
"""


def test_a_limit_at_a_kink_is_met() -> None:
    """The largest von Mises stress leaves the depth for the surface layer at a friction near 0.41."""
    study = made(KINK)
    answer = targets.solve_target(study, "most", fitted(study))
    case = {"composite": "fibrous", "load": 1e4, "radius": 0.1, "volume_fraction": 0.9}

    def excess(friction: float) -> float:
        return float(solve({**case, "friction": friction}, peaks=True)["peak_von_mises"]) / 44e6 - 1

    friction = answer.variable("friction").value
    assert excess(friction) <= 0
    assert friction == pytest.approx(brentq(excess, 0.2, 0.5, xtol=1e-12), rel=1e-5)


def test_what_cannot_be_afforded_is_said_and_judged_exactly(
    quantities: xr.Dataset, model: GaussianProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(costly, "AFFORDABLE", 20)
    cracking = target(worst_case=RANGE, subject_to=[CRACK], allow_outside_interval=True)
    answer = targets.answer(STUDY, "sensor", cracking, model)
    assert answer.polish.startswith("none; as far from the limits as the interval of the surrogate asks for")
    assert answer.feasible
    crack = answer.term(CRACK)
    assert crack.margin >= 0
    assert crack.predicted + 1.95 * crack.predicted_std <= 60e6 * (1 + 1e-6)
    low = quantities.assign(peak_principal_tension=0.97 * quantities["peak_principal_tension"])
    broken = targets.answer(STUDY, "sensor", cracking, training.fit(STUDY, low))
    assert not broken.feasible
    assert not all(term.inside for term in broken.terms)
    assert "infeasible: peak_principal_tension <= 60 MPa binds" in broken.status


class Closed(Exact):
    """Two tops of nearly equal height in friction, wrong by a share; the other is the higher at a share of 2 %."""

    def __init__(self, share: float) -> None:
        self.share, self.cases = share, 0

    def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
        self.cases += int(np.prod(shape(factors)))
        friction = factors["friction"]
        tops = 5e7 * (1 + 0.3 * np.cos(40 * friction) + 0.02 * friction)
        return {name: tops * (1 + self.share * np.sin(20 * friction)) for name in names}


@pytest.mark.parametrize(
    ("words", "most", "accuracy"),
    [
        ({"worst_case": RANGE, "subject_to": [CRACK]}, 120, 1e-12),
        ({"uncertain": DRAWN, "subject_to": [f"{CRACK} with probability 0.9"]}, 700, 1e-6),
        ({"uncertain": DRAWN, "subject_to": ["peak_principal_tension >= 30 MPa with probability 0.99"]}, 700, 1e-6),
        # a thousandth of the weight is believed to the surrogate, 2 % off: 2e-5 of a mean of which 0.3 is the deviation
        ({"worst_case": RANGE, "subject_to": ["deviation(peak_principal_tension) <= 5 %"]}, 201, 1e-4),
        ({"minimise": "peak_principal_tension", "uncertain": DRAWN, "robust": "mean - 2 std"}, 256, 1e-4),
    ],
)
def test_few_exact_cases_tell_what_many_would_say(words: dict[str, object], most: int, accuracy: float) -> None:
    known = Closed(0.0)
    question = Question(STUDY, target(**words), cast(Predicted, Closed(0.02)), known)
    term = next(term for term in question.terms if costly.names(question, term))
    value, cases = costly.count_exactly(question.at(np.zeros((1, 2))), term)
    assert cases == known.cases <= most
    chosen = question.judged[term.measure.key]
    values = known.values(chosen.values, ["peak"])["peak"].reshape(1, chosen.groups, chosen.draws)
    assert value == pytest.approx(float(term.counted(values)[0]), rel=accuracy)


FILM = """\
title: A film
fixed: {surroundings: insulated, composite: fibrous, volume_fraction: 0.55, radius: 0.05, load: 3e4}
categories: {base: [rigid, steel]}
factors:
  friction: {low: 0.0, high: 0.2, levels: 3}
  thickness: {low: 2e-4, high: 3e-4, levels: 5, scale: log}
surrogate: {outputs: [voltage, voltage_per_load, trailing_tension]}
validation: {cases: 20, calibration: 40, tolerance: 1e-3}
design:
  thick:
    maximise: abs(voltage_per_load)
    over: [thickness, base]
    worst_case: {friction: [0.05, 0.15]}
    subject_to: [nominal_field <= 0.8 kV/mm]
"""


def test_a_thickness_is_found_with_few_exact_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    study = made(FILM)
    model = fitted(study)
    counts: list[int] = []
    exact = Exact.values

    def counted(self: Exact, factors: Factors, names: list[str]) -> dict[str, Array]:
        counts.append(int(np.prod(shape(factors))))
        return exact(self, factors, names)

    monkeypatch.setattr(Exact, "values", counted)
    answer = targets.solve_target(study, "thick", model)
    # the verdict of a half-plane would solve 201 scenarios at once, and every step of the polish some more
    assert max(counts) <= 14  # loads up to the first limit, of one table
    assert sum(counts) <= costly.AFFORDABLE_FILMS
    assert "led by the surrogate" in answer.polish
    assert answer.feasible
    design = {name: answer.variable(name).value for name in study.factors}
    base = answer.combination["base"]
    goal, field = answer.terms
    for term, limit in ((goal, False), (field, True)):
        case = design | {"friction": term.worst["friction"], "base": base} | study.fixed
        solved = solve(case)
        value = solved["nominal_field"] if limit else abs(solved["voltage_per_load"])
        assert term.exact == pytest.approx(float(value), rel=1e-6)
    assert field.exact <= 8e5 * (1 + 1e-9)
