"""Cases to be solved: levels left to the pipeline, cross approximation in batches, and random cases."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import kstest

from storage.netcdf import read_whole, write_whole
from surrogate import GridGP
from tests.studies import data_set, edited, fitted, made
from tests.workflow.conftest import Copy
from workflow.dataset import batches, datacard, draws, factorial, levels
from workflow.dataset.slabs import gather
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


@pytest.mark.parametrize("ends", [False, True])
def test_cases_are_even_and_as_many_again_lie_towards_the_ends(ends: bool) -> None:
    study = made(GROUPED)
    (cases, even), (again, _), (other, _) = (draws.sample(study, 4000, seed, ends) for seed in ((3, 2), (3, 2), (3, 1)))
    assert (int(even.sum()), even.size) == (4000, 4000 * (1 + ends))
    for name, values in cases.items():
        axis = study.factors[name]
        assert axis.low <= values.min() <= values.max() <= axis.high
        assert values.equals(again[name])
        assert not values.equals(other[name])
        size = np.log if axis.scale == "log" else np.asarray
        low, high = float(size(axis.low)), float(size(axis.high))
        shares = (size(values.values) - low) / (high - low)
        # places of ten are as good as 400 independent cases, whose distance is beyond 0.081 once in a hundred
        assert kstest(shares[even > 0], "uniform").statistic < 0.081
        if ends and name not in study.tabled:
            assert (np.abs(shares[even == 0] - 0.5) > 0.4).mean() > 0.4


FILM = """\
title: Two layers
fixed: {surroundings: insulated, radius: 0.05, base: steel, friction: 0.2}
body:
  - {composite: fibrous, volume_fraction: volume_fraction, thickness: thickness}
  - composite: fibrous
    volume_fraction: lower_volume_fraction
    thickness: thickness
    below: {electric: grounded, magnetic: grounded}
factors:
  volume_fraction: {low: 0.45, high: 0.55, levels: 3}
  lower_volume_fraction: {low: 0.45, high: 0.55, levels: 4}
  thickness: {low: 2e-4, high: 2.5e-4, levels: 2, scale: log}
  load: {low: 2e4, high: 3e4, levels: 3, scale: log}
dataset: {slabs: 2}
surrogate: {method: cross, outputs: [voltage, contact_offset, charge_per_force]}
validation: {cases: 20, calibration: 40, tolerance: 1e-3}
"""


def run(study: Study, folder: Path) -> list[Path]:
    """Round after round as the rules make them; files that are there stay."""
    slabs: list[Path] = []
    for number in range(30):
        places = folder / f"{number}.nc"
        if not places.exists():
            batches.write_places(study, training.places(study, [read_whole(slab) for slab in slabs]), places)
        files = [folder / f"{number}_{index}.nc" for index in range(batches.slabs(study, places))]
        for index, file in enumerate(files):
            if not file.exists():
                batches.write_slab(study, places, index, file)
        if not files:
            return slabs
        slabs += files
    raise AssertionError("no end")


@pytest.fixture(scope="module")
def slabs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return run(made(FILM), tmp_path_factory.mktemp("cross"))


def test_it_is_the_surrogate_of_the_whole_factorial_and_its_card_counts_what_was_solved(slabs: list[Path]) -> None:
    study = made(FILM)
    assert study.crossed == ["lower_volume_fraction", "volume_fraction"]
    crossed = training.fit(study, gather([read_whole(slab) for slab in slabs]))
    exact = factorial.training_data(study, factorial.exact(study, factorial.levels(study)))
    whole = GridGP(inputs=factorial.inputs(study), outputs=study.output_names, compression=1e-9).fit(exact)
    X = np.stack([values.values for values in draws.points(study, 200, (5,)).values()], axis=1)
    errors = np.abs(crossed.predict_array(X) - whole.predict_array(X)).max(axis=0)
    assert (errors <= 1e-3 * np.array([np.ptp(exact[name].values) for name in study.outputs])).all()
    assert crossed.made_from_ == study.physics
    card = datacard.card(study, "crossed", slabs, [])
    places = sum(read_whole(slab).sizes["place"] for slab in slabs)
    assert card["cases"] == 6 * places == 6 * sum(file["levels"] for file in card["files"])
    assert "a cross approximation asked for" in datacard.markdown(card)


def test_slabs_and_restarts_change_no_byte(slabs: list[Path], tmp_path: Path) -> None:
    study = made(FILM)
    single_slab = study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": 1})})
    # a run of one slab a batch that was ended after its first
    (tmp_path / "0.nc").write_bytes((slabs[0].parent / "0.nc").read_bytes())
    batches.write_slab(single_slab, tmp_path / "0.nc", 0, tmp_path / "0_0.nc")
    again = run(single_slab, tmp_path)
    assert len(again) < len(slabs)
    for name, files in (("again.nc", again), ("first.nc", slabs)):
        write_whole(gather([read_whole(slab) for slab in files]), tmp_path / name)
    assert (tmp_path / "again.nc").read_bytes() == (tmp_path / "first.nc").read_bytes()


HALF_PLANE = """\
title: A half-plane
fixed: {surroundings: insulated, composite: fibrous, friction: 0.2}
factors:
  volume_fraction: {low: 0.3, high: 0.7, levels: 9}
  radius: {low: 5e-3, high: 0.2, levels: 5, scale: log}
  load: {low: 3e3, high: 3e5, levels: 6, scale: log}
  charge: {low: -2e-6, high: 2e-6, levels: 3}
dataset: {slabs: 2, budget: 500}
surrogate: {method: auto, outputs: [voltage, peak_pressure, magnetic_potential]}
validation: {cases: 20, calibration: 40, tolerance: 1e-4}
"""
GROUPS = """\
groups:
  volume_fraction: {levels: 9, scale: logit}
  load * radius: {levels: 5}
  charge / load: {levels: 3}
"""
GROUPED = re.sub(r", levels: \d", "", HALF_PLANE).replace("method: auto", "method: cross") + GROUPS


def test_a_study_of_groups_takes_a_part_of_its_factorial(tmp_path: Path) -> None:
    study = made(GROUPED)
    assert sorted(study.crossed) == sorted(study.axes)
    files = run(study, tmp_path)
    solved = gather([read_whole(file) for file in files])
    model = training.fit(study, solved)
    factorial_method = study.surrogate.model_copy(update={"method": "factorial", "log": []})
    whole = fitted(study.model_copy(update={"surrogate": factorial_method}))
    X = np.stack([values.values for values in draws.points(study, 200, (7,)).values()], axis=1)
    errors = np.abs(model.predict_array(X) - whole.predict_array(X)).max(axis=0)
    # what 24 places on levels keep, other points may exceed
    assert (errors <= 5 * study.validation.tolerance * np.ptp(whole.predict_array(X), axis=0)).all()
    assert solved.sizes["place"] == model.cases_ < study.cases
    table = training.validate(study, solved, factorial.sample(study, 60, (8,)), model)
    assert float(table["max_error"].max()) <= 2e-3


def test_a_factorial_within_the_budget_is_solved_whole() -> None:
    study = made(HALF_PLANE)
    assert sorted(study.crossed) == sorted(study.axes)
    assert not made(edited(HALF_PLANE, "budget: 500", "budget: 810")).crossed
