"""A shipped study without some of its keys is a plan or one line: no check reads what a later one sets."""

import random
from collections.abc import Iterator, Mapping
from copy import deepcopy
from functools import reduce
from itertools import combinations
from operator import getitem
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from solver.names import ALL_QUANTITIES
from workflow.report import sections as page
from workflow.run.provenance import ROOT
from workflow.study import coupling, datum, model, partition, solvable
from workflow.study.contents import Contents, Origin
from workflow.study.reading import InputError, read_material, read_yaml

STUDIES = sorted(ROOT.glob("config/*.yaml"))


@pytest.fixture(autouse=True)
def _unsolved(monkeypatch: pytest.MonkeyPatch) -> None:
    """The solver is not asked: every case has all quantities of its kind of body."""

    def answered(study: Contents, *_: Any, **options: Any) -> xr.Dataset:
        return xr.Dataset(dict.fromkeys(study.kind.quantities, 0.0))

    monkeypatch.setattr(Contents, "solved", answered)
    monkeypatch.setattr(solvable, "solve_effects", lambda study: None)
    monkeypatch.setattr(model, "solve_effects", lambda study: None)
    hanging = datum.hanging
    by_base = frozenset({"depth"})  # as on every base that gives
    monkeypatch.setattr(datum, "hanging", lambda study: by_base if study.kind.datum == "by_base" else hanging(study))


def plan(content: dict[str, Any], origin: Origin) -> bool:
    """Read all that the rules ask of a study; return False for a refusal of several lines."""
    try:
        study = partition.with_slabs(model._made(content, origin))
    except InputError as refusal:
        return "\n" not in str(refusal)
    page.figures(study), page.effects(study)
    coupling.outputs(study), coupling.aims(study), coupling.of_interest(study)
    study.final_files, study.output_names, study.regions, study.titles, study.crossed, study.frozen()
    study.digest(*type(study).model_fields)
    return study.absent <= ALL_QUANTITIES.keys()


def keys(content: Mapping[str, Any], depth: int, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name, value in content.items():
        yield (*above, name)
        if depth > 1 and isinstance(value, Mapping):
            yield from keys(value, depth - 1, (*above, name))


def without(content: Mapping[str, Any], removed: tuple[tuple[str, ...], ...]) -> dict[str, Any]:
    """A copy without some keys."""
    copy = deepcopy(dict(content))
    for *above, name in sorted(removed, key=len, reverse=True):
        del reduce(getitem, above, copy)[name]
    return copy


def removals(content: Mapping[str, Any]) -> list[tuple[tuple[str, ...], ...]]:
    """One key to the third depth, or two to the second."""
    return [*((path,) for path in keys(content, 3)), *combinations(keys(content, 2), 2)]


@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.stem)
def test_a_shipped_study_loads_and_is_a_plan_or_one_line_without_some_keys(file: Path) -> None:
    content = read_yaml(file)
    origin = Origin(file, dict(read_material(file.parent / name) for name in content.get("materials", [])))
    assert plan(content, origin)
    assert model._made(content, origin).title == content["title"]  # no refusal; its corners: test_model.py
    all_removals = removals(content)
    for removed in random.Random(file.stem).sample(all_removals, min(len(all_removals), 8)):
        assert plan(without(content, removed), origin), removed
