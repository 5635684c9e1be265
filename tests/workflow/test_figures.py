"""Figures of the data set: the same however it is cut into slabs."""

import warnings
from pathlib import Path

import pytest

from surrogate.netcdf import read_whole
from workflow import dataset, figures, partition
from workflow.study import load

ONE = "factors: {friction: {low: 0.0, high: 0.6, levels: 7}}"
TWO = "factors: {volume_fraction: {low: 0.2, high: 0.8, levels: 7}, friction: {low: 0.0, high: 0.6, levels: 4}}"
NAMED = f"categories: {{composite: [fibrous, laminate]}}\n{ONE}"


@pytest.mark.parametrize("factors", [ONE, TWO, NAMED], ids=["one factor", "two factors", "a category and a factor"])
def test_the_number_of_slabs_does_not_change_the_figure_of_fields(factors: str, tmp_path: Path) -> None:
    drawn = set()
    for slabs in (1, 2, 3):
        file = tmp_path / "some.yaml"
        fixed = {"radius": 0.05, "load": 1e5, "composite": "fibrous", "volume_fraction": 0.5}
        fixed = {name: value for name, value in fixed.items() if name not in factors}
        file.write_text(f"title: Some\n{factors}\nfixed: {fixed}\ndataset: {{slabs: {slabs}}}\n", encoding="utf-8")
        study = load(file)
        parts = []
        for index in range(partition.count(study)):
            dataset.write_slab(study, index, tmp_path / f"{index}.nc")
            parts.append(read_whole(tmp_path / f"{index}.nc"))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            figures.save(figures.fields(parts), tmp_path / "fields.svg")
        drawn.add((tmp_path / "fields.svg").read_bytes())
    assert len(drawn) == 1
