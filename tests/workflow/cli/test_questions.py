"""``meecontact design`` and ``invert``: questions in words, answered from the results of a study."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from solver import solve
from surrogate import GridGP, Input
from tests.programs import Command
from tests.studies import made
from tests.workflow.conftest import Project
from workflow.cli import questions
from workflow.design.verdict.answer import Answer
from workflow.design.wording.table import as_csv, as_json
from workflow.study.reading import InputError


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
    plain = questions.target(
        study, {"maximise": ["peak_pressure"], "over": ["radius"], "at": ["load=1e4,volume_fraction=0.5"]}
    )
    assert plain.at["friction"] == 0.0  # its default


def test_results_are_of_this_study_and_may_be_on_another_disk(
    ran: Project, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("config").mkdir()
    Path("disk/small").mkdir(parents=True)
    Path("results").symlink_to("disk")
    Path("disk/small/surrogate.nc").write_bytes((ran.folder / "results/small/surrogate.nc").read_bytes())
    text = (ran.folder / "config/small.yaml").read_text(encoding="utf-8")
    Path("config/small.yaml").write_text(text, encoding="utf-8")
    for folder in (Path("results/small"), tmp_path / "results/small"):
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


@pytest.mark.usefixtures("_one_factor")
@pytest.mark.parametrize(
    "text",
    ["-519+-1%", "-0.519kV+-1%", "-519e3mV+-5190 mV", "-0.519+-0.00519 kV", "−519 ± 1 %", "-5.19×10² V +/- 5.19 V"],
)
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
