"""Measured rows correct a study's surrogate: exact answers of the solver with other constants, and errors added."""

import re
import shlex
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
from numpy.typing import NDArray

from surrogate import GridGP, save
from surrogate.transforms.measured import Measurements
from workflow.cli import main
from workflow.dataset import draws, factorial
from workflow.learning import correction
from workflow.study import uncertainty
from workflow.study.model import Study, load
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
    return Measurements(
        X, row, output, exact[row, output] + error * np.random.default_rng(seed).normal(size=len(row)), error
    )


def test_intervals_hold_exact_answers_with_other_constants(half_plane: tuple[Study, GridGP]) -> None:
    study, model = half_plane
    known = uncertainty.uncertain(study)
    z = np.random.default_rng(0).normal(size=len(known))
    X, exact = truth(study, model, known, z, 140, 0)
    corrected, summary = correction.learn(study, model, rows(X[:40], exact[:40], [0, 1], 0.005, 0), known)
    lower, upper = corrected.interval_array(X[40:])
    # 100 cases x 4 outputs, of which two were never measured
    assert np.mean((lower <= exact[40:]) & (exact[40:] <= upper)) >= 0.92
    after, before = (
        np.abs(surrogate.predict_array(X[40:]) - exact[40:]).mean(axis=0) for surrogate in (corrected, model)
    )
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
    assert {(entry["row"], entry["output"]) for entry in outliers["outliers"]} == {
        (int(good.row[k]) + 1, model.outputs_[good.output[k]]) for k in wide
    }
    assert any(
        line.startswith(f"row {good.row[wide[1]] + 1}, voltage: an outlier (") for line in correction.in_words(outliers)
    )
    assert abs(outliers["constants"][0]["mean"] - 1.0) < 2.5 * outliers["constants"][0]["std"]


PAGE = Path(__file__).parents[3] / "docs/learning.md"


def test_one_row_is_learnt_from_as_the_page_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    section = PAGE.read_text(encoding="utf-8").split("\n## One row\n")[1].split("\n## ")[0]
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
