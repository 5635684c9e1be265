"""The pipeline as real processes: what it makes and tells, when it runs again, equal bytes for equal inputs."""

import hashlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

import surrogate
from solver import solve
from storage.netcdf import read_whole
from tests.studies import NAMES, data_set, edited, made
from tests.workflow.conftest import Copy, Project
from tests.workflow.dataset.test_similar import GROUPED
from workflow.learning import training
from workflow.run.provenance import ROOT

REPORT = "results/small/report.html"


@pytest.mark.parametrize("name", NAMES)
def test_every_study_of_the_project_is_planned_to_its_page(name: str, copy: Copy) -> None:
    done = copy("planned").run("meecontact", "run", name, "--dry-run")
    assert done.stdout.splitlines()[-1] in ("writing the page", "judging the verification")


def test_every_file_speaks_for_itself_to_foreign_programs(ran: Project) -> None:
    files = sorted((ran.folder / "results/small").rglob("*.nc"))
    assert len(files) >= 12
    for path in files:
        with netCDF4.Dataset(path) as file:
            assert file.title, path
            assert file.source.startswith("meecontact: "), path
            assert file.summary.startswith(file.title), path
            assert file.license == "MIT", path
            for name, variable in file.variables.items():
                assert "_FillValue" not in variable.ncattrs(), (path, name)
                assert variable.long_name, (path, name)
                # what UDUNITS reads as meant: names with whole exponents
                pattern = r"1|[A-Za-z]+(-?[2-9]|-1)?( [A-Za-z]+(-?[2-9]|-1)?)*"
                assert re.fullmatch(pattern, variable.units), (path, name)
                filters = variable.filters()
                assert [filters["blosc"], filters["zstd"]] == [False, False], (path, name)
    for name in ("quantities.nc", "fields/slab_1.nc", "cases/validation.nc"):
        attrs = read_whole(ran.folder / "results/small" / name, names=[]).attrs
        assert (attrs["composite"], attrs["phases"]) == ("fibrous", "BaTiO3, CoFe2O4")
        others = "charge = 0 C m-1, magnetic_charge = 0 Wb m-1, speed = 0 m s-1, datum = 1 m"
        assert attrs["defaults"].startswith(others)


def test_validation_and_calibration_are_on_cases_of_their_own(ran: Project) -> None:
    results = ran.folder / "results/small"
    data, model = read_whole(results / "validation.nc"), surrogate.load(results / "surrogate.nc")
    levels = read_whole(results / "quantities.nc")["volume_fraction"].values
    assert data.sizes["case"] == 200
    assert not np.isin(data["volume_fraction"].values, levels).any()
    inputs = {name: data[name] for name in model.box}
    exact = solve({**inputs, "composite": "fibrous"})
    for name in data["output"].values:
        row = data.sel(output=name)
        error = np.abs(model.predict(inputs)[name] - exact[name]).max() / np.ptp(exact[name].values)
        assert float(row["max_error"]) == pytest.approx(float(error), rel=1e-6)
        assert float(row["max_error"]) < 1e-3
    held, fresh = (read_whole(results / f"cases/{name}.nc") for name in ("calibration", "validation"))
    assert held.sizes["case"] == 3000
    assert not np.isin(fresh["load"].values, held["load"].values).any()
    exact = solve({name: held[name] for name in ("volume_fraction", "friction", "radius", "load")})
    np.testing.assert_allclose(held["peak_pressure"], exact["peak_pressure"], rtol=1e-12)
    for name in model.outputs_:
        answer = model.interval({name: fresh[name] for name in model.box})
        inside = (answer[f"{name}_lower"] <= fresh[name]) & (fresh[name] <= answer[f"{name}_upper"])
        assert float(data["coverage"].sel(output=name)) == pytest.approx(float(inside.mean()))
        # 200 cases: five standard deviations of a binomial share
        assert float(inside.mean()) == pytest.approx(0.95, abs=0.08)
    assert float(np.abs(data["raw_coverage"] - data["coverage"]).max()) > 0.02


def test_the_provenance_of_the_run_has_every_file_with_its_hash(ran: Project) -> None:
    results = ran.folder / "results/small"
    content = json.loads((results / "provenance.json").read_text(encoding="utf-8"))
    assert content["versions"]["numpy"] == np.__version__
    digests = content["results_sha256"]
    assert {"quantities.nc", "design.nc", "surrogate.nc"} <= digests.keys()
    for name, digest in digests.items():
        assert digest in {hashlib.sha256(file.read_bytes()).hexdigest() for file in results.rglob(name)}
    assert (results / "study.yaml").read_bytes() == (ran.folder / "config/small.yaml").read_bytes()


def test_results_of_another_checkout_are_not_taken_for_those_of_this_study(ran: Project, copy: Copy) -> None:
    project = copy("other")
    shutil.copytree(ran.folder / "results", project.folder / "disk")
    (project.folder / "results").symlink_to("disk")
    study = project.folder / "config/small.yaml"
    assert "report: results/small/report.html" in project.run("meecontact", "run", "small").stdout
    study.write_text(study.read_text(encoding="utf-8").replace("fibrous", "laminate"), encoding="utf-8")
    done = project.run("meecontact", "run", "small", check=False)  # Snakemake knows only that these files are there
    assert done.returncode == 2
    assert "meecontact: results/small: was made from another state of the study" in done.stderr
    assert "report:" not in done.stdout


@pytest.fixture(scope="module")
def again(ran: Project, copy: Copy) -> Project:
    """Another copy with the results of that run and what Snakemake knows of them."""
    project = copy("again", whole=True)
    for folder in ("results", ".snakemake"):
        shutil.copytree(ran.folder / folder, project.folder / folder)
    return project


def test_edits_rerun_what_depends_on_them(again: Project) -> None:
    """Edits of sources; those of a study's sections: tests/workflow/study/test_planned.py."""
    cards, designs = {"provenance", "report"}, {"target", "design", "figure_design", "solved"}
    learnt = {"surrogate", "validation", "figure_errors", "sensitivity", "figure_sensitivity"}
    exact = {"slab", "quantities", "card", "cases", "calibration", "figure_fields"}
    effects = {"effect", "figure_effect", "interior", "figure_interior", "sweeps"}
    for file, old, expected in (
        ("workflow/report/templates/study.html.j2", "<h2>Study", {"report"}),
        ("solver/halfplane/contact.py", '"""', cards | designs | learnt | effects | exact),
    ):
        assert again.planned_after([(file, old, f"{old}Edited. ")], REPORT) == expected, file


def test_equal_inputs_give_equal_bytes(ran: Project, again: Project) -> None:
    """A design, and a job with its Python; other files: faults/test_together.py."""
    names = [f"results/small/{name}" for name in ("sensitivity.nc", "design/sensor.nc", "design.csv")]
    for name in names:
        (again.folder / name).unlink()
    again.snakemake(names[0], cold=True)
    again.snakemake(*names)
    for name in names:
        assert (ran.folder / name).read_bytes() == (again.folder / name).read_bytes(), name


def test_snakemake_report_shows_the_figures_with_captions(ran: Project) -> None:
    ran.snakemake("--report", "snakemake-report.html", "--", REPORT)
    page = (ran.folder / "snakemake-report.html").read_text(encoding="utf-8")
    for word in ("its place among all designs", "Exact surface fields while one factor varies", "residuals"):
        assert word in page
    for file in ("run", "slurm"):  # Snakemake's report imports a package on which Snakemake does not depend
        assert "\npygments==" in (ROOT / f"requirements/{file}.txt").read_text(encoding="utf-8")


def test_as_a_module_with_a_prefix_it_sweeps_and_tells_times(copy: Copy) -> None:
    project = copy("module")
    (project.folder / "far").mkdir()
    (project.folder / "config/small.yaml").rename(project.folder / "far/mine.yaml")
    text = 'module meecontact:\n    snakefile: "workflow/Snakefile"\n    prefix: "mee"\n'
    text += '    config: {"study": "far/mine.yaml"}\n\nuse rule * from meecontact as mee_*\n'
    (project.folder / "Snakefile").write_text(text, encoding="utf-8")
    results = project.folder / "mee/results/mine"
    results.mkdir(parents=True)
    (results / ".left.partial").touch()
    project.snakemake("--nolock", "mee/results/mine/datacard.json")
    assert json.loads((results / "datacard.json").read_text(encoding="utf-8"))["seconds_of_jobs"] > 0
    assert not (results / ".left.partial").exists()


def test_snakemake_s_lint_finds_one_thing(ran: Project) -> None:
    # the pinned virtual environment is the software of every rule: the one finding that is meant to stay
    findings = re.findall(r"^ +\* (.*):$", ran.run("snakemake", "--lint", check=False).stderr, re.MULTILINE)
    assert set(findings) == {"Specify a conda environment or container for each rule."}


def test_a_run_ends_with_it_also_where_nothing_is_to_be_done(ran: Project) -> None:
    done = ran.run("meecontact", "run", "small", "--cores", "2")
    *lines, last = done.stdout.splitlines()
    assert last == "report: results/small/report.html"
    assert re.match(
        r"sensor +beyond linear theory; otherwise recommended within the model; a tilt of .+ times "
        r"+voltage per load 4[\d.]+ mV·m/N +volume fraction 0\.6\d+, radius 1",
        lines[1],
    )
    assert re.match("impossible +not reachable +stroke per volt", lines[3])
    assert "9070 % beyond the limit" in lines[4]
    assert "writing the page" not in done.stderr  # nothing was to be done


def test_plain_snakemake_tells_it_of_the_designs_that_it_makes(ran: Project, tmp_path: Path) -> None:
    project = Project(tmp_path / "copy")
    shutil.copytree(ran.folder, project.folder, symlinks=True)
    done = project.snakemake("--force", "--", "results/small/design.nc")
    told = "target impossible: not reachable: trailing_tension <= 1 MPa binds; the least violated design misses it by"
    assert done.stdout.splitlines().count(f"{told} 9075 %") == 1


FEW, DRAWN = ("limits", "films"), ("films",)
GROUPS = len(FEW)
#: Groups of one check each, in place of those that take minutes.
QUICK = """\
from verification.findings import Check, Curve, Findings, Sizes, Timing

def quick(sizes: Sizes) -> Findings:
    return Findings(
        "A title", "About it.", [Check("A check", "one, other", 2e-4, 1e-3, 0.5)],
        [Curve("film_elements", "a curve", "elements", [1.0, 2.0], [1e-2, 1e-4])],
        [Timing("a punch", 1e-12, 1e-2, 1e-3, 1e-6)],
    )

GROUPS = dict.fromkeys(NAMES, quick)
"""


def shortened(project: Project) -> None:
    """Two groups, one of them with curves, of one check each."""
    sections = project.folder / "workflow/study/sections.py"
    text = sections.read_text(encoding="utf-8")
    for name, few in (("CHECK_GROUPS", FEW), ("CONVERGING", DRAWN)):
        text, replaced = re.subn(rf"^{name} = \([^)]*\)", f"{name} = {few}", text, flags=re.MULTILINE)
        assert replaced == 1
    sections.write_text(text, encoding="utf-8")
    (project.folder / "verification/__init__.py").write_text(f"NAMES = {FEW}\n{QUICK}", encoding="utf-8")


def test_a_red_check_fails_the_run_and_the_page_shows_it(copy: Copy) -> None:
    project = copy("verification", whole=True)
    results = project.folder / "results/verification"
    shortened(project)
    project.run("meecontact", "run", "verification", "--cores", "2")
    page = (results / "report.html").read_text(encoding="utf-8")
    assert f"{GROUPS} of {GROUPS}" in page
    assert '<td class="bad">red</td>' not in page
    assert (results / "verdict.txt").read_text(encoding="utf-8") == f"{GROUPS} checks, all green\n"
    provenance = json.loads((results / "provenance.json").read_text(encoding="utf-8"))
    assert provenance["results_sha256"].keys() == {f"{group}.json" for group in FEW}
    edit = ("verification/findings.py", '"""', '"""Edited. ')  # a source that every group reaches
    planned = project.planned_after([edit], "results/verification/verdict.txt")
    assert planned == {"check", "figure_convergence", "provenance", "report", "verdict"}

    for file in (results / "verification").glob("*.json"):
        checks = json.loads(file.read_text(encoding="utf-8"))
        checks["checks"][0] |= {"error": 2e-2, "passed": False}
        file.write_text(json.dumps(checks), encoding="utf-8")
    done = project.run("meecontact", "run", "verification", "--cores", "2", check=False)
    assert done.returncode != 0
    assert f"RedError: {GROUPS} of {GROUPS} checks are red: A check (0.02 > 0.001)" in done.stdout + done.stderr
    page = (results / "report.html").read_text(encoding="utf-8")
    assert f"0 of {GROUPS}" in page
    assert page.count('<td class="bad">red</td>') == GROUPS
    assert not (results / "verdict.txt").exists()


PYTHON = Path(sys.prefix) / "referees/bin/python"


@pytest.mark.skipif(not PYTHON.exists(), reason="no referees (`make referees` installs them)")
def test_referees_find_no_fault_and_the_faults_of_a_broken_file(ran: Project, tmp_path: Path) -> None:
    grouped = tmp_path / "grouped"
    grouped.mkdir()
    study = made(edited(GROUPED, "slabs: 2", "precision: float32, slabs: 1"))
    data_set(study, grouped)
    surrogate.save(training.fit(study, read_whole(grouped / "quantities.nc")), grouped / "surrogate.nc")
    broken = tmp_path / "broken"
    broken.mkdir()
    with netCDF4.Dataset(shutil.copy(grouped / "fields/slab_0.nc", broken), "a") as file:
        file["voltage"].setncattr("units", "volts or so")
        file["contact_pressure"].setncattr("actual_range", [0.0, 1.0])  # of another type than the numbers
    folders = [ran.folder / "results/small", grouped, broken]
    command = [PYTHON, ROOT / "tests/referees.py", *folders]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    lines = [line for line in done.stdout.splitlines() if "not installed" not in line]
    sound = [f"{folder}: {name}: no faults" for folder in folders[:2] for name in ("conventions", "foreign")]
    assert lines[: len(sound)] == sound
    assert f"{broken}: conventions: 3 faults" in lines
    faults = "\n".join(lines[len(sound) :])
    assert 'units for voltage, "volts or so" are not recognized by UDUNITS' in faults
    assert "Attribute 'actual_range' (type: <class 'numpy.float64'>) and parent variable 'contact_pressure'" in faults
