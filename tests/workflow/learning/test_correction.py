"""Measured values: rows correct a surrogate, by the command ``learn`` too, and a read-out holds true loads."""

import json
import re
import shlex
import shutil
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
from numpy.typing import NDArray

from solver import solve
from surrogate import GridGP, save
from surrogate import load as load_surrogate
from surrogate.transforms.measured import CorrectedGP, Measurements
from tests.programs import Command
from workflow.cli import main, questions
from workflow.dataset import draws, factorial
from workflow.learning import correction, readout_trial
from workflow.run.provenance import ROOT
from workflow.study import uncertainty
from workflow.study.model import Study, load
from workflow.study.reading import InputError
from workflow.study.sections import Readout
from workflow.study.uncertainty import Constant

Array = NDArray[np.float64]

HALF_PLANE = """\
title: A half-plane
fixed: {composite: fibrous, friction: 0.2}
factors:
  volume_fraction: {low: 0.3, high: 0.8, levels: 9}
  radius: {low: 0.02, high: 0.1, levels: 4, scale: log}
  load: {low: 1e4, high: 1e5, levels: 4, scale: log}
surrogate: {outputs: [depth, voltage, stroke_per_volt, peak_pressure]}
"""


def study_of(text: str, folder: Path) -> tuple[Study, GridGP]:
    """A study and its surrogate, fitted here."""
    path = folder / "study.yaml"
    path.write_text(text, encoding="utf-8")
    study = load(path)
    data = factorial.training_data(study, factorial.exact(study, factorial.axes(study)))
    model = GridGP(inputs=factorial.inputs(study), outputs=study.output_names).fit(data)
    model.made_from_ = study.physics
    return study, model


@pytest.fixture(scope="module")
def half_plane(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, GridGP]:
    return study_of(HALF_PLANE, tmp_path_factory.mktemp("half_plane"))


def truth(study: Study, model: GridGP, known: list[Constant], z: Array, count: int, seed: int) -> tuple[Array, Array]:
    """Random points (n, d) and all exact outputs there (n, p), constants moved."""
    points = draws.points(study, count, (seed,))
    exact = factorial.training_data(study, factorial.exact(uncertainty.moved(study, known, z), points))
    X = np.stack([points[name].values for name in model.box], -1)
    return X, np.stack([exact[name].values for name in model.outputs_], -1)


def rows(X: Array, exact: Array, outputs: list[int], share: float, seed: int) -> Measurements:
    """Readings of outputs, with normal errors of a share of the values."""
    row, output = (index.ravel() for index in np.meshgrid(np.arange(len(X)), outputs, indexing="ij"))
    error = share * abs(exact[row, output])
    value = exact[row, output] + error * np.random.default_rng(seed).normal(size=len(row))
    return Measurements(X, row, output, value, error)


def test_intervals_hold_exact_answers_with_other_constants(half_plane: tuple[Study, GridGP]) -> None:
    study, model = half_plane
    known = uncertainty.uncertain(study)
    z = np.random.default_rng(0).normal(size=len(known))
    X, exact = truth(study, model, known, z, 140, 0)
    corrected, summary = correction.learn(study, model, rows(X[:40], exact[:40], [0, 1], 0.005, 0), known)
    lower, upper = corrected.interval_array(X[40:])
    # 100 cases x 4 outputs, of which two were never measured
    assert np.mean((lower <= exact[40:]) & (exact[40:] <= upper)) >= 0.92
    models = (corrected, model)
    after, before = (np.abs(one.predict_array(X[40:]) - exact[40:]).mean(axis=0) for one in models)
    assert (after / before)[:2].max() < 0.3
    moved = [(c["mean"] - true) / c["std"] for c, true in zip(summary["constants"], z, strict=True)]
    assert np.mean(np.abs(moved) < 1.96) > 0.85  # of 8 constants


def test_outliers_are_told_and_hide_no_constant(half_plane: tuple[Study, GridGP]) -> None:
    study, model = half_plane
    known = uncertainty.uncertain(study, {"BaTiO3 e33": 0.1})
    X, exact = truth(study, model, known, np.array([1.0]), 30, 2)
    good = rows(X, exact, [0, 1], 0.02, 2)
    wide = [int(np.argmax(np.where(good.output == q, good.error, 0))) for q in range(2)]
    off = good.value.copy()
    off[wide] += [12 * good.error[wide[0]], -9 * good.error[wide[1]]]
    _, outliers = correction.learn(study, model, Measurements(X, good.row, good.output, off, good.error), known)
    expected = {(int(good.row[k]) + 1, model.outputs_[good.output[k]]) for k in wide}
    assert {(entry["row"], entry["output"]) for entry in outliers["outliers"]} == expected
    first_words = f"row {good.row[wide[1]] + 1}, voltage: an outlier ("
    assert any(line.startswith(first_words) for line in correction.in_words(outliers))
    assert abs(outliers["constants"][0]["mean"] - 1.0) < 2.5 * outliers["constants"][0]["std"]


def test_one_row_is_learnt_from_as_the_page_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    section = (ROOT / "docs/learning.md").read_text(encoding="utf-8").split("\n## One row\n")[1].split("\n## ")[0]
    text, row, command, words = map(dedent, re.findall(r"(?:^    .*\n)+", section, re.MULTILINE))
    for folder in ("config", "results/study"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "row.csv").write_text(row, encoding="utf-8")
    surrogate = tmp_path / "results/study/surrogate.nc"
    save(study_of(text, tmp_path / "config")[1], surrogate)
    first, options = command.split(" row.csv --on results/sol_gel/surrogate.nc ")
    assert first == "make run STUDY=sol_gel\nmeecontact learn"
    assert main.main(["learn", str(tmp_path / "row.csv"), "--on", str(surrogate), *shlex.split(options)]) == 0
    assert capsys.readouterr().out == words


STUDY = """\
title: A half-plane
fixed: {volume_fraction: 0.5, friction: 0.2}
categories: {composite: [fibrous, laminate]}
factors:
  radius: {low: 0.02, high: 0.1, levels: 5, scale: log}
  load: {low: 1e4, high: 1e5, levels: 5, scale: log}
surrogate: {outputs: [depth, contact_trailing, voltage]}
"""
HEADER = "radius [cm],load,composite,depth,depth_std,voltage [kV]\n"


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a study, its surrogate, and rows that were measured on a softer ceramic."""
    folder = tmp_path_factory.mktemp("learn")
    (folder / "config").mkdir()
    (folder / "results/study").mkdir(parents=True)
    study, model = study_of(STUDY, folder / "config")
    save(model, folder / "results/study/surrogate.nc")
    known = uncertainty.uncertain(study, {"BaTiO3 stiffness": None})
    points = draws.points(study, 15, (1,))
    exact = factorial.exact(uncertainty.moved(study, known, np.array([-1.5])), points).sel(composite="laminate")
    lines = ["# made up\n", HEADER]
    read = [points["radius"], points["load"], exact["depth"], exact["voltage"]]
    for k, (radius, force, depth, voltage) in enumerate(zip(*(column.values.tolist() for column in read), strict=True)):
        depth *= 1 + 0.002 * float(np.random.default_rng(k).normal())
        voltage_text = repr(1e-3 * voltage * (1 + 0.003 * float(np.sin(9 * k)))) if k % 3 else ""
        lines.append(f"{100 * radius!r},{force!r},laminate,{depth!r},{0.002 * depth!r},{voltage_text}\n")
    (folder / "rows.csv").write_text("".join(lines), encoding="utf-8")
    return folder


def asked(project: Path, *words: str | Path, rows: str = "rows.csv") -> list[str | Path]:
    surrogate = project / "results/study/surrogate.nc"
    return ["learn", project / rows, "--on", surrogate, "--uncertain", "BaTiO3 stiffness", *words]


def test_what_was_learnt_is_said_and_a_query_answers_with_it(project: Path, command: Command) -> None:
    out = project / "results/study/corrected.nc"
    printed, said = command(*asked(project, "--json"))
    summary = json.loads(printed)
    assert (summary["rows"], summary["values"]) == (15, 25)
    (stiffness,) = summary["constants"]
    assert stiffness["name"] == "BaTiO3 stiffness"
    assert stiffness["mean"] == pytest.approx(-1.5, abs=0.3)
    assert f"wrote {out}" in said
    model = load_surrogate(out)
    assert isinstance(model, CorrectedGP)
    assert model.learnt_.startswith("15 rows, 25 measured values\nBaTiO3 stiffness: moved by -1.")
    paths = (out, out.with_name("surrogate.nc"))
    answers = [command("query", path, "--at", "radius=0.05,load=5e4")[0] for path in paths]
    extent = [float(text.split("contact_trailing[fibrous]")[1].split()[0]) for text in answers]
    assert extent[0] > 1.01 * extent[1]  # never measured: the contact is wider on what is softer
    assert command(*asked(project, "-o", project / "again.nc"))[0].splitlines() == model.learnt_.split("\n")
    assert (project / "again.nc").read_bytes() == out.read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("radius [cm]", "radius [V]", "column 'radius': unit mismatch: 'V' does not measure what 'm' measures"),
        ("voltage [kV]", "volts", "column 'volts': unknown column; did you mean"),
        ("radius [cm]", "radius", "is outside the trained box [0.02, 0.1] m"),
        (",depth,", ",contact_trailing,", "depth_std: without a column depth"),
        (",laminate,", ",AlScN,", "composite: 'AlScN'; must be one of fibrous, laminate"),
        (HEADER, HEADER + "3,3e4,laminate,1e-6,-1e-9,\n", "line 3: depth_std: -1e-09: must be a positive number"),
        (HEADER, HEADER + "3,3e4,laminate,1e-6,1e300,\n", "depth[laminate]: an error of 1e+300 m; must be at"),
        ("voltage [kV]", "voltage [nV]", "voltage[laminate]: measured values are 1.1e-12 times"),
        ("--uncertain", "CoFe2O4 stifness", "did you mean 'CoFe2O4 stiffness'?"),
        ("--uncertain", "CoFe2O4 stiffness=x", "is not a number above 0 and up to 0.5"),
    ],
)
def test_bad_rows_and_constants_are_refused(old: str, new: str, reason: str, project: Path, command: Command) -> None:
    text = (project / "rows.csv").read_text(encoding="utf-8")
    (project / "bad.csv").write_text(text.replace(old, new), encoding="utf-8")
    before = sorted(project.rglob("*"))
    assert reason in command.refused(*asked(project, *([old, new] if old == "--uncertain" else []), rows="bad.csv"))
    assert sorted(project.rglob("*")) == before


def test_a_surrogate_of_another_study_is_refused(project: Path, command: Command, tmp_path: Path) -> None:
    shutil.copytree(project, tmp_path, dirs_exist_ok=True)
    study = tmp_path / "config/study.yaml"
    study.write_text(study.read_text(encoding="utf-8").replace("friction: 0.2", "friction: 0.1"), encoding="utf-8")
    assert "was made from another state of the study" in command.refused(*asked(tmp_path))


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
    at: dict[str, float | str] = {"volume_fraction": 0.67, "radius": 0.12}
    readout = Readout(measured=measured, infer=["load", "friction"], at=at, cases=cases)
    tried = readout_trial.trial(study, readout, model)
    # 3.2 standard deviations; 2,000 were measured to hold 95.0 and 95.2 % (docs)
    assert tried["coverage"].values == pytest.approx(0.95, abs=3.2 * np.sqrt(0.95 * 0.05 / cases))
    assert float(tried["width"].sel(factor="load")) < 0.02
    assert np.all((tried["low"] <= tried["mean"]) & (tried["mean"] <= tried["high"]))


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
        ({"measured": ["capacitance_per_length=1e-9+-1e-11"]}, "capacitance_per_length: is not learned by the study; "),
        ({"at": ["volume_fraction=0.67,radius=3"]}, "--at: radius = 3 is not within"),
    ):
        with pytest.raises(InputError) as caught:
            questions.invert(Path("results/sensor"), words | change)
        assert reason in str(caught.value)
