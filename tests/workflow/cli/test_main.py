"""The command line as a user meets it: results, exit statuses, one-line complaints, nothing half written."""

import re
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import solver
import surrogate
from solver import solve, units
from surrogate import GridGP, Input, save
from tests.programs import Command
from tests.workflow.conftest import SMALL, Copy, Project
from workflow.cli import query


def test_lost_digits_are_told_in_one_line(command: Command) -> None:
    speed = float(solver.limiting_speed(solver.find("steel"))) * (1 - 1e-9)
    cases = command.file("cases.csv", f"material,radius,load,speed\nsteel,0.05,1e5,{speed!r}\n")
    warned, strained, wrote = command("solve", cases, "-o", cases.with_name("out.nc"))[1].splitlines()
    assert warned.startswith("meecontact: warning: steel: a speed so near the limiting one that rounding costs digits")
    assert strained.startswith("meecontact: warning: contact: beyond small strain: a half-width of 2.6")
    assert wrote.startswith("wrote ")


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
    header = "volume_fraction,friction,radius,load"
    table = command.file("at.csv", f"{header}\n0.6,0.2,0.1,1e4\n0.5,0,{1 / 30!r},5e3\n0.5,0,0.3,5e3\n")
    assert command("query", path, table, "-o", out, "--extrapolate")[1].endswith("3 points, 4 outputs\n")
    rows, model = pd.read_csv(out), surrogate.load(path)
    expected = model.predict(ONE).merge(model.interval(ONE))
    columns = [f"{name}{part}" for name in model.outputs_ for part in ("", "_std", "_lower", "_upper")]
    assert [*rows] == [*POINT, *columns, "extrapolated"]
    for name in columns:
        assert rows[name][0] == pytest.approx(float(expected[name][0]), rel=1e-9)
    assert rows["radius"].tolist() == [0.1, 1 / 30, 0.3]  # every digit
    assert rows["extrapolated"].tolist() == [0, 0, 1]
    said = command.refused("query", path, table, "-o", tmp_path / "other.csv", "--level", "0.99999")
    assert said.startswith("meecontact: --level: level 0.99999 is not between 0 and 0.999")
    assert not (tmp_path / "other.csv").exists()


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


ESCAPE = "\x1b]0;owned\x07\x1b[31m"


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A surrogate's file whose output and unit command the terminal."""
    inputs = [Input("radius", 0.01, 0.2, "log", "m"), Input("friction", 0.0, 0.5, units="1")]
    axes = {axis.name: axis.levels(5) for axis in inputs}
    values = np.exp(axes["friction"]) * np.log(axes["radius"])[:, None]
    attrs = {"units": f"Pa{ESCAPE}"}
    data = xr.Dataset({f"depth{ESCAPE}": (("radius", "friction"), values, attrs)}, coords=axes)
    path = tmp_path_factory.mktemp("points") / "surrogate.nc"
    save(GridGP(inputs=inputs, outputs=[f"depth{ESCAPE}"]).fit(data), path)
    return path


def test_names_cannot_command_the_terminal(model: Path, command: Command) -> None:
    shown, _ = command("query", model, "--at", "radius=0.3,friction=0.1", "--extrapolate")
    assert "extrapolated" in shown
    assert "depth\\x1b]0;owned\\x07\\x1b[31m" in shown
    assert all(line.isprintable() for line in shown.split("\n"))


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        ((-527.568446, -527.5708, -527.566), "-527.5684 [-527.5708, -527.5660] (95 %)"),
        ((0.0, -2e-9, 2e-9), "0.000 [-2.000e-09, 2.000e-09] (95 %)"),
        ((12345678.0, 12345668.0, 12345688.0), "12345678 [12345668, 12345688] (95 %)"),
        ((1.5, 1.5, 1.5), "1.5 [1.5, 1.5] (95 %)"),
        ((0.0, 0.0, 0.0), "0 [0, 0] (95 %)"),
        ((float("nan"),) * 3, "nan [nan, nan] (95 %)"),
    ],
)
def test_an_interval_is_shown_with_the_figures_that_it_has(numbers: tuple[float, float, float], expected: str) -> None:
    assert query.shown(*numbers) == expected
