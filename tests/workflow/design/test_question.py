"""Scenarios, risk measures and derivatives of design questions against closed forms and difference quotients."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy import stats

from surrogate import GridGP
from workflow.dataset import factorial
from workflow.design.question import risk, scenarios
from workflow.design.question.pilot import ask
from workflow.design.question.sources import Exact, Factors, Predicted
from workflow.design.search import targets
from workflow.study.model import Study, load
from workflow.study.reading import InputError
from workflow.study.target import Distribution, Target

Array = NDArray[np.float64]

OUTPUTS = ["voltage", "depth", "trailing_tension", "contact_trailing", "contact_leading", "stroke_per_volt"]


@pytest.fixture(scope="module")
def study() -> Study:
    whole = load(Path("config/quickstart.yaml"))
    levels = {"volume_fraction": 22, "friction": 5, "radius": 6, "load": 6, "charge": 3}
    factors = {name: axis.model_copy(update={"levels": levels[name]}) for name, axis in whole.factors.items()}
    return whole.model_copy(update={"factors": factors})


@pytest.fixture(scope="module")
def model(study: Study) -> GridGP:
    data = factorial.exact(study, dict(factorial.levels(study)))
    return GridGP(inputs=factorial.inputs(study), outputs=OUTPUTS).fit(data)


TARGET = Target(
    maximise="abs(voltage) / depth", over=["volume_fraction", "radius"],
    at={"charge": 0.0}, worst_case={"friction": [0.1, 0.4], "load": [5e3, 2e4]},
)  # fmt: skip


def test_risk_measures_of_draws_are_those_of_the_distributions() -> None:
    target = Target(minimise="depth", over=["radius"], uncertain={"load": Distribution(normal=[1e4, 1e3])})
    drawn = scenarios.draws(target, 4096).values["load"]
    normal = stats.truncnorm(-3, 3, 1e4, 1e3)
    assert Distribution(uniform=[1.0, 3.0]).quantile(np.array([0.25])) == pytest.approx([1.5])
    values = drawn.reshape(1, 1, -1)
    assert risk.MeanDeviation(-2.0).rows(values)[0, 0] == pytest.approx(normal.mean() - 2 * normal.std(), rel=1e-4)
    for share in (0.05, 0.5, 0.99):
        assert risk.Quantile(share).rows(values)[0, 0] == pytest.approx(normal.ppf(share), rel=5e-4)


@pytest.mark.parametrize(
    ("goal", "reason"),
    [
        ("voltage / charge", "'voltage / charge' is unbounded: charge in a divisor passes 0"),
        ("sqrt(voltage)", "is not defined everywhere within the ranges"),
    ],
)
def test_questions_without_sense_are_named(study: Study, model: GridGP, goal: str, reason: str) -> None:
    content = {"maximise": goal, "over": ["volume_fraction", "radius", "charge"], "at": {"friction": 0.2, "load": 1e4}}
    with pytest.raises(ValueError, match=reason):
        ask(study, "mine", Target.model_validate(content), Predicted(model), Exact(study))


@pytest.mark.parametrize(
    ("limit", "refused", "meant"),
    [
        ("trailing_tension <= 50", True, "50 without .* 50 Pa, which no design satisfies: .*; did you mean 50 MPa"),
        ("radius >= 20", True, "20 without .* 20 m, which no design satisfies: .* 0.005 to 0.2 m; did you mean 20 mm"),
        ("load / depth >= 3e15", True, "which no design satisfies: .*; write a unit after the number"),
        ("contact_trailing <= 0.3", False, "0.3 without .* 0.3 m, which every design satisfies: .* mean 0.3 mm"),
        ("trailing_tension <= 50 Pa", False, ""),
        ("voltage >= 0", False, ""),
        ("deviation(depth) <= 50", False, ""),
    ],
)
def test_a_number_without_unit_is_told(study: Study, model: GridGP, limit: str, refused: bool, meant: str) -> None:
    target = TARGET.model_copy(update={"subject_to": [limit]})
    if refused:
        with pytest.raises(InputError, match=meant):
            ask(study, "mine", target, Predicted(model), Exact(study))
    else:
        notes = "; ".join(ask(study, "mine", target, Predicted(model), Exact(study)).notes)
        assert re.search(meant, notes) if meant else notes == ""


def test_a_chance_constraint_binds_at_its_probability(study: Study, model: GridGP) -> None:
    target = Target(
        maximise="abs(voltage) / load", over=["volume_fraction", "radius"], at={"charge": 0.0, "load": 1e4},
        uncertain={"friction": Distribution(triangular=[0.1, 0.2, 0.5])}, robust="mean",
        subject_to=["trailing_tension <= 50 MPa with probability 0.9"],
    )  # fmt: skip
    loose = study.model_copy(update={"validation": study.validation.model_copy(update={"tolerance": 1e-2})})
    answer = targets.answer(loose, "mine", target, model)
    held = {name: answer.variable(name).value for name in ("volume_fraction", "radius", "load", "charge")}
    shares = (np.arange(4000) + 0.5) / 4000
    friction = stats.triang.ppf(shares, 0.25, 0.1, 0.4)
    exact = factorial.exact(study, {**held, "friction": xr.DataArray(friction, dims="draw")})
    feasible = exact["trailing_tension"].values <= 50e6
    assert feasible.mean() == pytest.approx(0.9, abs=2e-3)  # binding: certainty would cost
    mean = float(abs(exact["voltage"] / held["load"]).mean())
    assert answer.terms[0].exact == pytest.approx(mean, rel=1e-4)


def test_an_exact_value_outside_its_band_fails(study: Study, model: GridGP, monkeypatch: pytest.MonkeyPatch) -> None:
    class Wrong(Predicted):  # by 5 %
        def values(self, factors: Factors, names: Sequence[str]) -> dict[str, Array]:
            return {name: 1.05 * value for name, value in super().values(factors, names).items()}

    monkeypatch.setattr(targets, "Predicted", Wrong)
    target = Target(
        maximise="abs(voltage) / depth", over=["radius"], worst_case={"friction": [0.1, 0.4]},
        at={"charge": 0.0, "load": 1e4, "volume_fraction": 0.5}, subject_to=["trailing_tension <= 50 MPa"],
    )  # fmt: skip
    with pytest.raises(InputError, match=r"design: mine: .* is outside .* allow_outside_interval: true"):
        targets.answer(study, "mine", target, model)
