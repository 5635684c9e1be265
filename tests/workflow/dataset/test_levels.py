"""Level counts left to the pipeline: chosen for the tolerance, put into the study, refused in one line."""

from pathlib import Path

import numpy as np
import pytest

from storage.netcdf import read_whole, write_whole
from tests.studies import data_set, edited, made
from tests.workflow.conftest import Copy
from workflow.dataset import factorial, levels
from workflow.learning import training
from workflow.study import partition
from workflow.study.model import Study
from workflow.study.reading import InputError

OPEN = """\
title: Levels left open
fixed: {composite: fibrous, load: 1e4}
factors:
  volume_fraction: {low: 0.4, high: 0.8}
  friction: {low: 0.0, high: 0.5, levels: 6}
  radius: {low: 0.02, high: 0.2, scale: log}
  charge: {low: -1e-6, high: 1e-6}
surrogate: {outputs: [voltage, trailing_tension, peak_pressure]}
dataset: {budget: 20000, slabs: 3}
validation: {cases: 500, calibration: 200, tolerance: 1e-6}
"""


def test_chosen_levels_reach_the_tolerance(tmp_path: Path) -> None:
    config = made(OPEN)
    assert config.open
    chosen = levels.choose(config)
    write_whole(chosen, tmp_path / "levels.nc")
    ready = levels.with_levels(config, [tmp_path / "levels.nc"])
    assert not ready.open
    counts = dict(zip(chosen["input"].values, chosen["levels"].values, strict=True))
    assert {name: axis.levels for name, axis in ready.factors.items()} == counts
    assert (counts["friction"], counts["charge"]) == (6, 2)
    assert chosen["affine"].sel(input="charge") == 1
    assert ready.cases == int(chosen["levels"].prod()) <= 20000
    assert partition.count(ready) == partition.count(config)  # the rules counted them before
    data_set(ready, tmp_path)
    quantities = read_whole(tmp_path / "quantities.nc")
    table = training.validate(ready, quantities, factorial.cases(ready, "validation"), training.fit(ready, quantities))
    assert float(table["max_error"].max()) <= 1e-6
    assert float(table["kinked"].sum()) == 0


def test_the_first_axis_has_a_level_for_every_slab() -> None:
    config = made(edited(OPEN, "factors:", "factors:\n  magnetic_charge: {low: -1e-4, high: 1e-4}"))
    assert next(iter(config.factors)) == "magnetic_charge"
    loose = config.validation.model_copy(update={"tolerance": 1e-3})
    chosen = levels.choose(config.model_copy(update={"validation": loose}))
    assert chosen["affine"].sel(input="magnetic_charge") == 1
    assert chosen["levels"].sel(input="magnetic_charge") == partition.count(config) == 3


def test_an_output_asked_for_by_name_must_not_be_kinked(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = factorial.exact

    def kinked(config: Study, axes: dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]) -> object:
        out = exact(config, axes)
        return out.assign(voltage=np.abs(out["friction"] - 0.2) + 0 * out["voltage"])

    monkeypatch.setattr(factorial, "exact", kinked)
    with pytest.raises(InputError, match=r"outputs: 'voltage' is kinked along friction .*cannot be promised"):
        levels.choose(made(OPEN))


def test_an_unreachable_tolerance_is_one_line_and_leaves_no_result(copy: Copy) -> None:
    project = copy("unreachable")
    text = OPEN.replace("charge: {low: -1e-6, high: 1e-6}", "").replace("load: 1e4", "load: 1e4, charge: 0.0")
    (project.folder / "config/open.yaml").write_text(text.replace("20000", "40"), encoding="utf-8")
    done = project.run("meecontact", "run", "open", "--cores", "1", check=False)
    assert done.returncode == 2
    line = done.stderr.strip()
    assert "\n" not in line
    assert line.startswith("meecontact: config/open.yaml: tolerance 1e-06 needs ")
    assert "the budget is 40; " in line
    assert not [file for file in (project.folder / "results").rglob("*") if file.is_file()]
