"""Points of a table or of the command line, and what a surrogate answers, refuses and writes."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from surrogate import GridGP, Input, save
from tests.programs import Command
from workflow.cli import query

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


@pytest.mark.parametrize(
    ("point_text", "says"),
    [
        ("radius=-1,friction=0.1", "radius = -1 (trained within [0.01, 0.2] m): no finite answer so far outside"),
        ("radius=0.1,friction=1e200", "friction = 1e+200 (trained within [0, 0.5]): no finite answer so far"),
        ("radius=1_0,friction=0.1", "radius: '1_0' is not a finite number"),
        ("radius=\u0663,friction=0.1", "is not a finite number"),
        ("radius=nan,friction=0.1", "nan"),
        ("radius=0.1", "friction: missing; the surrogate needs radius, friction"),
        ("radius=0.1,raduis=0.2", "raduis: not an input of the surrogate; did you mean 'radius'?"),
        ("radius=0.1,material=PZT-4", "material: not an input of the surrogate; allowed: radius, friction"),
        ("radius=0.1,radius=0.2", "radius: given twice"),
        ("radius", "'radius' is not of the form NAME=VALUE"),
        ("radius=5kg", "radius: '5kg': unit mismatch: 'kg' does not measure what 'm' measures"),
    ],
)
def test_no_answer_is_no_number(model: Path, command: Command, point_text: str, says: str) -> None:
    assert says in command.refused("query", model, "--at", point_text, "--extrapolate")


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ("0.1,0.1\n0.3,0.2", "line 3: radius = 0.3 is outside the trained box [0.01, 0.2] m"),
        ("0.1,0.1\n\n,0.2", "line 4: radius: empty; must be a number"),
        ("0.1,0.1\n0.1,1e999", "line 3: friction: inf is not a finite number"),
    ],
)
def test_a_bad_point_has_its_line(model: Path, command: Command, rows: str, says: str) -> None:
    table = command.file("at.csv", f"radius,friction\n{rows}\n")
    assert f"{table}: {says}" in command.refused("query", model, table, "-o", table.with_name("out.csv"))
    assert list(table.parent.iterdir()) == [table]


def test_a_point_outside_the_box_is_refused_or_flagged(model: Path, command: Command) -> None:
    words = ["query", str(model), "--at", "radius=0.3,friction=0.1"]
    assert "radius = 0.3 is outside the trained box" in command.refused(*words)
    assert "extrapolated" in command(*words, "--extrapolate")[0]


def test_a_table_is_answered_with_every_digit(model: Path, command: Command) -> None:
    points = np.random.default_rng(0).uniform([0.01, 0.0], [0.3, 0.5], (5000, 2))
    rows = "".join(f"{r!r},{f!r}\n" for r, f in points.tolist())
    table = command.file("at.csv", f"radius,friction\n{rows}")
    out = table.with_name("out.csv")
    printed, said = command("query", model, table, "-o", out, "--extrapolate")
    doubt, wrote = said.splitlines()
    assert (printed, wrote) == ("", f"wrote {out}: 5000 points, 1 outputs")
    assert doubt.startswith("not calibrated: ")
    with out.open(encoding="utf-8", newline="") as file:
        header, *answers = csv.reader(file)
    assert header[:2] == ["radius", "friction"]
    np.testing.assert_array_equal(np.array([row[:2] for row in answers], dtype=float), points)
    assert [row[-1] for row in answers] == [str(int(r > 0.2 * (1 + 1e-9))) for r in points[:, 0]]


def test_names_cannot_command_the_terminal(model: Path, command: Command) -> None:
    shown, _ = command("query", model, "--at", "radius=0.1,friction=0.1")
    assert "depth\\x1b]0;owned\\x07\\x1b[31m" in shown
    assert all(line.isprintable() for line in shown.split("\n"))
    text = '"\\e]0;owned\\a\\e[31m \\u202e\\n steel: admissible"'
    constants = "c11: 166e9\nc13: 78e9\nc33: 162e9\nc44: 43e9\n"
    material = command.file("own.yaml", f"name: {text}\nnote: {text}\nsource: {text}\n{constants}")
    assert command.refused("material", material).strip().isprintable()


def test_no_input_or_device_is_replaced(model: Path, tmp_path: Path, command: Command) -> None:
    cases = command.file("cases.csv", "material,radius,load\nsteel,0.05,1e5\n")
    points = command.file("points.csv", "radius,friction\n0.1,0.1\n")
    before, pipe, link = model.read_bytes(), tmp_path / "pipe.nc", tmp_path / "link.nc"
    os.mkfifo(pipe)
    (folder := tmp_path / "folder.nc").mkdir()
    link.symlink_to(cases)
    reason = "is an input of this command, so it is not replaced"
    other = "not a regular file, so it is not replaced"
    refused: list[tuple[list[str | Path], Path, str]] = [
        (["solve", cases], link, reason),
        (["query", model, points], points, reason),
        (["solve", cases], pipe, other),
        (["solve", cases], folder, other),
    ]
    for words, out, says in refused:
        assert f"{out}: {says}" in command.refused(*words, "-o", out)
    for out in (model, Path("/dev/null")):
        assert f"'{out}': must end in .csv" in command.refused("query", model, points, "-o", out)
    assert "not a regular file" in command.refused("query", pipe, "--at", "radius=0.1,friction=0.1")
    assert "not a regular file" in command.refused("material", pipe)
    assert model.read_bytes() == before
    assert pipe.is_fifo()
    assert Path("/dev/null").is_char_device()


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
