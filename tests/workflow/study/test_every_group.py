"""Groups at random: what the check of a study accepts is solved, drawn, learned and described."""

import re
from pathlib import Path

import numpy as np
import pytest

from storage.netcdf import read_whole
from tests.studies import made, refusal
from workflow.dataset import croissant, datacard, factorial, slabs
from workflow.learning import training
from workflow.report.figures import coefficients, field_panels, style
from workflow.study import coupling, partition
from workflow.study.model import Study
from workflow.study.reading import InputError

STUDY = """\
title: Groups at random
fixed: {composite: fibrous, friction: 0.2}
factors:
  volume_fraction: {low: 0.3, high: 0.6}
  radius: {low: 0.02, high: 0.04}
  load: {low: 1e4, high: 2e4}
  charge: {low: -1e-8, high: 2e-8}
dataset: {slabs: 1, positions: {inside: 4, outside: 2}}
surrogate: {outputs: [contact_trailing, peak_pressure]}
validation: {cases: 20, calibration: 40}
"""
FACTORS = ("charge", "load", "radius", "volume_fraction")


def grouped(groups: list[str]) -> str:
    """The study's text with some groups."""
    levels = {text: {"levels": 3} for text in groups}
    return STUDY + f"groups: {levels}\n"


def at_random(random: np.random.Generator) -> list[str]:
    """Three products of charge per load, load times radius and the fraction, as powers of the factors, in any order."""
    told = np.array([[1, -1, 0, 0], [0, 1, 1, 0], [0, 0, 0, 1]])
    mixed = np.diag(random.choice([1, 1, 2, 3], 3)) + np.triu(random.choice([0, 1, -1, 2], (3, 3)), 1)
    begin = dict(zip(FACTORS, range(4), strict=True))
    rows = [dict(zip(FACTORS, powers.tolist(), strict=True)) for powers in mixed @ told]
    firsts = random.permutation(["charge", *random.permutation(["load", "radius"])[:1], "volume_fraction"])
    texts = [written({name: row[name] for name in sorted(begin, key=lambda one: (one != first, begin[one]))})
             for row, first in zip(rows, sorted(firsts, key=lambda one: begin[one]), strict=True)]  # fmt: skip
    return [texts[k] for k in random.permutation(3)]


def written(powers: dict[str, int]) -> str:
    above, below = ([f"{name}^{abs(power)}" for name, power in powers.items() if power * sign > 0] for sign in (1, -1))
    return " / ".join([" * ".join(above or ["1"]), *below])


def through(study: Study, folder: Path) -> None:
    """Make everything of a run, from its cases to the figures over its axes."""
    for index in range(partition.count(study)):
        slabs.write_slab(study, index, folder / f"slab_{index}.nc")
    with read_whole(folder / "slab_0.nc", lazy=True) as slab:
        style.save(field_panels.fields([slab], coupling.fields(study)), folder / "fields.svg")
        data = slab.load()
    assert all(np.isfinite(data[name]).all() for name in study.outputs)
    model = training.fit(study, data).calibrate(factorial.training_data(study, factorial.cases(study, "calibration")))
    table = training.validate(study, data, factorial.cases(study, "validation"), model)
    style.save(coefficients.figure(table, study.outputs), folder / "decay.svg")
    card = datacard.card(study, "study", [folder / "slab_0.nc"], [])
    assert croissant.croissant(card)["recordSet"]
    assert all(name in datacard.markdown(card) for name in study.axes)


@pytest.mark.parametrize("seed", [0, pytest.param(2, marks=pytest.mark.soak)])
def test_groups_that_the_check_accepts_run(seed: int, tmp_path: Path) -> None:
    random = np.random.default_rng(seed)
    for _ in range(20):
        try:
            study = made(grouped(at_random(random)))
        except InputError:
            continue
        return through(study, tmp_path)
    raise AssertionError("none of the groups is accepted")


@pytest.mark.parametrize(
    ("groups", "says"),
    [
        (["volume_fraction", "load * radius", "charge^2 / load^2"], "the sign of charge is in no group"),
        (["volume_fraction", "charge * radius", "load / charge * volume_fraction"], "divides by 'charge'"),
        (["charge / load", "load * radius", "radius * load * volume_fraction"], "each needs a factor that"),
        (["charge / load", "volume_fraction", "radius * charge"], "radius = -0.05.* in a corner"),
        (["charge / load", "volume_fraction * charge / load", "load * radius"], "charge = 0 is in the box, where"),
        (
            ["volume_fraction * load * radius", "load * radius", "charge / load"],
            "volume_fraction = 2.4 .* must be a finite",
        ),
        (["volume_fraction", "load * radius * volume_fraction", "charge / load"], "'volume_fraction' is a group of"),
        (["volume_fraction", "(load^9)^9", "charge / load"], "powers of a factor must be at most 9"),
    ],
)
def test_groups_that_cannot_be_solved_or_do_not_tell_are_refused(groups: list[str], says: str) -> None:
    """Each had passed the check, and ended in a job or with one answer to two questions."""
    assert re.search(f"groups: .*{says}", refusal(grouped(groups)))
