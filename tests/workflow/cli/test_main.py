"""The command line as a user meets it: results, exit statuses, one-line complaints, nothing half written."""

import re
from importlib.metadata import version
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr

import solver
import surrogate
from solver import solve, units
from tests.programs import Command
from tests.workflow.conftest import SMALL, Copy, Project


def test_lost_digits_are_told_in_one_line(command: Command) -> None:
    speed = float(solver.limiting_speed(solver.find("steel"))) * (1 - 1e-9)
    cases = command.file("cases.csv", f"material,radius,load,speed\nsteel,0.05,1e5,{speed!r}\n")
    warned, strained, wrote = command("solve", cases, "-o", cases.with_name("out.nc"))[1].splitlines()
    assert warned.startswith("meecontact: warning: steel: a speed so near the limiting one that rounding costs digits")
    assert strained.startswith("meecontact: warning: contact: beyond small strain: a half-width of 2.6")
    assert wrote.startswith("wrote ")


@pytest.mark.parametrize(
    ("name", "rows", "options", "says"),
    [
        ("solve", "steel,0.1,1e4\nstel,0.1,1e4", [], "line 3: material: 'stel' is unknown; did you mean 'steel'?"),
        ("solve", "steel,0.1,1e4", ["--positions=0,x"], "--positions: 'x' is not a number"),
        ("solve", "steel,0.1,1e4", ["--positions=nan"], "positions: nan"),
        ("interior", "BaTiO3,0.05,1e5", ["--x=0", "--y=0.5"], "y: 0.5 is above the surface; y/h must be <= 0"),
        ("interior", "BaTiO3,0.05,1e5", ["--x=0,a", "--y=-1"], "--x: 'a' is not a number"),
        ("interior", "BaTiO3,0.05,1e5", ["--x=0", "--y=-1", "--fields=von_mise"], "fields: 'von_mise' is not one of"),
        ("interior", "BaTiO3,0.05,1e5", ["--x=1", "--y=-1e-300"], "line 2: von_mises: not finite for these factors"),
    ],
)
def test_bad_tables_positions_and_grids_are_refused(
    command: Command, name: str, rows: str, options: list[str], says: str
) -> None:
    cases = command.file("cases.csv", f"material,radius,load\n{rows}\n")
    assert says in command.refused(name, cases, "-o", cases.with_name("out.nc"), *options)
    assert sorted(cases.parent.iterdir()) == [cases]


def test_results_that_are_not_there_are_named_with_those_that_are(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    said = command.refused("query", "results/WRONG", "--at", "load=1")
    assert "WRONG: no such file or folder; must be results/STUDY" in said
    for name in ("one", "two"):
        (tmp_path / "results" / name).mkdir(parents=True)
        (tmp_path / "results" / name / "surrogate.nc").touch()
    said = command.refused("query", "results/tow", "--at", "load=1")
    assert "results/tow: no such file or folder" in said
    assert "did you mean 'two'? allowed: one, two; `meecontact run STUDY` makes one" in said
    (tmp_path / "results" / "one" / "report.html").touch()
    page = command.refused("query", "results/one/report.html", "--at", "load=1")
    assert "results/one/report.html: is a page, no surrogate; results/one/surrogate.nc is" in page


def test_missing_files_and_folders_are_named(tmp_path: Path, command: Command) -> None:
    absent = tmp_path / "absent.csv"
    assert f"{absent}: No such file" in command.refused("solve", absent, "-o", tmp_path / "out.nc")
    cases = command.file("cases.csv", "material,radius,load\nsteel,0.1,1e4\n")
    line = command.refused("solve", cases, "-o", tmp_path / "absent" / "out.nc")
    assert f"{tmp_path / 'absent'} does not exist" in line
    assert f"surrogate: {tmp_path}: holds no surrogate.nc" in command.refused("query", tmp_path, "--at", "load=1")
    assert "'slove' is unknown; did you mean 'solve'?" in command.refused("slove")
    assert "-o/--output" in command.refused("interior", cases, "--x=0", "--y=-1")


POINT = {"volume_fraction": 0.6, "friction": 0.2, "radius": 0.1, "load": 1e4}
AT = ",".join(f"{name}={value}" for name, value in POINT.items())
ONE = {name: xr.DataArray([value], dims="point") for name, value in POINT.items()}


@pytest.mark.parametrize(("options", "level"), [([], 0.95), (["--level", "0.8"], 0.8)])
def test_query_prints_what_the_surrogate_says(ran: Project, command: Command, options: list[str], level: float) -> None:
    model = surrogate.load(ran.folder / "results/small/surrogate.nc")
    out, _ = command("query", ran.folder / "results/small", "--si", "--at", AT, *options)
    printed = {line.split()[0]: line.rstrip() for line in out.splitlines()}
    expected = model.predict(ONE).merge(model.interval(ONE, level))
    assert list(printed) == list(model.outputs_)
    for name, line in printed.items():
        units, share = re.escape(model.attrs_[name]["units"]), f"{100 * level:g}"
        match = re.fullmatch(rf"{name} +(\S+) \[(\S+), (\S+)\] {units} \({share} %\)", line)
        assert match, line
        ends = [float(expected[f"{name}{part}"][0]) for part in ("", "_lower", "_upper")]
        assert [float(text) for text in match.groups()] == pytest.approx(ends, abs=0.0255 * (ends[2] - ends[1]))


def test_query_writes_what_the_surrogate_says(ran: Project, tmp_path: Path, command: Command) -> None:
    path, out = ran.folder / "results/small/surrogate.nc", tmp_path / "out.csv"
    table = command.file("at.csv", "volume_fraction,friction,radius,load\n0.6,0.2,0.1,1e4\n0.5,0,0.02,5e3\n")
    command("query", path, table, "-o", out)
    rows, model = pd.read_csv(out), surrogate.load(path)
    expected = model.predict(ONE).merge(model.interval(ONE))
    columns = [f"{name}{part}" for name in model.outputs_ for part in ("", "_std", "_lower", "_upper")]
    assert [*rows] == [*POINT, *columns]
    for name in columns:
        assert rows[name][0] == pytest.approx(float(expected[name][0]), rel=1e-9)
    assert rows["radius"].tolist() == [0.1, 0.02]
    out.unlink()
    for level in ("1", "0", "nan", "0.99999"):
        said = command.refused("query", path, table, "-o", out, "--level", level)
        assert said.startswith(f"meecontact: --level: level {float(level):g} is not between 0 and 0.999")
        assert not out.exists()


def test_query_gives_the_exact_answer_beside_its_own(
    ran: Project, tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ran.folder)
    path, out = "results/small/surrogate.nc", tmp_path / "out.csv"
    command("query", path, "--at", AT, "--exact", "small", "-o", out)
    row, exact = pd.read_csv(out).iloc[0], solve(POINT)
    for name in ("voltage_per_load", "peak_pressure"):
        assert row[f"{name}_exact"] == pytest.approx(float(exact[name]), rel=1e-13)
    printed, _ = command("query", path, "--at", AT, "--exact", "small")
    assert f"exact {float(exact['peak_pressure']) / 1e6:.10g} MPa" in printed
    assert "the study's factors are" in command.refused("query", path, "--at", AT, "--exact", "quickstart")
    other = command.file("another.yaml", SMALL.replace("fibrous", "laminate"))
    line = command.refused("query", path, "--at", AT, "--exact", other)
    assert f"--exact: {other}: the surrogate was made from another study, or another state of it" in line
    assert "study: 'smal' is unknown" in command.refused("query", path, "--at", AT, "--exact", "smal")


def test_the_installed_command_exits_with_the_status(copy: Copy, command: Command) -> None:
    assert command("--version") == (f"meecontact {version('meecontact')}\n", "")
    project = copy("command")
    done = project.run("meecontact", "material", "stel", check=False, cold=True)
    assert done.returncode == 2
    assert done.stderr.startswith("meecontact: material: 'stel' is unknown; did you mean 'steel'?")
    assert project.run("meecontact", "--help").stdout.startswith("usage: meecontact")


@pytest.mark.parametrize("flux", ["", ",total_flux=1 nWb"])
def test_one_case_is_printed_in_engineering_units(flux: str, command: Command) -> None:
    out, _ = command("solve", "--at", f"material=PZT-4,profile=sphere,radius=5 mm,force=1 N{flux}")
    quantities, notes = (part.splitlines() for part in out.split("\n\n"))
    assert "left out: Adhesion widens the contact by 2.3 %; 50 mJ/m² holds the ball with 1.2 mN." in notes
    magnetic_default = ["magnetic conducting"] if flux else []
    defaults = ["punch rigid", "friction 0", "electric conducting", *magnetic_default, "total_charge 0"]
    assert notes[0] == f"defaults: {', '.join(defaults)}"
    printed = dict(line.split(maxsplit=1) for line in quantities)
    case = {"material": "PZT-4", "profile": "sphere", "radius": 5e-3, "force": 1.0}
    exact = solver.solve(case | ({"total_flux": 1e-9} if flux else {}))
    magnetic = {
        str(name) for name, array in exact.items() if {"Wb", "A", "T"} & set(array.units.replace("-1", "").split())
    }
    assert len(magnetic) == 7
    assert printed.keys() == {str(name) for name in exact} - (set() if flux else magnetic)
    for name, text in printed.items():  # six digits are printed
        assert units.in_si(text, exact[name].units) == pytest.approx(float(exact[name]), rel=5.1e-6), name


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "give either a table CASES.csv or --at"),
        (["--at", "material=PZT-4,radius"], "'radius' is not of the form NAME=VALUE"),
        (["--at", "material=PZT-4,radius=5 kg,load=1 N/m"], "--at: radius: '5 kg': unit mismatch"),
        (["--at", "material=my.yaml,radius=5 mm,load=1 N/m"], "; an own one: --materials FILE.yaml"),
        (["--at", "material=PZT-4,radius=nan,load=1 N/m"], "radius: 'nan' is not a finite number"),
        (["--at", "material=PZT-4 radius=5 mm,load=1 N/m"], "two equal signs; commas stand between NAME=VALUE"),
        (["--at", "material=PZT-4,radius=5 mm,lod=1 N/m"], "did you mean 'load'?"),
        (["--at", "material=PZT-4,radius=5 mm,load=1 N/m", "--positions", "0"], "fields need -o"),
        (["examples/cases.csv"], "5 cases need -o"),
    ],
)
def test_a_printed_case_is_refused_in_one_line(words: list[str], said: str, command: Command) -> None:
    assert said in command.refused("solve", *words)
