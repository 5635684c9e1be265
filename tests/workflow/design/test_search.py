"""Designs against a dense exact search of the same question."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from solver import solve
from surrogate import GaussianProcess
from surrogate import load as load_surrogate
from tests.surrogate.search.test_optimise import hypervolume
from tests.test_notebooks import table
from tests.workflow.conftest import Project
from workflow.design.search import targets
from workflow.design.search.design import Design
from workflow.study.model import load
from workflow.study.target import Target

#: Tension that BaTiO3 bears [Pa].
STRENGTH = 35e6


QUICKSTART = Path("config/quickstart.yaml")


@pytest.fixture(scope="module")
def model(quickstart_run: Project) -> GaussianProcess:
    return load_surrogate(quickstart_run.folder / "results/quickstart/surrogate.nc")


@pytest.fixture(scope="module")
def dense() -> xr.Dataset:
    """Exact cases all over the box at the rated load: 40,000 designs, 160,000 cases."""
    over = {"volume_fraction": np.linspace(0.05, 0.95, 200), "radius": np.geomspace(5e-3, 0.2, 200)}
    return solve({**over, "friction": np.linspace(0.1, 0.4, 4), "load": 5e3})


def best_of(dense: xr.Dataset, quantity: str) -> tuple[float, float]:
    """Best worst-case |quantity| of the designs that keep the limits, and its composition, by brute force."""
    worst = abs(dense[quantity]).min("friction")
    allowed = dense["trailing_tension"].max("friction") <= STRENGTH
    if quantity == "stroke_per_volt":  # of the actuator, which is read by its magnetic potential
        allowed &= abs(dense["magnetic_potential_per_load"]).min("friction") >= 30e-6
    best = worst.where(allowed)
    where = best.argmax(...)
    return float(best.max()), float(best["volume_fraction"][where["volume_fraction"]])


def test_designs_lose_nothing_and_break_no_limit(model: GaussianProcess, dense: xr.Dataset) -> None:
    for name, quantity in (("sensor", "voltage_per_load"), ("actuator", "stroke_per_volt")):
        design = Design.of(load(QUICKSTART), name, model)
        answer = design.answer
        best, fraction = best_of(dense, quantity)
        objective = answer.term(f"abs({quantity})").exact
        assert objective >= best * (1 - 1e-9)  # 40,000 designs, and none is better
        assert objective <= best * 1.03  # the grid's step in composition takes up to 2.5 % of the actuator's
        assert all(limit.margin >= 0 for limit in answer.limits)
        assert answer.variable("volume_fraction").value == pytest.approx(fraction, abs=0.01)
        predicted, exact = zip(*((term.predicted, term.exact) for term in answer.terms), strict=True)
        np.testing.assert_allclose(predicted, exact, rtol=1e-5)
        if name == "sensor":  # interior in composition and bound in radius
            assert design.verdict.kind.startswith("recommended within the model; roughness of 10 nm")
            assert design.exact["trailing_tension <= tensile_strength"] == pytest.approx(STRENGTH, rel=1e-9)
            rows = table(design._repr_html_())
            assert ["volume_fraction", f"{design.factors['volume_fraction']:.5g}", "variable"] in rows
            assert ["trailing_tension <= tensile_strength", "35 MPa", "35 MPa"] in rows
            assert answer.term("trailing_tension <= tensile_strength").margin < 1e-6


def test_the_front_is_as_large_as_a_dense_one(model: GaussianProcess, dense: xr.Dataset) -> None:
    target = Target(
        maximise="abs(voltage_per_load)", minimise="trailing_tension", over=["volume_fraction", "radius"],
        at={"load": 5e3, "charge": 0.0}, worst_case={"friction": [0.1, 0.4]},
        subject_to=["trailing_tension <= 120 MPa"],
    )  # fmt: skip
    answer = targets.answer(load(QUICKSTART), "front", target, model)
    front = answer.pictures["front_exact"].values * [1, -1]
    worst = [abs(dense["voltage_per_load"]).min("friction"), -dense["trailing_tension"].max("friction")]
    points = np.stack([values.values.ravel() for values in worst], -1)
    points = points[points[:, 1] >= -120e6]
    reference = front.min(0)
    assert hypervolume(front, reference) >= 0.995 * hypervolume(points, reference)
    assert np.all(front[:, 1] >= -120e6 * (1 + 1e-9))
    # filled in between neighbours the front cuts a corner, where dense designs are better in both by 0.18 %
    assert not any(np.any(np.all(points > values + 2e-3 * np.abs(values), axis=1)) for values in front)
