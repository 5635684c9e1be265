"""Categories: every combination is solved, learned and chosen from; checked case by case against the solver."""

from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from solver import solve
from surrogate import GaussianProcess
from tests.studies import fitted
from workflow.cli import questions
from workflow.design.search import targets
from workflow.design.wording import table
from workflow.learning import readout_trial
from workflow.study.categories import output
from workflow.study.model import Study, load

MATERIALS, PROFILES = ("BaTiO3", "PZT-4", "PZT-5H", "BaTiO3-CoFe2O4 50:50"), ("cylinder", "half_cylinder")
SENSITIVITY, TENSION = "voltage_per_load", "trailing_tension"


@pytest.fixture(scope="module")
def study() -> Study:
    return load(Path("config/catalogue.yaml"))


@pytest.fixture(scope="module")
def model(study: Study) -> GaussianProcess:
    return fitted(study, calibrated=True)


@cache
def dense(material: str, profile: str, radii: int = 2000) -> tuple[np.ndarray, np.ndarray]:
    """Worst |sensitivity| and tension over the friction at many radii, the solver asked for one combination alone."""
    exact = solve(
        {
            "material": material, "profile": profile, "radius": np.geomspace(5e-3, 0.2, radii), "load": 1e4,
            "friction": np.linspace(0.1, 0.4, 5),
        }
    )  # fmt: skip
    return abs(exact[SENSITIVITY]).min("friction").values, exact[TENSION].max("friction").values


def test_every_combination_is_learned(study: Study, model: GaussianProcess) -> None:
    assert study.cases == 10 * 12 * 12 * 8
    point = {"friction": 0.23, "radius": 0.031, "load": 2.2e4}
    answer = model.predict(point)
    assert len(answer.data_vars) == 2 * 7 * 8
    for material, profile in product(MATERIALS, PROFILES):
        exact = solve({**point, "material": material, "profile": profile})
        for name in study.outputs:
            predicted = answer[output(name, {"material": material, "profile": profile})]
            assert float(predicted) == pytest.approx(float(exact[name]), rel=1e-6, abs=0)
            assert predicted.attrs["units"] == exact[name].attrs["units"]


def test_the_chosen_combination_is_the_best_of_all(study: Study, model: GaussianProcess) -> None:
    answer = targets.solve_target(study, "voltage", model)
    best = {}
    for kinds in product(MATERIALS, PROFILES):
        sensitivity, tension = dense(*kinds)
        if np.any(tension <= 50e6):
            best[kinds] = float(sensitivity[tension <= 50e6].max())
    winner = max(best, key=lambda kinds: best[kinds])
    assert tuple(answer.combination.values()) == winner
    objective = answer.term(f"abs({SENSITIVITY})").exact
    assert best[winner] * (1 - 1e-9) <= objective <= best[winner] * 1.001
    assert all(limit.margin >= 0 for limit in answer.limits)
    listed = {row.choice: row.choice_objective for row in answer.choices}
    assert len(listed) == 8
    assert {row.choice for row in answer.choices if row.choice_feasible} == {", ".join(kinds) for kinds in best}
    for kinds, value in best.items():
        assert listed[", ".join(kinds)] == pytest.approx(value, rel=1e-3)


def test_choices_of_numbers_and_names_together(study: Study, model: GaussianProcess) -> None:
    answer = targets.solve_target(study, "charge", model)
    categories = [(row.category, row.kind, row.kind_role) for row in answer.categories]
    assert categories == [("material", "PZT-5H", "variable"), ("profile", "cylinder", "given")]
    assert len(answer.choices) == 20
    assert answer.variable("radius").value in (0.02, 0.05, 0.1, 0.15, 0.2)
    rows = table.as_csv([answer]).splitlines()
    assert "charge,variable,material,,,,PZT-5H,,," in rows
    assert "charge,given,profile,,,,cylinder,,," in rows


def test_a_read_out_of_one_combination(study: Study, model: GaussianProcess) -> None:
    tried = readout_trial.trial(study, study.readout["voltage"].model_copy(update={"cases": 100}), model)
    # 3.2 standard deviations of 100 trials
    assert float(tried["coverage"].sel(factor="load")) == pytest.approx(0.95, abs=0.07)
    assert float(tried["width"].sel(factor="load")) < 0.01


def test_questions_in_words(study: Study) -> None:
    options = {"maximise": ["abs(charge_per_force)"], "over": ["radius,material=PZT-4|PZT-5H"], "at": ["load=1e4"]}
    target = questions.target(study, options)
    assert target.variables["material"].choices == ["PZT-4", "PZT-5H"]
    assert target.at["profile"] == "cylinder"  # its default
