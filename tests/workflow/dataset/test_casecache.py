"""Cases that were solved before: equal bytes with them and without, nested levels, damaged files, and what is swept."""

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from storage.netcdf import write_whole
from tests.studies import made
from workflow.dataset import casecache, factorial, slabs
from workflow.dataset.casecache import CaseCache
from workflow.study.model import Study

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


@pytest.fixture(scope="module")
def film() -> Study:
    return made(FILM)


def slab(study: Study, results: Path) -> tuple[CaseCache, bytes]:
    """A slab of the study written with what is kept: who was asked, and the bytes."""
    output = results / "film/fields/slab_0.nc"
    output.parent.mkdir(parents=True, exist_ok=True)
    cache = CaseCache(results)
    slabs.write_slab(study, 0, output, cache)
    return cache, output.read_bytes()


@pytest.fixture(scope="module")
def before(film: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the study, solved once; no test may change them."""
    results = tmp_path_factory.mktemp("before")
    first, _ = slab(film, results)
    assert (first.taken, first.cases) == (0, 8)
    return results


def test_nested_levels_take_the_cases_of_before_and_give_equal_bytes(film: Study, before: Path, tmp_path: Path) -> None:
    shutil.copytree(before, tmp_path / "a")
    finer = made(FILM.replace("levels: 2}", "levels: 6}"))
    again, reused = slab(finer, tmp_path / "a")
    assert (again.taken, again.cases) == (8, 24)  # levels nest from n to 3 n
    alone, solved = slab(finer, tmp_path / "b")
    assert alone.taken == 0
    assert reused == solved
    answer = factorial.exact(film, dict(factorial.axes(film)))
    data = xr.open_dataset(tmp_path / "a/film/fields/slab_0.nc").load()
    np.testing.assert_allclose(
        data["voltage"].sel(volume_fraction=answer["volume_fraction"]), answer["voltage"], rtol=1e-13
    )


def test_random_cases_are_those_of_the_solver(film: Study, tmp_path: Path) -> None:
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


def test_an_answer_to_another_case_is_solved_again(film: Study, before: Path, tmp_path: Path) -> None:
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
