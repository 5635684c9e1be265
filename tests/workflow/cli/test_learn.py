"""``meecontact learn``: from a table of measured rows to a corrected surrogate that ``query`` answers with."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from surrogate import load, save
from surrogate.transforms.measured import CorrectedGP
from tests.programs import Command
from tests.workflow.learning.test_correction import study_of
from workflow.dataset import draws, factorial
from workflow.study import uncertainty

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
    model = load(out)
    assert isinstance(model, CorrectedGP)
    assert model.learnt_.startswith("15 rows, 25 measured values\nBaTiO3 stiffness: moved by -1.")
    answers = [
        command("query", path, "--at", "radius=0.05,load=5e4")[0] for path in (out, out.with_name("surrogate.nc"))
    ]
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
