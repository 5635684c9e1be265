"""Slabs of a study: which files are of them, and which an earlier state of the study has left."""

from pathlib import Path

import pytest

from workflow.study import partition
from workflow.study.model import load

FACTORS = "factors: {{friction: {{low: 0.0, high: 0.3{levels}}}, radius: {{low: 0.02, high: 0.2, levels: 3}}}}\n"


@pytest.mark.parametrize(
    ("slabs", "levels", "left"),
    [(3, ", levels: 5", {"levels.nc"}), (1, ", levels: 5", {"slab_1.nc", "slab_2.nc", "levels.nc"}),
     (1, "", {"slab_1.nc", "slab_2.nc"})],
)  # fmt: skip
def test_orphans_are_slabs_beyond_the_count_and_levels_that_are_given(
    tmp_path: Path, slabs: int, levels: str, left: set[str]
) -> None:
    file = tmp_path / "some.yaml"
    text = f"title: Some\nfixed: {{material: PZT-4, load: 1e5}}\ndataset: {{slabs: {slabs}}}\n"
    text += FACTORS.format(levels=levels)
    file.write_text(text, encoding="utf-8")
    (tmp_path / "fields").mkdir()
    for name in ("slab_0.nc", "slab_1.nc", "slab_2.nc", ".slab_9.nc.x.partial", "effect_load.nc"):
        (tmp_path / "fields" / name).touch()
    orphans = partition.orphans(partition.with_slabs(load(file)), tmp_path)
    assert {file.name for file in orphans} == left
