"""The command line as a user meets it: results, questions in words, exit statuses, one-line complaints."""

import json
import re
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import solver
import surrogate
from solver import solve, units
from surrogate import GridGP, Input
from tests.programs import Command
from tests.studies import made
from tests.workflow.cli.test_refusals import two_inputs
from tests.workflow.conftest import SMALL, Copy, Project
from workflow.cli import query, questions
from workflow.design.verdict.answer import Answer
from workflow.design.wording.table import as_csv, as_json
from workflow.study.reading import InputError


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


def test_query_gives_the_exact_answer_too(ran: Project, command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ran.folder)
    path, out = "results/small/surrogate.nc", command.folder / "out.csv"
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
    kinds = {str(name): set(array.units.replace("-1", "").split()) for name, array in exact.items()}
    magnetic = {name for name, units_of in kinds.items() if {"Wb", "A", "T"} & units_of}
    assert len(magnetic) == 7
    assert printed.keys() == {str(name) for name in exact} - (set() if flux else magnetic)
    for name, text in printed.items():  # six digits are printed
        assert units.in_si(text, exact[name].units) == pytest.approx(float(exact[name]), rel=5.1e-6), name


ESCAPE = "\x1b]0;owned\x07\x1b[31m"


def test_names_cannot_command_the_terminal(command: Command) -> None:
    model = two_inputs(command.folder / "surrogate.nc", f"depth{ESCAPE}", f"Pa{ESCAPE}")
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


def test_an_answer_is_printed_or_written_in_both_forms(
    ran: Project, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    words = ["--maximise", "abs(voltage_per_load)", "--over", "radius,volume_fraction", "--at", "load=1e4"]
    words += ["--worst-case", "friction=0.1:0.4", "--limit", "trailing_tension<5e7"]
    monkeypatch.chdir(ran.folder)
    ask = questions.ask
    answers: list[Answer] = []

    def once(*question: Any) -> Answer:
        if not answers:
            answers.append(ask(*question))
        return answers[0]

    monkeypatch.setattr(questions, "ask", once)
    words = ["design", "results/small", *words]
    texts = [command(*words, *form)[0] for form in ([], ["--json"])]
    first, sentence, *table = texts[0].splitlines()
    assert first == "maximise abs(voltage_per_load)"
    assert sentence.startswith("Beyond linear theory; otherwise recommended within the model; a tilt of ")
    assert "limited by tension behind the contact of 50 MPa." in " ".join([sentence, *table[:2]])
    assert len(sentence) <= 100  # columns, for people
    assert table.index("polish: on the exact solver") == table.index("feasible; binding: trailing_tension<5e7") + 1
    content = json.loads(texts[1])
    point = {name: factor["value"] for name, factor in content["factors"].items()}
    friction = np.linspace(0.1, 0.4, 61)
    exact = solve({**point, "friction": friction, "composite": "fibrous"})
    best = float(abs(exact["voltage_per_load"]).min())
    assert content["terms"]["abs(voltage_per_load)"]["exact"] == pytest.approx(best, rel=1e-9)
    assert float(exact["trailing_tension"].max()) <= 5e7
    for name, written in (("x.csv", as_csv(answers)), ("x.json", f"{as_json(answers[0])}\n")):
        printed, said = command(*words, "-o", tmp_path / name)
        assert (tmp_path / name).read_text(encoding="utf-8") == written
        assert (printed, said.startswith(f"wrote {tmp_path / name}: ")) == ("", True)
    refusal = command.refused(*words, "-o", tmp_path / "x.xlsx")
    assert "x.xlsx': must end in .csv or .json: the answer is written as CSV or JSON\n" in refusal
    assert {path.name for path in tmp_path.iterdir()} == {"x.csv", "x.json"}


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["maximise=voltage", "over=radius", "at=load=1e4"], "design: 'volume_fraction' is missing; p"),
        (["maximise=depth", "over=radius=b", "at=load=1e4"], "--over: radius: 'b' is not a finite"),
        (["maximise=depth", "over=radius", "uncertain=friction=0.2"], "--uncertain: friction: '0.2' is"),
        (["maximise=peak_pressure", "over=radius", "at=load=5e4,volume_fraction=0.5,friction=0.4",
          "limit=trailing_tension <= 1 MPa"], "infeasible: trailing_tension <= 1 MPa binds; the least violated"),
    ],
)  # fmt: skip
def test_refuses_in_one_line(ran: Project, words: list[str], reason: str) -> None:
    options = {option: [text] for option, _, text in (word.partition("=") for word in words)}
    with pytest.raises(InputError) as caught:
        questions.ask(ran.folder / "results/small", options)
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


def test_uncertain_factors_choices_and_defaults(ran: Project) -> None:
    study, _ = questions.results(ran.folder / "results/small")
    target = questions.target(
        study,
        {"maximise": ["abs(stroke_per_volt)"], "over": ["radius=0.05|0.1", "volume_fraction"], "at": ["load=1e4"],
         "uncertain": ["friction=triangular(0.1,0.2,0.3)"], "robust": ["mean - 2 std"],
         "limit": ["trailing_tension <= 60 MPa with probability 0.9"]},
    )  # fmt: skip
    assert target.variables["radius"].choices == [0.05, 0.1]
    assert target.uncertain["friction"].triangular == [0.1, 0.2, 0.3]
    assert [limit.probability for limit in target.limits] == [0.9]
    options = {"maximise": ["peak_pressure"], "over": ["radius"], "at": ["load=1e4,volume_fraction=0.5"]}
    plain = questions.target(study, options)
    assert plain.at["friction"] == 0.0  # its default


def test_results_are_of_this_study_and_may_be_on_another_disk(ran: Project, here: Path) -> None:
    Path("config").mkdir()
    Path("disk/small").mkdir(parents=True)
    Path("results").symlink_to("disk")
    Path("disk/small/surrogate.nc").write_bytes((ran.folder / "results/small/surrogate.nc").read_bytes())
    text = (ran.folder / "config/small.yaml").read_text(encoding="utf-8")
    Path("config/small.yaml").write_text(text, encoding="utf-8")
    for folder in (Path("results/small"), here / "results/small"):
        assert questions.results(folder)[0].title == "A small study"
    for edited in (text.replace("high: 0.2,", "high: 0.21,"), text.replace("fibrous", "laminate")):
        Path("config/small.yaml").write_text(edited, encoding="utf-8")
        with pytest.raises(InputError, match="was made from another state of the study"):
            questions.results(Path("results/small"))


ONE_FACTOR = """
title: A punch
fixed: {material: BaTiO3, friction: 0.2, radius: 0.05}
factors: {load: {low: 1e3, high: 1e5, levels: 5, scale: log}}
surrogate: {outputs: [voltage]}
"""
SLOPE = -0.05  # V for a N/m


@pytest.fixture
def _one_factor(monkeypatch: pytest.MonkeyPatch) -> None:
    """Results of a study whose voltage is linear in the load."""
    axis = Input("load", 1e3, 1e5, "log", "N m-1")
    levels = axis.levels(14)
    model = GridGP(inputs=[axis]).fit(xr.Dataset({"voltage": ("load", SLOPE * levels)}, {"load": levels}))
    study = made(ONE_FACTOR)
    monkeypatch.setattr(questions, "results", lambda folder: (study, model))


WORDS = ("invert", "results/one", "--si", "--infer", "load", "--measured")


TEXTS = "-519+-1%|-0.519kV+-1%|-519e3mV+-5190 mV|-0.519+-0.00519 kV|−519 ± 1 %|-5.19×10² V +/- 5.19 V"


@pytest.mark.usefixtures("_one_factor")
@pytest.mark.parametrize("text", TEXTS.split("|"))
def test_one_measurement_in_all_its_forms(text: str, command: Command) -> None:
    printed, _ = command(*WORDS, f"voltage={text}")
    mean, low, high = map(float, re.findall(r"[\d.e+]+(?=[\] ,])", printed)[:3])
    # the posterior of what is linear, uniform in the logarithm before: normal about 519/0.05 within 1e-4
    assert mean == pytest.approx(-519 / SLOPE, rel=2e-3)
    np.testing.assert_allclose([low, high], [mean * (1 - 0.0196), mean * (1 + 0.0196)], rtol=2e-3)


@pytest.mark.usefixtures("_one_factor")
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("-0.519kV", "'-0.519kV' is not of the form VALUE+-STD"),
        ("-519+-5mm", "unit mismatch: 'mm' does not measure what 'V' measures"),
        ("-519+-0%", "'0%' is not a positive number with a unit"),
        ("-519+--5", "'-5' is not a positive number with a unit"),
        ("nan+-1%", "--measured: voltage"),
        ("519+-1%", "voltage would fit with the opposite sign"),
        ("-519uV+-1%", "voltage would fit with a factor of 1e+06"),
        ("519mV+-1%", "voltage would fit with the opposite sign and a factor of 1000"),
    ],
)
def test_what_is_none_is_refused_in_one_line(text: str, says: str, command: Command) -> None:
    assert says in command.refused(*WORDS, f"voltage={text}")
