"""``meecontact learn``: from a table of measured rows to a corrected surrogate that ``query`` answers with."""

import json
from pathlib import Path

import numpy as np
import pytest

from surrogate import load, save
from surrogate.transforms.measured.corrected import CorrectedGP
from tests.workflow.learning.test_correction import study_of
from workflow.cli import main
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


def asked(project: Path, *words: str, rows: str = "rows.csv") -> int:
    surrogate = str(project / "results/study/surrogate.nc")
    return main.main(["learn", str(project / rows), "--on", surrogate, "--uncertain", "BaTiO3 stiffness", *words])


def test_what_was_learnt_is_said_and_a_query_answers_with_it(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = project / "results/study/corrected.nc"
    assert asked(project, "--json") == 0
    said = capsys.readouterr()
    summary = json.loads(said.out)
    assert (summary["rows"], summary["values"]) == (15, 25)
    (stiffness,) = summary["constants"]
    assert stiffness["name"] == "BaTiO3 stiffness"
    assert stiffness["mean"] == pytest.approx(-1.5, abs=0.3)
    assert f"wrote {out}" in said.err
    model = load(out)
    assert isinstance(model, CorrectedGP)
    assert model.learnt_.startswith("15 rows, 25 measured values\nBaTiO3 stiffness: moved by -1.")
    assert main.main(["query", str(out), "--at", "radius=0.05,load=5e4"]) == 0
    after = capsys.readouterr().out
    assert main.main(["query", str(project / "results/study/surrogate.nc"), "--at", "radius=0.05,load=5e4"]) == 0
    before = capsys.readouterr().out
    extent = [float(text.split("contact_trailing[fibrous]")[1].split()[0]) for text in (after, before)]
    assert extent[0] > 1.01 * extent[1]  # never measured: the contact is wider on what is softer
    assert asked(project, "-o", str(project / "again.nc")) == 0
    assert capsys.readouterr().out.splitlines() == model.learnt_.split("\n")
    assert (project / "again.nc").read_bytes() == out.read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("radius [cm]", "radius [V]", "column 'radius': unit mismatch: 'V' does not measure what 'm' measures"),
        ("voltage [kV]", "voltage [km]", "column 'voltage': unit mismatch: 'km' does not measure what 'V' measures"),
        ("composite,", "composite [1],", "column 'composite': holds names, which have no unit"),
        ("voltage [kV]", "volts", "column 'volts': unknown column; did you mean"),
        ("voltage [kV]", "capacitance_per_length", "column 'capacitance_per_length': unknown column"),
        ("voltage [kV]", "slope", "slope: neither an input of the surrogate nor learned by it"),
        ("radius [cm]", "radius", "is outside the trained box [0.02, 0.1] m"),
        (",depth,", ",contact_trailing,", "depth_std: without a column depth"),
        (",depth,depth_std,voltage [kV]", ",friction,speed,datum", "friction: neither an input"),
        (",composite,", ",material,", "material: neither an input"),
        ("load,", "speed,", "speed: neither an input"),
        (",laminate,", ",AlScN,", "composite: 'AlScN'; must be one of fibrous, laminate"),
        (",laminate,", ",,", "composite: empty; must be one of fibrous, laminate"),
        ("voltage [kV]", "voltage [nV]", "voltage[laminate]: measured values are 1.1e-12 times"),
    ],
)
def test_rows_that_do_not_fit_are_refused(
    old: str, new: str, reason: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (project / "rows.csv").read_text(encoding="utf-8")
    (project / "bad.csv").write_text(text.replace(old, new), encoding="utf-8")
    before = sorted(project.rglob("*"))
    assert asked(project, rows="bad.csv") == 2
    said = capsys.readouterr()
    assert reason in said.err
    assert said.err.count("meecontact: ") == 1
    assert said.out == ""
    assert sorted(project.rglob("*")) == before


SOL_GEL = """\
title: A ball on a sol-gel film
fixed: {surroundings: insulated,
        material: PZT-4, profile: sphere, punch: tungsten_carbide, radius: 500 um, thickness: 700 nm, base: silicon,
        magnetic: insulating}
factors: {force: {low: 0.1 N, high: 2 N, levels: 6, scale: log}}
surrogate: {outputs: [charge_per_force]}
"""


def test_one_row_of_a_film_tells_e33_over_c33_and_not_the_two_apart(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The PZT film of `config/measured.yaml`, 39 to 45 pC/N: the example of docs/learning.md."""
    for folder in ("config", "results/study"):
        (tmp_path / folder).mkdir(parents=True)
    _, model = study_of(SOL_GEL, tmp_path / "config")
    save(model, tmp_path / "results/study/surrogate.nc")
    (tmp_path / "row.csv").write_text(
        "force,charge_per_force [pC/N],charge_per_force_std [pC/N]\n0.5,42,3\n", encoding="utf-8"
    )
    words = ["learn", str(tmp_path / "row.csv"), "--on", str(tmp_path / "results/study/surrogate.nc"), "--json"]
    assert main.main([*words, "--uncertain", "PZT-4 e33=50%,PZT-4 c33=30%"]) == 0
    summary = json.loads(capsys.readouterr().out)
    e33, c33 = summary["constants"]
    (together,) = summary["known_together"]
    assert e33["mean"] + e33["std"] < 0
    assert min(e33["std"], c33["std"]) > 0.5
    # the charge goes with e33 and against c33, and hardly with what leaves their ratio
    assert together["combination"].startswith("+0.")
    assert " PZT-4 e33 -0." in together["combination"]
    assert together["posterior_over_prior"] < 0.4
    assert summary["discrepancies"] == []
    corrected = load(tmp_path / "results/study/corrected.nc")
    assert isinstance(corrected, CorrectedGP)
    said = corrected.learnt_.split("\n")
    assert said[0] == "1 row, 1 measured value"
    assert said[-1].startswith("fewer than 10 rows: constants, a discrepancy, errors and outliers are not told apart")
    after = float(corrected.predict_array(np.array([[0.5]]))[0, 0])
    assert after == pytest.approx(42e-12, abs=2 * 3e-12 + 0.1 * 42e-12)


def test_errors_that_are_not_positive_and_no_rows_are_refused(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = (project / "rows.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    cells = lines[3].split(",")
    cells[4] = "-1e-9"
    vague = [*cells[:4], "1e300", *cells[5:]]
    for text, reason in (
        ("".join([*lines[:3], ",".join(cells), *lines[4:]]), "line 4: depth_std: -1e-09: must be a positive number"),
        ("".join([*lines[:3], ",".join(vague), *lines[4:]]), "depth[laminate]: an error of 1e+300 m; must be at most"),
        ("".join([*lines[:2], "3,2e4,laminate,,,\n"]), "0 rows with a measured value; must be 1 to 1000"),
    ):
        (project / "bad.csv").write_text(text, encoding="utf-8")
        assert asked(project, rows="bad.csv") == 2
        assert reason in capsys.readouterr().err


def test_instruments_that_do_not_fit_are_refused(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = sorted(project.rglob("*"))
    for word, reason in (
        ("voltage=3%", "--instrument: 'voltage' is not QUANTITY_gain or QUANTITY_offset of one of depth,"),
        ("charge_gain=3%", "--instrument: 'charge_gain' is not QUANTITY_gain"),
        ("voltage_gain=90%", "--instrument: voltage_gain: '90%' is not a number above 0 and up to 0.5 (50 %)"),
        ("voltage_offset=1um", "--instrument: voltage_offset: unit mismatch: '1um'"),
        ("voltage_offset=2%", "--instrument: voltage_offset: '2%' is not a positive size with a unit"),
        ("voltage_gain=1%,voltage_gain=2%", "--instrument: voltage_gain: given twice"),
        ("voltage_gain=1%,", "--instrument: a name is missing in 'voltage_gain=1%,'"),
        ("contact_trailing_gain=1%", "contact_trailing_gain: no row holds a measured contact_trailing"),
    ):
        assert asked(project, "--instrument", word) == 2
        said = capsys.readouterr()
        assert reason in said.err
        assert said.out == ""
    assert sorted(project.rglob("*")) == before


def test_other_surrogates_and_constants_are_refused(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert asked(project, "--uncertain", "CoFe2O4 stifness") == 2
    assert "did you mean 'CoFe2O4 stiffness'?" in capsys.readouterr().err
    for word in ("CoFe2O4 stiffness=2", "CoFe2O4 stiffness=x", "CoFe2O4 stiffness=0"):
        assert asked(project, "--uncertain", word) == 2
        assert "is not a number above 0 and up to 0.5" in capsys.readouterr().err
    model = load(project / "results/study/surrogate.nc")
    model.made_from_ = "another study"
    (project / "results/other").mkdir(exist_ok=True)
    save(model, project / "results/study/other.nc")
    assert main.main(["learn", str(project / "rows.csv"), "--on", str(project / "results/study/other.nc")]) == 2
    assert "was made from another state of the study" in capsys.readouterr().err
    assert asked(project, "-o", str(project / "results/study/surrogate.nc")) == 2
    assert "is an input of this command" in capsys.readouterr().err
