"""``meecontact invert --measured``: a value and its error as people write them, with units, prefixes and shares."""

import re

import numpy as np
import pytest
import xarray as xr

from surrogate import GridGP, Input
from tests.programs import Command
from tests.studies import made
from workflow.cli import questions

STUDY = """
title: A punch
fixed: {material: BaTiO3, friction: 0.2, radius: 0.05}
factors: {load: {low: 1e3, high: 1e5, levels: 5, scale: log}}
surrogate: {outputs: [voltage]}
"""
SLOPE = -0.05  # V for a N/m


@pytest.fixture(autouse=True)
def results(monkeypatch: pytest.MonkeyPatch) -> None:
    axis = Input("load", 1e3, 1e5, "log", "N m-1")
    levels = axis.levels(14)
    model = GridGP(inputs=[axis]).fit(xr.Dataset({"voltage": ("load", SLOPE * levels)}, {"load": levels}))
    study = made(STUDY)
    monkeypatch.setattr(questions, "results", lambda folder: (study, model))


WORDS = ("invert", "results/one", "--si", "--infer", "load", "--measured")


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
