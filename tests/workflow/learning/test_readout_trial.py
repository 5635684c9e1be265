"""Read-out: intervals hold true loads and frictions, exact quantities and errors of measurement in between."""

from pathlib import Path

import numpy as np
import pytest

from solver import solve
from surrogate import GridGP
from workflow.cli import questions
from workflow.dataset import factorial
from workflow.learning import readout_trial
from workflow.study.model import Study, load
from workflow.study.reading import InputError
from workflow.study.sections import Readout


@pytest.fixture(scope="module")
def study() -> Study:
    whole = load(Path("config/sensor.yaml")).narrowed({"composite": "fibrous"})
    levels = {"volume_fraction": 16, "friction": 6, "radius": 6, "load": 8}
    factors = {name: axis.model_copy(update={"levels": levels[name]}) for name, axis in whole.factors.items()}
    factors["volume_fraction"] = factors["volume_fraction"].model_copy(update={"low": 0.6, "high": 0.75})
    return whole.model_copy(update={"factors": factors, "validation": whole.validation.model_copy(update={"seed": 5})})


@pytest.fixture(scope="module")
def model(study: Study) -> GridGP:
    data = factorial.exact(study, dict(factorial.levels(study)))
    return GridGP(inputs=factorial.inputs(study), outputs=["voltage", "magnetic_potential", "depth"]).fit(data)


@pytest.mark.parametrize("cases", [100, pytest.param(400, marks=pytest.mark.soak)])
def test_intervals_hold_the_truth(study: Study, model: GridGP, cases: int) -> None:
    measured = {"voltage": "0.5 %", "magnetic_potential": "0.5 %"}
    readout = Readout(
        measured=measured, infer=["load", "friction"], at={"volume_fraction": 0.67, "radius": 0.12}, cases=cases
    )
    tried = readout_trial.trial(study, readout, model)
    # 3.2 standard deviations; 2,000 were measured to hold 95.0 and 95.2 % (docs)
    assert tried["coverage"].values == pytest.approx(0.95, abs=3.2 * np.sqrt(0.95 * 0.05 / cases))
    assert float(tried["width"].sel(factor="load")) < 0.02
    assert np.all(tried["low"] <= tried["mean"])
    assert np.all(tried["mean"] <= tried["high"])


def test_the_command_inverts(study: Study, model: GridGP, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(questions, "results", lambda folder: (study, model))
    case = {"volume_fraction": 0.67, "radius": 0.12, "load": 2e4, "friction": 0.25}
    exact = solve({**case, "composite": "fibrous"})
    voltage, potential = float(exact["voltage"]), float(exact["magnetic_potential"])
    words = {
        "measured": [
            f"voltage={voltage}+-{abs(voltage) * 1e-3},magnetic_potential={potential}+-{abs(potential) * 1e-3}"
        ],
        "infer": ["load,friction"],
        "at": ["volume_fraction=0.67,radius=0.12"],
    }
    lines = questions.invert(Path("results/sensor"), words).splitlines()
    name, _, low, high, unit = lines[0].split()[:5]
    assert (name, unit) == ("load", "kN/m")
    assert float(low[1:-1]) < 20 < float(high[:-1]) < 1.02 * float(low[1:-1])
    plain = questions.invert(Path("results/sensor"), words, si=True).split()
    assert plain[4:6] == ["N", "m-1"]
    alone = {**words, "measured": [f"voltage={voltage}+-1%"]}
    assert "friction cannot be told from this: the study's range is " in questions.invert(Path("results/sensor"), alone)
    for change, reason in (
        ({"measured": ["voltag=1+-1"]}, "--measured: voltag: is no quantity; did you mean 'voltage'?"),
        ({"measured": ["voltage=1+-1e308"]}, "'1+-1e308': an error must be within 1e-150 to 1e+150"),
        ({"measured": ["voltage=1e308+-1"]}, "no case within the study's ranges gives these measurements (misfit inf)"),
        ({"measured": ["voltage=1_0+-1"]}, "--measured: voltage: '1_0' is not a finite number"),
        (
            {"measured": ["capacitance_per_length=1e-9+-1e-11"]},
            "--measured: capacitance_per_length: is not learned by the study; ",
        ),
        ({"at": ["volume_fraction=0.67,radius=3"]}, "--at: radius = 3 is not within"),
    ):
        with pytest.raises(InputError) as caught:
            questions.invert(Path("results/sensor"), words | change)
        assert reason in str(caught.value)
