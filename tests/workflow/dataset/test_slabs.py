"""The data set on disk: blocks, chunks, a card that tells the truth; and cases that were solved before."""

import json
import os
import shutil
from math import prod
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from hypothesis import example, given, settings
from hypothesis import strategies as st

from solver.fields import FIELDS
from solver.names import QUANTITIES
from storage.netcdf import write_whole
from tests.refusals import assert_refused
from tests.studies import data_set, edited, made
from workflow.dataset import casecache, datacard, factorial
from workflow.dataset import slabs as dataset
from workflow.dataset.casecache import CaseCache
from workflow.study import partition
from workflow.study.model import Study

STUDY = """\
title: Blocks
fixed: {composite: fibrous}
factors:
  volume_fraction: {low: 0.3, high: 0.7, levels: 5}
  friction: {low: 0.0, high: 0.5, levels: 6}
  radius: {low: 0.02, high: 0.2, levels: 4, scale: log}
  load: {low: 5e3, high: 5e4, levels: 7, scale: log}
dataset: {slabs: 2, precision: float32, positions: {inside: 20, outside: 12}}
"""


@pytest.fixture(scope="module")
def study() -> Study:
    return made(STUDY)


@pytest.fixture(scope="module")
def folder(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("results")
    data_set(study, folder)
    return folder


@pytest.fixture(scope="module")
def exact(study: Study) -> xr.Dataset:
    return factorial.exact(study, dict(factorial.levels(study)), study.dataset.positions.values())


def test_the_opened_data_set_is_the_exact_solution(folder: Path, exact: xr.Dataset) -> None:
    data = dataset.open_results(folder)
    assert set(data.data_vars) == {*QUANTITIES, *FIELDS}
    for name in QUANTITIES:
        np.testing.assert_allclose(data[name], exact[name], rtol=1e-13)
    for name in FIELDS:
        scale = np.abs(exact[name]).max().item()
        np.testing.assert_allclose(data[name], exact[name], rtol=1e-6, atol=1e-7 * scale)
        assert data[name].attrs["units"] == exact[name].attrs["units"]
    with netCDF4.Dataset(folder / "fields/slab_0.nc") as file:  # chunks for reading by case and by position
        chunks = dict(zip(file["stress_xx"].dimensions, file["stress_xx"].chunking(), strict=True))
    assert (chunks["volume_fraction"], chunks["position"]) == (1, 16)


@pytest.mark.parametrize(
    "choice",
    [
        {"volume_fraction": 2, "friction": 1, "radius": 3, "load": 0},
        {"friction": slice(1, 4), "position": slice(None, None, 5)},
        {"volume_fraction": [4, 0, 2, 3], "load": [6, 1]},
        {"volume_fraction": slice(None, None, -2)},
        {"volume_fraction": slice(0, 0)},
        {"volume_fraction": -1, "radius": [True, False, True, False]},
    ],
)
def test_any_selection_is_read_from_disk_as_from_memory(folder: Path, choice: dict[str, object]) -> None:
    data = dataset.open_results(folder)
    whole = data["stress_xx"].copy(data=data["stress_xx"].values)
    xr.testing.assert_identical(data["stress_xx"].isel(choice).load(), whole.isel(choice))


def test_a_truncated_slab_is_named_when_it_is_read(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    cut = tmp_path / "fields/slab_1.nc"
    cut.write_bytes(cut.read_bytes()[:-1])
    data = dataset.open_results(tmp_path)
    data["stress_xx"].isel(volume_fraction=0).load()
    assert_refused(ValueError, r"slab_1\.nc: incomplete", data["stress_xx"].isel(volume_fraction=4).load)


def test_the_card_tells_sizes_and_statistics(folder: Path, study: Study, exact: xr.Dataset) -> None:
    card = json.loads((folder / dataset.CARD).read_text(encoding="utf-8"))
    assert card["cases"] == 840
    assert card["bytes"] == sum(file.stat().st_size for file in (folder / "fields").iterdir())
    assert card["bytes_unpacked"] == 840 * (len(QUANTITIES) * 8 + len(FIELDS) * 32 * 4)
    for name, described in card["variables"].items():
        values = exact[name].values.astype(described["type"]).astype(np.float64)
        attrs = described["attributes"]
        assert attrs["actual_range"] == [values.min(), values.max()]
        assert attrs["mean"] == pytest.approx(values.mean(), rel=1e-9, abs=1e-9 * np.abs(values).max())
        assert attrs["standard_deviation"] == pytest.approx(values.std(), rel=1e-5)
    text = datacard.markdown(card)
    assert "| trailing_tension | Pa |" in text
    assert "| friction | 0 | 0.5 | 6 | linear |" in text


def test_a_value_beyond_the_stored_precision_leaves_no_file(tmp_path: Path) -> None:
    text = edited(STUDY, "load: {low: 5e3, high: 5e4, levels: 7", "load: {low: 5e3, high: 1e120 N/m, levels: 3")
    vast = made(edited(text, "radius: {low: 0.02, high: 0.2", "radius: {low: 1e-110 m, high: 1e-100 m"))
    assert_refused(ValueError, "not finite in float32", dataset.write_slab, vast, 0, tmp_path / "slab.nc")
    assert not (tmp_path / "slab.nc").exists()


def test_slabs_follow_cores_and_memory(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    free = study.model_copy(update={"dataset": study.dataset.model_copy(update={"slabs": None})})
    for cores, gigabytes, slabs in ((1, 64, 1), (3, 64, 3), (64, 64, 5), (4, 4, 2), (4, 1, 1)):
        pages = {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": gigabytes * 2**18}
        monkeypatch.setattr(os, "sched_getaffinity", lambda _, cores=cores: set(range(cores)))
        monkeypatch.setattr(os, "sysconf", pages.__getitem__)
        assert partition.count(free) == slabs
    assert partition.count(study) == 2


FACTORIALS = st.lists(st.integers(1, 45), min_size=1, max_size=5).filter(lambda lengths: prod(lengths) <= 4000)


@settings(deadline=None, derandomize=True, max_examples=60)
@given(lengths=FACTORIALS, cases=st.sampled_from([1, 2, 3, 7, 28, 100, 168, 1000, 16384]) | st.integers(1, 5000))
@example(lengths=[5, 6, 4, 7], cases=28)
@example(lengths=[2, 13, 4], cases=100)
@example(lengths=[2, 10, 20, 40, 5], cases=1000)
@example(lengths=[2, 10, 20, 40, 5], cases=16384)
def test_blocks_fill_the_factorial_in_order_of_whole_chunks(lengths: list[int], cases: int) -> None:
    chunk = dataset.chunk_lengths(lengths, max(1, cases // 2))
    assert prod(chunk) <= max(1, cases // 2)
    regions = list(dataset.block_regions(lengths, chunk, cases))

    case = np.arange(prod(lengths)).reshape(lengths)
    blocks = [case[region].ravel() for region in regions]
    np.testing.assert_array_equal(np.concatenate(blocks), case.ravel())
    assert max(block.size for block in blocks) <= cases
    level = prod(lengths[1:])
    assert all(block[0] // level == block[-1] // level for block in blocks)  # of the first factor

    places = np.indices(lengths) // np.array(chunk).reshape(-1, *[1] * len(lengths))
    number = np.ravel_multi_index(tuple(places), tuple(lengths))
    held = [set(number[region].ravel().tolist()) for region in regions]
    assert sum(map(len, held)) == len(set().union(*held))  # no chunk lies in two blocks


FILM = """\
title: A film whose levels are nested
fixed: {surroundings: insulated, base: rigid,
        composite: fibrous, radius: 0.05, friction: 0.2, interface_electric: grounded, interface_magnetic: grounded}
factors:
  load: {low: 2e4, high: 4e4, levels: 2, scale: log}
  thickness: {low: 1.5e-4, high: 3e-4, levels: 2, scale: log}
  volume_fraction: {low: 0.45, high: 0.55, levels: 2}
dataset: {slabs: 1, positions: {inside: 2, outside: 2}}
surrogate: {outputs: [voltage, peak_pressure]}
validation: {cases: 20, calibration: 40}
"""


def slab(study: Study, results: Path) -> tuple[CaseCache, bytes]:
    """A slab of the study written with what is kept: who was asked, and the bytes."""
    output = results / "film/fields/slab_0.nc"
    output.parent.mkdir(parents=True, exist_ok=True)
    cache = CaseCache(results)
    dataset.write_slab(study, 0, output, cache)
    return cache, output.read_bytes()


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the study, solved once; no test may change them."""
    film = made(FILM)
    results = tmp_path_factory.mktemp("before")
    first, _ = slab(film, results)
    assert (first.taken, first.cases) == (0, 8)
    return results


def test_nested_levels_take_the_cases_of_before_and_give_equal_bytes(before: Path, tmp_path: Path) -> None:
    film = made(FILM)
    shutil.copytree(before, tmp_path / "a")
    finer = made(FILM.replace("levels: 2}", "levels: 6}"))
    again, reused = slab(finer, tmp_path / "a")
    assert (again.taken, again.cases) == (8, 24)  # levels nest from n to 3 n
    alone, solved = slab(finer, tmp_path / "b")
    assert alone.taken == 0
    assert reused == solved
    answer = factorial.exact(film, dict(factorial.axes(film)))
    data = xr.open_dataset(tmp_path / "a/film/fields/slab_0.nc").load()
    again_voltage = data["voltage"].sel(volume_fraction=answer["volume_fraction"])
    np.testing.assert_allclose(again_voltage, answer["voltage"], rtol=1e-13)


def test_random_cases_are_those_of_the_solver(tmp_path: Path) -> None:
    film = made(FILM)
    cache, again = (CaseCache(tmp_path) for _ in range(2))
    first, second = (factorial.cases(film, "validation", job_cache) for job_cache in (cache, again))
    plain = factorial.cases(film, "validation")
    assert (cache.taken, cache.cases, again.taken) == (0, 20, 20)
    xr.testing.assert_identical(first, second)
    assert list(first.variables) == list(plain.variables)
    assert first.attrs == plain.attrs
    for name in plain.data_vars:
        np.testing.assert_allclose(first[name], plain[name], rtol=1e-9)


def test_other_constants_and_other_questions_are_other_cases(before: Path, tmp_path: Path) -> None:
    shutil.copytree(before, tmp_path / "a")
    for old, new in (("dataset:", "phases: [CoFe2O4, BaTiO3]\ndataset:"), ("inside: 2", "inside: 4")):
        assert slab(made(FILM.replace(old, new)), tmp_path / "a")[0].taken == 0


def test_what_was_used_longest_ago_is_swept(tmp_path: Path) -> None:
    folder = tmp_path / casecache.FOLDER / "cases/ab"
    folder.mkdir(parents=True)
    for number in range(3):
        write_whole(xr.Dataset({"x": ("case", np.arange(9.0))}), folder / f"{number}.nc")
    for number, age in ((0, 10), (1, 1000), (2, 100)):
        os.utime(folder / f"{number}.nc", (1e9 - age, 1e9 - age))
    size = (folder / "0.nc").stat().st_size
    casecache.sweep(tmp_path, 2 * size)
    assert sorted(file.name for file in folder.iterdir()) == ["0.nc", "2.nc"]


def test_an_answer_to_another_case_is_solved_again(before: Path, tmp_path: Path) -> None:
    film = made(FILM)
    results = shutil.copytree(before, tmp_path / "a")
    whole = (results / "film/fields/slab_0.nc").read_bytes()
    first, second = sorted((results / casecache.FOLDER).rglob("*.nc"))
    contents = first.read_bytes(), second.read_bytes()
    for kind, poison in (("swapped", contents[::-1]), ("truncated", (contents[0][:-1], contents[1]))):
        for file, content in zip((first, second), poison, strict=True):
            file.write_bytes(content)
        again, bytes_ = slab(film, results)
        assert (again.taken, bytes_) == (0 if kind == "swapped" else 4, whole), kind
    unnamed = xr.load_dataset(first)  # of an earlier version
    del unnamed.attrs[casecache.CASE]
    write_whole(unnamed, first)
    assert slab(film, results)[0].taken == 4
